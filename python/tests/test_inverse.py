from __future__ import annotations

import json
import pickle
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import softkin


@pytest.fixture(scope="module")
def goal(robot: softkin.Robot) -> softkin.Shape:
    return robot.solve(air1=1.4, air2=1.3, air3=1.2)


def test_reached(robot: softkin.Robot, goal: softkin.Shape) -> None:
    answer = robot.inverse(tip=goal["tip"])
    assert answer.reached and answer.status == "reached" and answer.reason == ""
    assert answer.error_mm == answer.errors_mm.max() < 1e-3
    assert answer.actuation == pytest.approx({"air1": 1.4, "air2": 1.3, "air3": 1.2}, abs=1e-3)
    assert answer.require() is answer and answer.at_end_of_range == {}
    assert answer.equilibria > 1 and answer.iterations > 0 and answer.seconds > 0
    assert answer.report["ik"]["reached"] is True
    assert "reached" in repr(answer) and answer.shape.converged
    again = pickle.loads(pickle.dumps(answer))
    assert again.report == answer.report and again.shape.fingerprint == answer.shape.fingerprint


def test_coordinates_planes_directions_weights(robot: softkin.Robot, goal: softkin.Shape) -> None:
    x, y, z = goal["tip"]
    assert robot.inverse({"tip": (None, y, None)}).reached
    assert robot.inverse(planes={"tip": ((x, y, z), (1, 0, 0))}).reached
    both = robot.inverse(tip=(x, None, None), planes={"tip": ((x, y, z), (0, 0, 1))}, weights={"tip": 2})
    assert both.reached and len(both.errors_mm) == 2


def test_direction(robot: softkin.Robot) -> None:
    from beams import beam

    two = beam(markers=[{"name": "tip", "region": "end"}, {"name": "base", "region": "base"}])
    aim = two.solve(air1=1.4)
    answer = two.inverse(directions={("base", "tip"): aim["tip"] - aim["base"]})
    assert answer.reached


def over_a_floor() -> softkin.Robot:
    from beams import beam

    contact = {"distance": 0.1, "friction": 0, "self": False}
    floor = {"name": "floor", "halfspace": {"point": (0, 0, -1), "normal": (0, 0, 1)}}
    return beam(contact=contact, obstacles=[floor])


def test_press() -> None:
    robot = over_a_floor()
    answer = robot.inverse(tip=(None, 10, None), press={"floor": (None, None, -0.3)})
    assert answer.reached, answer
    assert len(answer.errors_N) == len(answer.errors_mm) == 1
    assert answer.error_N == answer.errors_N[0] <= 0.0003
    goal = answer.report["ik"]["goals"][1]
    assert goal["of"] == "floor" and goal["force_N"] == [None, None, -0.3]
    assert goal["found_N"][2] == pytest.approx(-0.3, abs=0.0003)
    again = pickle.loads(pickle.dumps(answer))
    assert again.report == answer.report and again.error_N == answer.error_N
    loose = robot.inverse(press={"floor": (None, None, -0.3)}, tolerance_force_N=0.01, weights={"floor": 2})
    assert loose.reached and loose.error_N <= 0.01 and len(loose.errors_mm) == 0 and np.isnan(loose.error_mm)
    on_base = robot.inverse(press={"base": (None, None, -0.3)})  # what the floor bears pulls at the base
    assert not on_base.reached or on_base.error_N <= 0.0003


def test_press_that_is_not_to_be_had() -> None:
    robot = over_a_floor()
    pull = robot.inverse(press={"floor": (None, None, 1)}, other_starts=0)
    assert pull.status == "not reached" and "nothing touches 'floor' there" in pull.reason
    assert "1 N off" in repr(pull)
    with pytest.raises(softkin.NotConverged, match="1 N off"):
        pull.require()
    with pytest.raises(ValueError, match="no support, obstacle or body 'flor'; did you mean 'floor'"):
        robot.inverse(press={"flor": (0, 0, 1)})
    with pytest.raises(ValueError, match="press: the force on 'floor' must be three components"):
        robot.inverse(press={"floor": (0, 1)})
    with pytest.raises(ValueError, match="finite and > 0"):
        robot.inverse(press={"floor": (0, 0, 1)}, tolerance_force_N=-1)


