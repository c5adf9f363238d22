"""The same scene gives the same bits from the command and from Python."""

from __future__ import annotations

import csv
import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import softkin
import softkin.mesh

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
    reported = json.loads(report.read_text())
    run = robot.path(path)
    shapes = list(run)
    assert without_times(run.report) == without_times(reported)
    assert [shape.fingerprint for shape in shapes] == [step["shape_fingerprint"] for step in reported["steps"]]


def test_a_solve_is_the_first_step_of_a_path(examples: Path) -> None:
    robot = softkin.load(examples / "three_chamber_actuator/three_chamber_actuator.yaml")
    run = robot.path([{"air1": 1.2}])
    step, shape = next(run), robot.solve(air1=1.2)
    assert shape.fingerprint == step.fingerprint
    assert without_times(shape.report) == without_times(run.report)


def test_turn_of_a_line(examples: Path, command: str, tmp_path: Path) -> None:
    """The column that --turn adds, to its digits."""
    scene, path = examples / "pneumatic_finger/pneumatic_finger.yaml", tmp_path / "path.csv"
    path.write_text("air\n1.1\n1.25\n")
    arguments = [command, "fk", str(scene), "--path", str(path), "--turn", "tip", "end"]
    table = subprocess.run(arguments, check=True, capture_output=True, text=True).stdout
    rows = [line.split() for line in table.splitlines() if line.strip().endswith("converged")]
    reported = [float(row[-4]) for row in rows]  # before iterations, time and status
    run = softkin.load(scene).path(path)
    shapes = list(run)
    assert len(reported) == 2 and reported[1] > reported[0] > 1
    np.testing.assert_allclose(run.turns("tip", "end"), reported, atol=0.06)
    np.testing.assert_allclose([shape.turn("tip", "end") for shape in shapes], reported, atol=0.06)


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
    reported = json.loads((out / "report.json").read_text())
    assert without_times(run.report) == without_times(reported)
    assert [w.shape.fingerprint for w in waypoints] == [step["shape_fingerprint"] for step in reported["steps"]]
    assert run.commands.csv() == (out / "commands.csv").read_text()
    assert run.errors.csv() == (out / "errors.csv").read_text()


def test_walk(examples: Path, command: str, tmp_path: Path) -> None:
    folder = examples / "dea_crawler"
    scene, gait, out = folder / "dea_crawler.yaml", folder / "gait.csv", tmp_path / "theirs"
    arguments = [str(scene), str(gait), "--cycles", "1", "-o", str(out)]
    subprocess.run([command, "walk", *arguments], check=True, capture_output=True)
    run = softkin.load(scene).walk(gait, cycles=1, store=tmp_path / "ours")
    steps = list(run)
    reported = json.loads((out / "report.json").read_text())
    assert without_times(run.report) == without_times(reported) and run.strides_mm.tolist() == reported["stride_mm"]
    assert [step.shape.fingerprint for step in steps] == [step["shape_fingerprint"] for step in reported["steps"]]
    assert run.steps.csv() == (out / "walk.csv").read_text()
    for name in ("walk.csv", "walk.svg", "walk.pvd"):
        assert (tmp_path / "ours" / name).read_text() == (out / name).read_text()


def test_plots(examples: Path, command: str, tmp_path: Path) -> None:
    scene = examples / "three_chamber_actuator/three_chamber_actuator.yaml"
    robot = softkin.load(scene)
    steps, path = tmp_path / "steps.csv", tmp_path / "path.csv"
    steps.write_text("air1\n1.1\n1.15\n")
    run = robot.path(steps)
    tips = [shape["tip"].tolist() for shape in run]
    path.write_text("x_mm,y_mm,z_mm\n" + "".join(",".join(map(repr, tip)) + "\n" for tip in tips))
    theirs, ours = tmp_path / "theirs.svg", tmp_path / "ours.svg"

    def reported(*arguments: object) -> str:
        subprocess.run([command, *map(str, arguments), "--plot", str(theirs)], check=True, capture_output=True)
        return theirs.read_text()

    run.save_plot(ours)
    assert ours.read_text() == reported("fk", scene, "--path", steps)
    followed = robot.follow(path)
    list(followed)
    followed.save_plot(ours)
    assert ours.read_text() == reported("follow", scene, path, "-o", tmp_path / "out")
    answer = robot.inverse(tip=tips[0])
    answer.save_plot(ours)
    assert ours.read_text() == reported("ik", scene, "--target", "tip=" + ",".join(map(repr, tips[0])))
    cloud = robot.workspace(8, store=tmp_path / "w.csv")
    cloud.save_plot(ours)
    files = ["--cloud", tmp_path / "cloud.vtu", "--hull", tmp_path / "hull.stl"]
    assert ours.read_text() == reported("workspace", scene, "--samples", 8, "-o", tmp_path / "v.csv", *files)
    cloud.save(tmp_path / "ours.vtu")
    cloud.save_hull(tmp_path / "ours.stl", marker="tip")
    assert (tmp_path / "ours.vtu").read_bytes() == (tmp_path / "cloud.vtu").read_bytes()
    assert (tmp_path / "ours.stl").read_bytes() == (tmp_path / "hull.stl").read_bytes()
    from_sample = robot.inverse(tip=tips[0], workspace=tmp_path / "w.csv")
    report = tmp_path / "ik.json"
    target = ["--target", "tip=" + ",".join(map(repr, tips[0]))]
    reported("ik", scene, *target, "--workspace", tmp_path / "w.csv", "--report", report)
    assert without_times(from_sample.report) == without_times(json.loads(report.read_text()))
    with pytest.raises(ValueError, match="workspace chooses the start"):
        robot.inverse(tip=tips[0], workspace=tmp_path / "w.csv", start={"air1": 1})
    with pytest.raises(ValueError, match="path must end in .svg, not 'x.png'"):
        cloud.save_plot(tmp_path / "x.png")


def test_meshes(examples: Path, command: str, tmp_path: Path) -> None:
    scene = examples / "three_chamber_actuator/three_chamber_actuator.yaml"
    (mesh,) = [file for file in scene.parent.iterdir() if file.suffix == ".msh"]

    def reported(*arguments: object) -> Any:
        arguments = ("mesh", *arguments, "--json")
        return json.loads(subprocess.run([command, *map(str, arguments)], check=True, capture_output=True).stdout)

    assert softkin.mesh.info(mesh) == reported("info", mesh)
    assert softkin.mesh.info(mesh, "cm") == reported("info", mesh, "--unit", "cm")
    assert softkin.mesh.check(scene) == (True, reported("check", scene))
    ours, theirs = tmp_path / "ours.msh", tmp_path / "theirs.msh"
    found = softkin.mesh.convert(mesh, ours, ascii=True)
    assert {**found, "output": str(theirs)} == reported("convert", mesh, theirs, "--ascii")
    assert ours.read_text() == theirs.read_text()
    with pytest.raises(ValueError, match="unit must be one of mm, cm, m, um, in, not 'ft'"):
        softkin.mesh.info(mesh, "ft")
    with pytest.raises(ValueError, match="a scene names its own unit"):
        softkin.mesh.check(scene, "mm")
    with pytest.raises(ValueError, match="only a .msh can be written as text"):
        softkin.mesh.convert(mesh, tmp_path / "x.stl", ascii=True)


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
