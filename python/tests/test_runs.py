from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from beams import beam

import softkin

STEPS = [[1.1, 1, 1], [1.2, 1, 1], [1.2, 1.1, 1]]


def test_path(robot: softkin.Robot) -> None:
    run = robot.path(STEPS, times=[0, 1, 2.5])
    assert len(run) == 3 and run.done == 0
    first = next(run)
    assert first.actuation.tolist() == STEPS[0] and run.done == 1
    rest = list(run)
    assert len(rest) == 2 and all(shape.converged for shape in rest)
    assert [step["time_s"] for step in run.report["steps"]] == [0, 1, 2.5]
    assert "3 of 3 steps" in repr(run)
    by_name = list(robot.path([{"air1": 1.1}, {"air1": 1.2}, {"air1": 1.2, "air2": 1.1}]))
    assert [shape.fingerprint for shape in by_name] == [shape.fingerprint for shape in [first, *rest]]


def test_a_motor_with_play_along_a_path() -> None:
    pull = {"name": "pull", "kind": "cable", "control": "tension", "range": [0, 2], "points": [(0, 10, 18), (32, 10, 18), (64, 10, 18)]}
    reported, acts = [0.4, 1, 0.8, 0.3, 0.5, 0.9], [0.4, 1, 1, 0.8, 0.8, 0.9]
    exact = list(beam(actuators=[pull]).path([[tension] for tension in acts]))
    playing = list(beam(actuators=[{**pull, "backlash": 0.5}]).path([[tension] for tension in reported]))
    for shape, other, tension in zip(playing, exact, reported):
        np.testing.assert_array_equal(shape.positions, other.positions)
        assert shape.actuators["pull"].tension_N == other.actuators["pull"].tension_N
        assert shape.actuation.tolist() == [tension]
    with pytest.raises(softkin.InvalidInput, match="backlash"):
        beam(actuators=[{**pull, "backlash": -1}])


ANGLES = [40, 120, 172, 186, 290, 370, 200, 30, -50]


def turning_beam() -> softkin.Robot:
    """Turned as a whole by its support, so that everything in it turns by the command."""
    support = {"region": "base", "rotation": {"axis": [0, 0, 1], "about": [0, 0, 0]}}
    return beam(4, 5, fixed=[support], actuators=[], markers={"tip": "end", "root": (1, 10, 10), "top": (60, 10, 19)})


def test_turns_are_continued_along_a_path(tmp_path: Path) -> None:
    turning = turning_beam()
    run = turning.path([[angle] for angle in ANGLES], store=tmp_path)
    shapes = [next(run), next(run), next(run), next(run)]
    np.testing.assert_allclose(run.turns("root", "tip"), ANGLES[:4], atol=1e-4)
    del run  # or its store would be locked
    run = turning.path([[angle] for angle in ANGLES], store=tmp_path)  # goes on there
    shapes += run
    assert run.turns("root", "tip").shape == (len(ANGLES),)
    for turns in (run.turns("root", "tip"), run.turns("tip", "root"), run.turns("tip")):
        np.testing.assert_allclose(turns, ANGLES, atol=1e-4)
    for shape, angle in zip(shapes, ANGLES):
        for same in (shape, pickle.loads(pickle.dumps(shape))):
            assert same.turn("root", "tip") == pytest.approx(angle, abs=1e-4)
            assert same.turn("tip") == pytest.approx(angle, abs=1e-4)
            assert same.report["steps"][0]["marker_turns_deg"]["tip"] == same.turn("tip")
    assert [step["marker_turns_deg"]["tip"] for step in run.report["steps"]] == run.turns("tip").tolist()


def test_turns_of_a_shape_alone_and_of_what_has_none() -> None:
    turning = turning_beam()
    alone = turning.solve(base_turn=200)
    assert alone.turn("tip") == pytest.approx(160, abs=1e-4)  # the direction of the turn is unknown
    assert alone.turn("root", "tip") == pytest.approx(160, abs=1e-4)
    run = turning.path([[10]])
    for turns in (alone.turn, run.turns):
        with pytest.raises(softkin.InvalidInput, match="'top' is a point of the body, which has no orientation"):
            turns("top")
        with pytest.raises(softkin.InvalidInput, match="no marker 'tap'"):
            turns("tap")
        with pytest.raises(softkin.InvalidInput, match="turns?: there is no marker 'rot'.*'root'"):
            turns("rot", "tip")
        with pytest.raises(softkin.InvalidInput, match="are at one place at rest"):
            turns("tip", "tip")
    assert run.turns("tip").shape == (0,)


def test_path_goes_on_where_it_was(robot: softkin.Robot, tmp_path: Path) -> None:
    whole = [shape.fingerprint for shape in robot.path(STEPS)]
    for _ in robot.path(STEPS, store=tmp_path / "run"):
        break
    run = robot.path(STEPS, store=tmp_path / "run")
    assert run.done == 1
    assert [shape.fingerprint for shape in run] == whole[1:]
    report = json.loads((tmp_path / "run/report.json").read_text())
    assert [step["shape_fingerprint"] for step in report["steps"]] == whole
    assert (tmp_path / "run/path.pvd").exists() and not (tmp_path / "run/report.json.run").exists()
    with pytest.raises(softkin.InvalidInput, match="report.json: cannot go on from this report: .*the path has changed"):
        robot.path([[1.3, 1, 1], *STEPS[1:]], store=tmp_path / "run")


def test_unfinished_path_tells_what_there_is(robot: softkin.Robot, tmp_path: Path) -> None:
    run = robot.path(STEPS, store=tmp_path)
    next(run)
    run.finish()
    assert len(json.loads((tmp_path / "report.json").read_text())["steps"]) == 1