def test_starts_preferences_and_what_is_fixed(robot: softkin.Robot, goal: softkin.Shape) -> None:
    y = goal["tip"][1]
    kept = robot.inverse(tip=(None, y, None), fix={"air1": 1.1})
    assert kept.actuation["air1"] == 1.1
    as_it_is = robot.inverse(tip=(None, y, None), start=goal, fix=["air2"])
    assert as_it_is.reached and as_it_is.actuation["air2"] == 1.3
    near = robot.inverse(tip=(None, y, None), prefer={"air3": 1.5})
    assert near.reached
    assert robot.inverse(tip=goal["tip"], start={"air1": 1.3}).reached
    assert robot.inverse(tip=goal["tip"], method="gradient", tolerance_mm=0.5).error_mm < 0.5


def test_files(robot: softkin.Robot, goal: softkin.Shape, tmp_path: Path) -> None:
    answer = robot.inverse(tip=goal["tip"])
    for name in ("a.png", "a.vtu", "a.json"):
        answer.save(tmp_path / name)
    assert json.loads((tmp_path / "a.json").read_text()) == answer.report
    answer.shape.save(tmp_path / "s.vtu")
    assert (tmp_path / "a.vtu").read_bytes() == (tmp_path / "s.vtu").read_bytes()
    picture = (tmp_path / "a.png").read_bytes()
    assert picture == answer.png() == answer._repr_png_() != answer.shape.png()
    assert answer.png(view=(0, 0, 1)) != picture
    with pytest.raises(ValueError, match="path must end in .vtu, .png or .json, not 'a.gif'"):
        answer.save(tmp_path / "a.gif")


def test_targets_in_other_units(robot: softkin.Robot, goal: softkin.Shape) -> None:
    with pytest.warns(softkin.SoftkinWarning, match="target of 'tip': .* in metres: are they"):
        robot.inverse(tip=goal["tip"] / 1000, max_equilibria=1)
    with pytest.warns(softkin.SoftkinWarning, match="another unit than mm"):
        robot.session().inverse(tip=goal["tip"] * 1000, max_equilibria=1)


def test_out_of_reach(robot: softkin.Robot) -> None:
    answer = robot.inverse(tip=(0, 200, 0))
    assert answer.status == "not reached" and not answer.reached and answer.reason
    assert set(answer.at_end_of_range.values()) <= {"low", "high"} and answer.at_end_of_range
    assert answer.error_mm > 10
    with pytest.raises(softkin.NotConverged, match="not reached"):
        answer.require()


def test_sensitivity(robot: softkin.Robot) -> None:
    from beams import beam

    force, modulus = "forces.payload.force.3", "materials.1.youngs_modulus"
    description = {
        "forces": [{"name": "payload", "region": "end", "force": [0, 0, -0.01]}],
        "actuators": [{"name": "pull", "kind": "cable", "range": (0.8, 1), "points": [[0, 4, 4], [32, 4, 4], [64, 4, 4]]}],
    }
    loaded = beam(8, 2, **description)
    shape = loaded.solve(pull=0.96, solver=softkin.Solver(tolerance_mm=1e-10))
    by = loaded.sensitivity(shape, [force, modulus])
    assert by[force].value == -0.01 and by[modulus].value == 1

    def tip(load: float, stiffness: float) -> tuple[softkin.Shape, float]:
        other = {**description, "forces": [{"name": "payload", "region": "end", "force": [0, 0, load]}]}
        found = beam(8, 2, **other, materials=[{"youngs_modulus": stiffness, "poisson_ratio": 0.4}])
        solved = found.solve(pull=0.96, solver=softkin.Solver(tolerance_mm=1e-10))
        return solved, solved.actuators["pull"].tension_N

    for number, more, less, step in [
        (force, tip(-0.01 + 1e-4, 1), tip(-0.01 - 1e-4, 1), 2e-4),
        (modulus, tip(-0.01, 1.001), tip(-0.01, 0.999), 2e-3),
    ]:
        moves = (more[0]["tip"] - less[0]["tip"]) / step
        np.testing.assert_allclose(by[number].markers["tip"], moves, rtol=1e-4, atol=1e-5 * abs(moves).max())
        positions = (more[0].positions - less[0].positions) / step
        np.testing.assert_allclose(by[number].positions, positions, atol=1e-4 * abs(positions).max())
        assert by[number].loads["pull"] == pytest.approx((more[1] - less[1]) / step, rel=1e-4)
    away = np.random.default_rng(1).normal(size=shape.positions.shape)
    found = loaded.gradient(shape, [force, modulus], positions=away, markers={"tip": (1, -2, 3)}, loads={"pull": 0.5})
    for number, value in found.items():
        expected = (away * by[number].positions).sum() + by[number].markers["tip"] @ (1, -2, 3)
        assert value == pytest.approx(expected + 0.5 * by[number].loads["pull"], rel=1e-6)
    text = (Path(__file__).resolve().parents[2] / "docs/python.md").read_text()
    (shown,) = [each for each in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S) if "robot.gradient(" in each]
    names: dict[str, Any] = {"robot": loaded, "shape": shape}
    exec(compile(shown, "docs/python.md", "exec"), names)
    miss = shape["tip"] - [40, 0, -80]
    assert names["slopes"][modulus] == pytest.approx(2 * miss @ by[modulus].markers["tip"], rel=1e-6)
    with pytest.raises(ValueError, match="loads names 'push', which is no actuator; there are pull"):
        loaded.gradient(shape, force, loads={"push": 1})
    with pytest.raises(softkin.InvalidInput, match="youngs_modulus"):
        loaded.sensitivity(shape, "materials.1.youngs_modulos")
    with pytest.raises(ValueError, match="another robot"):
        robot.sensitivity(shape, force)


