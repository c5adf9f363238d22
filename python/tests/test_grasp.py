"""Grasps, against Coulomb's limits."""

from __future__ import annotations

import json
import pickle
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beams import block

import softkin

G = 9.81  # [m/s^2]
FRICTION = 0.4
WEIGHT = 9e-3 * G  # of a plate of 30 x 30 x 10 mm, 1000 kg/m^3 [N]
PLATE = {"name": "plate", "box": [[-4.7, -5.1, -10.14], [25.3, 24.9, -0.14]], "density": 1000}


def gripper(**changes: Any) -> softkin.Robot:
    """A block of rubber that hangs from its top face, below it a plate of 9 g, and a floor that rises as commanded."""
    vertices, tetrahedra = block((2, 2, 2), (20, 20, 20))
    description: dict[str, Any] = {
        "regions": {"top": {"vertices": np.flatnonzero(vertices[:, 2] == 20)}},
        "materials": [{"youngs_modulus": 1, "poisson_ratio": 0.3}],
        "fixed": [{"region": "top"}],
        "actuators": [],
        "gravity": [0, 0, -G],
        "contact": {"distance": 0.05, "friction": FRICTION},
        "obstacles": [{"name": "floor", "halfspace": {"point": [0, 0, -10.2], "normal": [0, 0, 1]}, "motion": ["z"]}],
        "bodies": [PLATE],
    }
    return softkin.Robot(vertices, tetrahedra, **{**description, **changes})


@pytest.fixture(scope="module")
def robot() -> softkin.Robot:
    return gripper()


def test_a_plate_on_a_floor(robot: softkin.Robot) -> None:
    """Coulomb's limit holds it."""
    reported: list[softkin.Progress] = []
    grasp = robot.grasp(directions=["x", (0, -3, 0)], progress=reported.append)
    assert isinstance(grasp, softkin.Grasp) and grasp.require() is grasp
    assert grasp.held and grasp.reason == "" and grasp.body == "plate" and grasp.robot is robot
    (floor,) = grasp.shape.contacts
    assert (floor.on, floor.by) == ("plate", "floor") and floor.force_N[2] == pytest.approx(WEIGHT, rel=1e-6)
    along, across = grasp.pulls
    assert isinstance(along, softkin.Pull)
    assert (along.name, across.name) == ("x", "0,-3,0")
    np.testing.assert_allclose(across.direction, [0, -1, 0])
    for pull in (along, across):
        assert pull.force_N == pytest.approx(FRICTION * WEIGHT, rel=0.01)
        assert (pull.end, pull.status) == ("slips", "limit")
        assert pull.normal_N == pytest.approx(WEIGHT, rel=1e-6)
        assert pull.slipping is not None and 0 <= pull.slipping <= 1
        moved = pull.shape["plate"] - grasp.shape["plate"]
        assert pull.moved_mm == pytest.approx(np.linalg.norm(moved), rel=1e-9) and moved @ pull.direction > 0
    assert grasp.table["force_N"].tolist() == [pull.force_N for pull in grasp.pulls]
    assert all(isinstance(each, softkin.Progress) for each in reported)


def test_a_plate_between_a_block_and_a_floor(robot: softkin.Robot) -> None:
    """Both exert the support force of the block, less the weight, and both have friction."""
    grasp = robot.grasp([[1, 0, 0, 0, each] for each in (0.5, 1)], directions="x")
    (pull,) = grasp.require().pulls
    pressed = pull.shape.reactions["top"].force_N
    from_below = -pressed[2] + WEIGHT  # the block weighs nothing
    assert from_below > 5 * WEIGHT
    assert pull.normal_N == pytest.approx(from_below - pressed[2], rel=1e-5)
    assert pull.force_N == pytest.approx(FRICTION * pull.normal_N, rel=0.01)
    assert pull.end == "slips" and -pressed[0] == pytest.approx(FRICTION * -pressed[2], rel=0.02)


def test_it_holds_more_than_is_tried(robot: softkin.Robot) -> None:
    most = 0.5 * FRICTION * WEIGHT
    (pull,) = robot.grasp({"floor_z": 0}, directions=[(0, 2, 0)], most_N=most).pulls
    assert (pull.force_N, pull.end, pull.status) == (most, "holds more", "converged")
    assert pull.shape.converged and pull.shape.actuation[2] == most


def test_a_body_that_falls() -> None:
    grasp = gripper(obstacles=[]).grasp()
    assert not grasp.held and grasp.pulls == [] and len(grasp.table) == 0
    assert grasp.reason.startswith("'plate' is not held when it is released: ") and grasp.reason in repr(grasp)
    assert not grasp.shape.converged
    with pytest.raises(softkin.NotConverged, match="is not held"):
        grasp.require()


def test_it_can_be_stopped(robot: softkin.Robot) -> None:
    grasp = robot.grasp(floor_z=1, progress=lambda _: False)
    if grasp.held:  # progress is not called where a solve takes less than a twentieth of a second
        with pytest.raises(softkin.NotConverged, match="pulling along .*interrupted"):
            grasp.require()
    else:
        assert grasp.reason.startswith("interrupted while ") and grasp.shape.status == "interrupted"