def targets(robot: softkin.Robot) -> np.ndarray:
    return np.array([shape["tip"] for shape in robot.path([[1.2, 1.2, 1.1], [1.25, 1.2, 1.1], [1.3, 1.2, 1.1]])])


def test_follow(robot: softkin.Robot, tmp_path: Path) -> None:
    path = targets(robot)
    run = robot.follow(path, times=[0, 0.5, 1])
    assert len(run) == 3
    waypoints = list(run)
    assert run.done == 3 and all(waypoint.reached for waypoint in waypoints)
    last = waypoints[-1]
    assert last.number == 2 and last.status == "reached" and last.time_s == 1 and not last.inserted
    assert last.error_mm < 1e-3 and last.equilibria >= 1 and last.reason == ""
    assert last.targets == {"tip": path[2].tolist()} and last.actuation["air1"] == pytest.approx(1.3, abs=1e-3)
    assert last.step == run.report["steps"][2]
    assert run.commands.columns == ["t_s", "air1", "air2", "air3"] and len(run.commands) == 3
    assert run.commands["air1"][2] == last.actuation["air1"]
    assert len(run.errors.rows) == 3 and "t_s" in run.commands.csv()
    assert "<table>" in run.commands._repr_html_() and "air1" in repr(run.commands)
    assert len(run.report["steps"]) == 3 and "3 of 3 waypoints" in repr(run)
    for _ in robot.follow({"tip": path}, times=[0, 0.5, 1], store=tmp_path):
        break
    again = robot.follow({"tip": path}, times=[0, 0.5, 1], store=tmp_path)
    assert again.done == 1
    assert [w.shape.fingerprint for w in again] == [w.shape.fingerprint for w in waypoints[1:]]
    assert (tmp_path / "commands.csv").read_text() == run.commands.csv()
    assert (tmp_path / "errors.csv").read_text() == run.errors.csv()
    assert "</svg>" in (tmp_path / "path.svg").read_text()


def test_follow_with_waypoints_between_and_free_coordinates(robot: softkin.Robot) -> None:
    path = targets(robot)
    dense = robot.follow(path, max_step_mm=0.05, start={"air1": 1.2})
    assert len(dense) > 3
    assert next(dense).reached and next(dense).inserted
    path[:, 0] = np.nan
    for waypoint in robot.follow(path, marker="tip"):
        assert waypoint.reached and waypoint.targets["tip"][0] is None


def test_follow_from_a_workspace(robot: softkin.Robot, tmp_path: Path) -> None:
    robot.workspace(8, store=tmp_path / "w.csv")
    assert next(robot.follow(targets(robot), workspace=tmp_path / "w.csv")).reached
    with pytest.raises(softkin.InvalidInput, match="w.csv: is of another robot"):
        beam(materials=[{"youngs_modulus": 2, "poisson_ratio": 0.4}]).follow(targets(robot), workspace=tmp_path / "w.csv")


def test_follow_by_nearest_samples(robot: softkin.Robot, tmp_path: Path) -> None:
    path = targets(robot)
    made = list(robot.follow(path, method="nearest", samples=8))
    assert [waypoint.equilibria for waypoint in made] == [9, 1, 1]
    low, high = robot.ranges.T
    for waypoint in made:
        commands = np.array([waypoint.actuation[name] for name in robot.actuators])
        assert np.all((commands == low) | (commands == high)) and not waypoint.reached
        assert waypoint.reason == "the nearest of 8 samples"
    robot.workspace(8, store=tmp_path / "w.csv")
    known = list(robot.follow(path, method="nearest", workspace=tmp_path / "w.csv"))
    assert [waypoint.actuation for waypoint in known] == [waypoint.actuation for waypoint in made]
    assert [waypoint.equilibria for waypoint in known] == [1, 1, 1]
    for options in ({"method": "nearest"}, {"method": "nearest", "samples": 8, "workspace": "w.csv"}, {"samples": 8}):
        with pytest.raises(ValueError, match="samples"):
            robot.follow(path, **options)  # type: ignore[arg-type]


def test_wrong_paths(robot: softkin.Robot, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"steps must have shape \(n, 3\), not \(2, 2\)"):
        robot.path([[1, 1], [1, 1]])
    with pytest.raises(ValueError, match="'air1': the ratio 9 is outside"):
        robot.path([[9, 1, 1]])
    with pytest.raises(ValueError, match="times must ascend"):
        robot.path(STEPS, times=[0, 0, 1])
    with pytest.raises(ValueError, match=r"times must have shape \(3,\)"):
        robot.path(STEPS, times=[0, 1])
    with pytest.raises(softkin.InvalidInput, match="nothing.csv"):
        robot.path(tmp_path / "nothing.csv")
    with pytest.raises(ValueError, match=r"path: tip must have shape \(n, 3\)"):
        robot.follow([1, 2, 3])
    with pytest.raises(ValueError, match="counts at every waypoint"):
        robot.follow([[1, 2, 3], [np.nan, 2, 3]])
    with pytest.raises(ValueError, match="no coordinate counts"):
        robot.follow([[np.nan] * 3])
    with pytest.raises(softkin.InvalidInput, match="no marker 'top'"):
        robot.follow({"top": [[1, 2, 3]]})
    with pytest.warns(softkin.SoftkinWarning, match="the path"):
        robot.follow([[64000, 1000, 1000]])


@pytest.mark.deep
def test_tables_with_pandas(robot: softkin.Robot) -> None:
    pytest.importorskip("pandas", reason="pandas is not installed")
    run = robot.follow(targets(robot)[:1])
    list(run)
    assert list(run.commands.to_pandas().columns) == run.commands.columns