def test_jacobian(robot: softkin.Robot, goal: softkin.Shape) -> None:
    slopes = robot.jacobian(goal, "tip")
    assert slopes.shape == (3, 3) and robot.jacobian(goal).shape == (3, 3)
    step = 1e-4
    moved = robot.solve(goal.actuation + [0, step, 0], start=goal)
    np.testing.assert_allclose((moved["tip"] - goal["tip"]) / step, slopes[:, 1], rtol=1e-2, atol=1e-3)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({}, "goal"),
        ({"tpi": (0, 0, 0)}, "no marker 'tpi'; did you mean 'tip'"),
        ({"tip": (0, 0)}, "target of 'tip' must be three coordinates"),
        ({"tip": (0, 0, float("nan"))}, "the target of 'tip'.* is nan"),
        ({"tip": (None, None, None)}, "axis|coordinate"),
        ({"tip": (0, 0, 0), "weights": {"end": 1}}, "weights: there is no goal for 'end'"),
        ({"tip": (0, 0, 0), "fix": ["ari1"]}, "no actuator 'ari1'"),
        ({"tip": (0, 0, 0), "method": "luck"}, "method must be 'newton' or 'gradient', not 'luck'"),
        ({"tip": (0, 0, 0), "fix": ["air1"], "prefer": {"air1": 1.2}}, "fix: 'air1' does not change"),
        ({"planes": {"tip": ((0, 0, 0), (0, 0, 0))}}, "normal"),
    ],
)
def test_wrong_goals(robot: softkin.Robot, keywords: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        robot.inverse(**keywords)  # type: ignore[arg-type]


def test_a_start_that_stays_best_is_reported(robot: softkin.Robot, goal: softkin.Shape) -> None:
    """The report agrees with that of the solve that found the start."""
    answer = robot.inverse(tip=goal["tip"], start=goal)
    assert answer.reached and answer.equilibria == 0 and answer.shape.iterations == goal.iterations
    (reported,), (known,) = answer.report["steps"], goal.report["steps"]
    for key in ("step_mm", "residual_N", "pull_N", "energy"):
        assert (key in reported) == (key in known) and reported.get(key) == known.get(key), key
    assert reported["pull_N"] > 0
    again = robot.session()
    again.solve(air1=1.4, air2=1.3, air3=1.2)
    assert again.inverse(tip=goal["tip"]).report["steps"][0]["pull_N"] == pytest.approx(reported["pull_N"], rel=1e-6)


def test_session(robot: softkin.Robot, goal: softkin.Shape) -> None:
    session = robot.session()
    assert session.robot is robot and session.shape is None
    assert session.solve(air1=1.4, air2=1.3, air3=1.2).converged
    np.testing.assert_allclose(session.shape.positions, goal.positions, atol=1e-5)  # type: ignore[union-attr]
    first = session.inverse(tip=goal["tip"] + [0.02, 0.02, 0.02])
    second = session.inverse(tip=goal["tip"] + [0.04, 0.04, 0.04])
    assert first.reached and second.reached and second.equilibria <= 2
    assert session.jacobian(session.shape, "tip").shape == (3, 3)  # type: ignore[arg-type]
    assert "Session of beam" in repr(session)
    session.forget()
    assert session.shape is None
    again = session.solve(air1=1.4, air2=1.3, air3=1.2)
    np.testing.assert_array_equal(again.positions, goal.positions)
