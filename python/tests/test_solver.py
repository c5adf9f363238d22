"""How equilibria are solved: Solver, and the keywords that it was once."""

from __future__ import annotations

import pickle
import re
from dataclasses import FrozenInstanceError
from pathlib import Path
from typing import Any

import pytest
from beams import beam

import softkin
from softkin import Solver


@pytest.fixture(scope="module")
def small() -> softkin.Robot:
    return beam(2, 5)


def test_it_is_a_value() -> None:
    solver = Solver("local-global", tolerance_mm=0.1, anderson=0)
    assert solver == Solver(method="local-global", tolerance_mm=0.1, anderson=0) != Solver()
    assert pickle.loads(pickle.dumps(solver)) == solver and len({solver, Solver(), Solver()}) == 2
    with pytest.raises(FrozenInstanceError):
        solver.threads = 2  # type: ignore[misc]
    assert Solver() == Solver("newton", None, None, 6, 0, False, False)
    assert repr(solver) == "Solver(method='local-global', tolerance_mm=0.1, anderson=0)" and repr(Solver()) == "Solver()"


def test_wrong_values(small: softkin.Robot) -> None:
    for tolerance in (0, -1, float("nan")):
        with pytest.raises(ValueError, match="the tolerance must be a length > 0 in mm|tolerance_mm must be a finite number"):
            Solver(tolerance_mm=tolerance)
    with pytest.raises(softkin.InvalidInput, match="solver must be 'newton' or 'local-global', not 'newtn'"):
        Solver("newtn")
    with pytest.raises(softkin.InvalidInput, match="solver must be 'newton' or 'local-global', not 'newtn'"):
        small.solve(solver="newtn")
    with pytest.raises(TypeError, match="solver must be a softkin.Solver or a text, not 3"):
        small.solve(solver=3)  # type: ignore[arg-type]
    with pytest.raises(softkin.InvalidInput, match="max_iterations must be at least 1, not 0"):
        Solver(max_iterations=0)
    published = Solver("local-global", as_published=True)
    for use in (
        lambda: small.inverse(tip=(60, 10, 10), solver=published),
        lambda: small.follow([(60, 10, 10)], solver=published),
        lambda: small.workspace(1, solver=published),
        lambda: small.map(solver=published),
    ):
        with pytest.raises(ValueError, match="as_published is for solve and path"):
            use()


def found(robot: softkin.Robot, call: str, **how: Any) -> Any:
    """What a call that solves comes to, to the last bit."""
    target, first = (70, 10, 10), call.split()[0]
    by = robot.session() if call.endswith("session") else robot
    if first == "solve":
        return by.solve(air1=1.3, **how).fingerprint
    if first == "inverse":
        return by.inverse(tip=target, max_equilibria=3, **how).shape.fingerprint
    if call == "path":
        return [shape.fingerprint for shape in robot.path([{"air1": 1.3}], **how)]
    if call == "follow":
        return [waypoint.shape.fingerprint for waypoint in robot.follow([target], **how)]
    return robot.workspace(2, sampling="sobol", **how).places.tolist()


def warning_of(call: str, old: str, new: str) -> str:
    return re.escape(f"{old}= of {call.split()[0]} is deprecated and goes with softkin 0.2: write solver=softkin.{new}")


@pytest.mark.parametrize(
    "call", ["solve", "solve of a session", "inverse", "inverse of a session", "path", "follow", "workspace"]
)
def test_keywords_of_the_past(call: str, small: softkin.Robot) -> None:
    """They do what the value does, and the line of the call is warned."""
    usual, new = found(small, call), found(small, call, solver=Solver(tolerance_mm=1))
    old = "step_tolerance_mm" if call.startswith(("inverse", "follow")) else "tolerance_mm"
    with pytest.warns(DeprecationWarning, match=warning_of(call, old, "Solver(tolerance_mm=1)")) as caught:
        assert found(small, call, **{old: 1}) == new != usual
    assert [Path(each.filename) for each in caught] == [Path(__file__)]


def test_a_method_beside_keywords_of_the_past(small: softkin.Robot) -> None:
    reported = warning_of("solve", "threads", "Solver(method='local-global', threads=1)")
    with pytest.warns(DeprecationWarning, match=reported), pytest.raises(softkin.InvalidInput, match="local-global"):
        small.solve(solver="local-global", threads=1)  # of target shapes alone
    reported = warning_of("solve", "tolerance_mm", "Solver(tolerance_mm=1, threads=1)")
    with pytest.warns(DeprecationWarning, match=reported) as caught:
        shape = small.solve(air1=1.3, solver=Solver(threads=1), tolerance_mm=1)
    assert len(caught) == 1 and shape.fingerprint == small.solve(air1=1.3, solver=Solver(tolerance_mm=1)).fingerprint


def test_doubts_are_told_at_the_line_of_the_call(small: softkin.Robot) -> None:
    for use in (lambda: small.inverse(tip=(0.06, 0.01, 0.01)), lambda: small.follow([(0.06, 0.01, 0.01)])):
        with pytest.warns(softkin.SoftkinWarning, match="m") as caught:
            use()
        assert {Path(each.filename) for each in caught} == {Path(__file__)}


def test_the_document() -> None:
    text = (Path(__file__).resolve().parents[2] / "docs/python.md").read_text()
    (shown,) = [each for each in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S) if "softkin.Solver(" in each]
    names: dict[str, Any] = {"robot": beam(2, 5), "softkin": softkin}
    exec(compile(shown, "docs/python.md", "exec"), names)
    assert names["shape"].converged


def test_options(small: softkin.Robot, tmp_path: Path) -> None:
    """Tuned constants by name or from a file, as a value; they reach the solver and its report."""
    file = tmp_path / "tuned.yaml"
    file.write_text("step: {max_turn: 20}\nnewton:\n  max_iterations: 25\n")
    tuned = Solver(options={"step": {"max_turn": 20}, "newton": {"max_iterations": 25}})
    assert tuned == Solver(options=file) == Solver(options={"step.max_turn": 20, "newton.max_iterations": 25})
    assert tuned != Solver() and pickle.loads(pickle.dumps(tuned)) == tuned and len({tuned, Solver()}) == 2
    assert Solver(options={}) == Solver()
    shape = small.solve(solver=tuned)
    assert shape.report["solver"]["options"] == {"step": {"max_turn": 20}, "newton": {"max_iterations": 25}}
    assert "options" not in small.solve().report["solver"]
    for options, message in (
        ({"stpe": {"max_turn": 20}}, "did you mean 'step'"),
        ({"step": {"max_trun": 20}}, "did you mean 'max_turn'"),
        ({"step": {"max_turn": -1}}, "must be above 0, not -1"),
        ({"step": {"max_turn": "20"}}, "must be a number, not '20'"),
        (3, "options must be a map of groups"),
    ):
        with pytest.raises(softkin.InvalidInput, match=re.escape(message)):
            Solver(options=options)
