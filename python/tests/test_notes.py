"""What Python says about a shape is what the command prints about it."""

from __future__ import annotations

import subprocess
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beams import block

import softkin
from softkin.mesh import VolumeMesh

SCENE = """softkin: 1
mesh: {file: fork.msh}
materials: [{youngs_modulus: 1, poisson_ratio: 0.4}]
fixed: [{region: base}]
actuators: [{name: tie, kind: cable, points: [[40, 5, 0], [40, 5, 25]], range: [0.5, 1]}]
markers: [{name: tip, point: [40, 5, 25]}]
"""


def fork(folder: Path) -> Path:
    """Two prongs that a cable pulls together, 5 mm apart at rest; they pass through each other."""
    vertices, tetrahedra = block((8, 2, 5), (40, 10, 25))
    middle = vertices[tetrahedra].mean(axis=1)
    solid = tetrahedra[(middle[:, 0] < 10) | (middle[:, 2] < 10) | (middle[:, 2] > 15)]
    used, numbers = np.unique(solid, return_inverse=True)
    vertices, solid = vertices[used], numbers.reshape(-1, 4)
    faces = [t[list(c)] for t in solid for c in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)) if (vertices[t[list(c)], 0] == 0).all()]
    mesh = VolumeMesh(vertices, solid, {"body": np.arange(len(solid))}, {"base": np.array(faces)})
    mesh.write(folder / "fork.msh")
    (folder / "fork.yaml").write_text(SCENE)
    return folder / "fork.yaml"


def quiet(scene: Path) -> softkin.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", softkin.SoftkinWarning)
        return softkin.load(scene)


def printed_by(command: str, scene: Path, *options: str) -> list[str]:
    done = subprocess.run([command, "fk", str(scene), *options], capture_output=True, text=True)
    return done.stdout.splitlines()


def test_a_shape_that_passes_through_itself(command: str, tmp_path: Path) -> None:
    robot = quiet(fork(tmp_path))
    with pytest.warns(softkin.SoftkinWarning, match="the shape passes through itself") as raised:
        shape = robot.solve(tie=0.6)
    assert shape.self_overlap.points > 0 and shape.report["steps"][0]["self_overlap"]["points"] == shape.self_overlap.points
    assert [str(each.message) for each in raised] == shape.warnings and raised[0].filename == __file__
    lines = printed_by(command, tmp_path / "fork.yaml", "--set", "tie=0.6")
    assert shape.findings and all(line in lines for line in shape.findings)
    assert [line for line in lines if line.startswith("warning: the shape")] == [f"warning: {shape.warnings[0]}"]


def test_every_call_warns_as_the_command_does(tmp_path: Path) -> None:
    robot = quiet(fork(tmp_path))
    with pytest.warns(softkin.SoftkinWarning, match="passes through itself"):
        target = robot.solve(tie=0.6)["tip"]
    with pytest.warns(softkin.SoftkinWarning, match="passes through itself"):
        robot.inverse(tip=target)
    with pytest.warns(softkin.SoftkinWarning) as raised:
        shapes = list(robot.path([[0.9], [0.6], [0.58]]))
    assert ["step 1: the shape passes through itself" in str(each.message) for each in raised] == [True]  # once
    assert [len(shape.warnings) for shape in shapes] == [0, 1, 1]
    with pytest.warns(softkin.SoftkinWarning, match="waypoint 0: the shape passes through itself"):
        list(robot.follow([target], marker="tip"))


def test_sessions_and_budgets_spare_the_time(tmp_path: Path) -> None:
    robot = quiet(fork(tmp_path))
    session = robot.session()
    with warnings.catch_warnings():
        warnings.simplefilter("error", softkin.SoftkinWarning)
        shape = session.solve(tie=0.6)
        robot.solve(tie=0.6, budget_s=1000)
        robot.solve(tie=0.95)
    assert "passes through itself" in shape.warnings[0]


