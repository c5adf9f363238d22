"""The same scene gives the same bits from the command and from Python."""

from __future__ import annotations

import csv
import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

import softkin

SCENES = {
    "cable_gripper/cable_gripper.yaml": {"cable": [0.95]},
    "cable_gripper_two_materials/a.yaml": {"cable": [0.95]},
    "cable_gripper_two_materials/b.yaml": {"cable": [0.95]},
    "dea_crawler/dea_crawler.yaml": {"skin": [0.85]},
    "pneumatic_finger/pneumatic_finger.yaml": {"air": [1.1]},
    "three_chamber_actuator/three_chamber_actuator.yaml": {"air1": [1.2, 1.3], "air2": [1.0, 1.1]},
    "three_tendon_finger/three_tendon_finger.yaml": {"tendon1": [0.95], "tendon2": [0.9]},
    "two_material_bar/two_material_bar.yaml": {},
}


def without_times(value: Any) -> Any:
    """A report without what differs from run to run and by where it is written."""
    if isinstance(value, dict):
        left_out = ("seconds", "shape", "shape_fingerprint")
        return {key: without_times(item) for key, item in value.items() if key not in left_out}
    return [without_times(item) for item in value] if isinstance(value, list) else value


@pytest.mark.parametrize("scene", SCENES)
def test_forward_kinematics(scene: str, examples: Path, command: str, tmp_path: Path) -> None:
    columns = SCENES[scene]
    file = examples / scene
    report = tmp_path / "report.json"
    arguments = [command, "fk", str(file), "--report", str(report)]
    robot = softkin.load(file)
    if not columns:  # no actuator: at rest under its loads
        subprocess.run([*arguments, "-o", str(tmp_path / "shape.vtu")], check=True, capture_output=True)
        assert without_times(robot.solve().report) == without_times(json.loads(report.read_text()))
        return
    path = tmp_path / "path.csv"
    with path.open("w", newline="") as stream:
        rows = csv.writer(stream)
        rows.writerow(columns)
        rows.writerows(zip(*columns.values()))
    subprocess.run([*arguments, "--path", str(path), "-o", str(tmp_path / "path.pvd")], check=True, capture_output=True)
    told = json.loads(report.read_text())
    run = robot.path(path)
    shapes = list(run)
    assert without_times(run.report) == without_times(told)
    assert [shape.fingerprint for shape in shapes] == [step["shape_fingerprint"] for step in told["steps"]]


def test_a_solve_is_the_first_step_of_a_path(examples: Path) -> None:
    robot = softkin.load(examples / "three_chamber_actuator/three_chamber_actuator.yaml")
    run = robot.path([{"air1": 1.2}])
    step, shape = next(run), robot.solve(air1=1.2)
    assert shape.fingerprint == step.fingerprint
    assert without_times(shape.report) == without_times(run.report)


def test_inverse_kinematics(examples: Path, command: str, tmp_path: Path) -> None:
    scene, report = examples / "three_chamber_actuator/three_chamber_actuator.yaml", tmp_path / "ik.json"
    robot = softkin.load(scene)
    target = robot.solve(air1=1.3, air2=1.1)["tip"]
    text = "tip=" + ",".join(repr(x) for x in target.tolist())
    subprocess.run([command, "ik", str(scene), "--target", text, "--report", str(report)], check=True, capture_output=True)
    answer = robot.inverse(tip=target)
    assert answer.reached
    assert without_times(answer.report) == without_times(json.loads(report.read_text()))


def test_follow(examples: Path, command: str, tmp_path: Path) -> None:
    scene = examples / "three_chamber_actuator/three_chamber_actuator.yaml"
    robot = softkin.load(scene)
    path = tmp_path / "path.csv"
    tips = [shape["tip"] for shape in robot.path([{"air1": 1.1}, {"air1": 1.15}])]
    path.write_text("x_mm,y_mm,z_mm\n" + "".join(",".join(map(repr, tip.tolist())) + "\n" for tip in tips))
    out = tmp_path / "out"
    subprocess.run([command, "follow", str(scene), str(path), "-o", str(out)], check=True, capture_output=True)
    run = robot.follow(path)
    waypoints = list(run)
    assert len(waypoints) == 2 and all(waypoint.reached for waypoint in waypoints)
    told = json.loads((out / "report.json").read_text())
    assert without_times(run.report) == without_times(told)
    assert [w.shape.fingerprint for w in waypoints] == [step["shape_fingerprint"] for step in told["steps"]]
    assert run.commands.csv() == (out / "commands.csv").read_text()
    assert run.errors.csv() == (out / "errors.csv").read_text()


def test_workspace(examples: Path, command: str, tmp_path: Path) -> None:
    scene = examples / "three_chamber_actuator/three_chamber_actuator.yaml"
    ours, theirs = tmp_path / "ours.csv", tmp_path / "theirs.csv"
    arguments = ["--samples", "4", "--sampling", "random", "--seed", "3", "-o", str(theirs)]
    subprocess.run([command, "workspace", str(scene), *arguments], check=True, capture_output=True)
    robot = softkin.load(scene)
    stored = robot.workspace(4, sampling="random", seed=3, store=ours)
    assert ours.read_text() == theirs.read_text()
    in_memory = robot.workspace(4, sampling="random", seed=3)
    assert in_memory.samples.tobytes() == stored.samples.tobytes()