def test_a_grasp_pickles(robot: softkin.Robot) -> None:
    grasp = robot.grasp(directions=["x"])
    again = pickle.loads(pickle.dumps(grasp))
    assert again.held and again.body == "plate" and again.table.csv() == grasp.table.csv()
    assert again.shape.fingerprint == grasp.shape.fingerprint
    assert again.pulls[0].shape.fingerprint == grasp.pulls[0].shape.fingerprint
    assert repr(again) == repr(grasp) and "x 0.03" in repr(grasp) and "slips" in grasp._repr_html_()
    # contacts with friction keep their sticking points in the pickle
    pulled = {"plate_hold": 0, "plate_fx": 0.5 * FRICTION * WEIGHT}
    shapes = [each.robot.solve(pulled, start=each.pulls[0].shape).require() for each in (grasp, again)]
    assert shapes[0].fingerprint == shapes[1].fingerprint


def test_refusals(robot: softkin.Robot) -> None:
    with pytest.raises(softkin.InvalidInput, match="^body: there is no body 'plat'; did you mean 'plate'\\?$"):
        robot.grasp(body="plat")
    with pytest.raises(softkin.InvalidInput, match="^directions must be x, -x, .*, not 'up'$"):
        robot.grasp(directions=["up"])
    with pytest.raises(softkin.InvalidInput, match="not all 0|that are not all 0"):
        robot.grasp(directions=[(0, 0, 0)])
    with pytest.raises(ValueError, match="directions must have shape"):
        robot.grasp(directions=[(0, 1)])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="most_N must be a force > 0 in N, not 0"):
        robot.grasp(most_N=0)
    with pytest.raises(softkin.InvalidInput, match="did you mean 'plate_hold'"):
        robot.grasp({"plate_hol": 0})
    with pytest.raises(ValueError, match=r"closing must have shape \(n, 5\)"):
        robot.grasp([[1, 0]])
    ball = {"name": "ball", "sphere": {"center": [100, 0, 20], "radius": 5}}
    with pytest.raises(softkin.InvalidInput, match="body: there are 2 bodies, plate, ball: say which one is pulled"):
        gripper(bodies=[PLATE, ball]).grasp()
    with pytest.raises(softkin.InvalidInput, match="there is no body to grasp: give it 'bodies'"):
        gripper(bodies=[], gravity=None).grasp()


def test_how_it_is_solved(robot: softkin.Robot) -> None:
    hurried = robot.grasp(directions="x", solver=softkin.Solver(max_iterations=1))
    assert not hurried.held
    with pytest.warns(DeprecationWarning, match="max_iterations= of grasp is deprecated"):
        assert robot.grasp(directions="x", max_iterations=1).reason == hurried.reason


def scene_in(folder: Path) -> Path:
    """The gripper as a scene."""
    vertices, tetrahedra = block((2, 2, 2), (20, 20, 20))
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(vertices))]
    lines += [f"{i} {x} {y} {z}" for i, (x, y, z) in enumerate(vertices, start=1)]
    lines += ["$EndNodes", "$Elements", str(len(tetrahedra))]
    lines += [f"{i} 4 2 1 1 {' '.join(map(str, four + 1))}" for i, four in enumerate(tetrahedra, start=1)]
    (folder / "block.msh").write_text("\n".join([*lines, "$EndElements", ""]))
    scene = folder / "gripper.yaml"
    scene.write_text(
        "softkin: 1\n"
        "mesh: {file: block.msh}\n"
        "regions: [{name: top, box: [[-1, -1, 19.9], [21, 21, 20.1]]}]\n"
        "materials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
        "fixed: [{region: top}]\n"
        f"gravity: [0, 0, -{G}]\n"
        f"contact: {{distance: 0.05, friction: {FRICTION}}}\n"
        "obstacles: [{name: floor, halfspace: {point: [0, 0, -10.2], normal: [0, 0, 1]}, motion: [z]}]\n"
        "bodies: [{name: plate, box: [[-4.7, -5.1, -10.14], [25.3, 24.9, -0.14]], density: 1000}]\n"
    )
    return scene


def test_the_command_gives_the_same_numbers(command: str, tmp_path: Path) -> None:
    scene, path = scene_in(tmp_path), tmp_path / "closing.csv"
    path.write_text("floor_z_mm\n0.5\n1\n")
    arguments = [command, "grasp", str(scene), "--path", str(path), "--pull", "x", "--pull", "-1,0,1", "--json"]
    reported = subprocess.run(arguments, check=True, capture_output=True, text=True).stdout
    grasp = softkin.load(scene).grasp(path, directions=["x", (-1, 0, 1)])
    keys = grasp.table.columns
    assert [dict(zip(keys, row)) for row in grasp.table.rows] == json.loads(reported)


def test_the_document(robot: softkin.Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (Path(__file__).resolve().parents[2] / "docs/python.md").read_text()
    (shown,) = [each for each in re.findall(r"^```python\n(.*?)^```", text, re.M | re.S) if "robot.grasp(" in each]
    monkeypatch.chdir(tmp_path)
    Path("closing.csv").write_text("floor_z_mm\n0.5\n1\n")
    exec(compile(shown, "docs/python.md", "exec"), {"robot": robot})
    assert Path("grasp.png").exists()