def test_other_findings(robot: softkin.Robot) -> None:
    shape = robot.solve(air1=1.3)
    assert shape.warnings == [] and any(line.startswith("support 'base' exerts") for line in shape.findings)
    vertices, tetrahedra = block((6, 1, 1), (60, 4, 4))
    strut = softkin.Robot(
        vertices,
        tetrahedra,
        materials=[{"youngs_modulus": 1, "poisson_ratio": 0.4}],
        fixed=[{"box": ((-1, -1, -1), (0.1, 5, 5))}],
        forces=[{"name": "load", "point": (60, 2, 2), "range": [[-1, 0], [0, 0], [0, 0]]}],
    )
    pressed = strut.solve(load_fx=-0.02)
    if pressed.converged and pressed.unstable_modes:
        assert any("solver=softkin.Solver(stable=True) looks for" in line for line in pressed.warnings)


def surface_volume(points: Any, triangles: Any) -> float:
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("order", [1, 2])
def test_surface_of_a_robot(order: int) -> None:
    """Closed, turned outwards: the volume inside is the body's, and of a chamber its own is left out."""
    vertices, tetrahedra = block((6, 4, 4), (60, 20, 20))
    middle = vertices[tetrahedra].mean(axis=1)
    inside = ((middle > (20, 5, 5)) & (middle < (40, 15, 15))).all(axis=1)
    robot = softkin.Robot(
        vertices,
        tetrahedra,
        regions={"hole": inside},
        materials=[{"youngs_modulus": 1, "poisson_ratio": 0.4}],
        fixed=[{"box": ((-1, -1, -1), (0.1, 21, 21))}],
        actuators=[{"name": "air", "kind": "pneumatic", "region": "hole", "control": "pressure", "range": (0, 50)}],
        order=order,
    )
    surface = robot.surface
    assert surface.dtype == np.int32 and surface.shape[1] == 3
    assert surface_volume(robot.rest, surface) == pytest.approx(60 * 20 * 20 - 20 * 10 * 10, rel=1e-12)
    edges = np.sort(surface[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert (counts == 2).all()
    corners = robot.rest[surface].reshape(-1, 3)
    outer = (np.abs(corners - 30) >= 30 - 1e-9)[:, 0] | (np.abs(corners[:, 1:] - 10) >= 10 - 1e-9).any(axis=1)
    walls = ((corners >= (20 - 1e-9, 5 - 1e-9, 5 - 1e-9)) & (corners <= (40 + 1e-9, 15 + 1e-9, 15 + 1e-9))).all(axis=1)
    assert (outer | walls).all() and walls.any()
    deformation = robot.solve(air=5).positions
    assert surface_volume(deformation, surface) > 0


def test_places_of_robots_by_changes(tmp_path: Path) -> None:
    fork(tmp_path)
    pair = tmp_path / "pair.yaml"
    pair.write_text("softkin: 1\nrobots:\n  - {name: a, scene: fork.yaml}\n  - {name: b, scene: fork.yaml, place: {translate: [0, 0, 100]}}\n")
    rest = quiet(pair).rest
    half = len(rest) // 2
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", softkin.SoftkinWarning)
        turned = softkin.load(
            pair,
            changes={
                "robots.b.place.rotate": [{"axis": (0, 0, 1), "degrees": 90}, {"quaternion": np.array([0.5, 0.5, 0.5, 0.5])}]
            },
        ).rest
    x, y, z = rest[:half].T  # about z: (-y, x, z); the quaternion permutes: (z, x, y)
    np.testing.assert_allclose(turned[half:], np.stack([z, -y, x], axis=1) + (0, 0, 100), atol=1e-9)
    with pytest.raises(softkin.InvalidInput, match=r"must be a unit quaternion \[w, x, y, z\], but its norm is 2"):
        softkin.load(pair, changes={"robots.b.place.rotate": {"quaternion": [1, 1, 1, 1]}})


def test_a_cable_in_metres_is_warned_of() -> None:
    vertices, tetrahedra = block((6, 2, 2), (65, 20, 20))
    with pytest.warns(softkin.SoftkinWarning, match="The points of cable 't' span 0.065 mm, where the robot is 70.89 mm across; a"):
        softkin.Robot(
            vertices,
            tetrahedra,
            order=2,
            materials=[{"youngs_modulus": 1, "poisson_ratio": 0.4}],
            fixed=[{"box": ((-1, -1, -1), (0.1, 21, 21))}],
            actuators=[
                {"name": "t", "kind": "cable", "points": [(0, 0, 0.002), (0.065, 0, 0.002)], "control": "tension", "range": (0, 1)}
            ],
        )
