"""To other packages and back; a test skips, and says so, where one is not installed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from beams import block

import softkin

DESCRIPTION = {
    "materials": [{"youngs_modulus": 1, "poisson_ratio": 0.4}],
    "fixed": [{"halfspace": {"point": (0, 0, 0), "normal": (-1, 0, 0)}}],
}


BOTH_WAYS = {
    "meshio": (softkin.Shape.to_meshio, softkin.Robot.from_meshio),
    "pyvista": (softkin.Shape.to_pyvista, softkin.Robot.from_pyvista),
}


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", BOTH_WAYS)
def test_there_and_back(name: str, order: int) -> None:
    pytest.importorskip(name, reason=f"{name} is not installed")
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    robot = softkin.Robot(vertices, tetrahedra, order=order, **DESCRIPTION)
    shape = robot.solve()
    to, back = BOTH_WAYS[name]
    mesh = to(shape)
    again = back(mesh, **DESCRIPTION)
    np.testing.assert_allclose(again.rest, robot.rest, atol=1e-9)
    np.testing.assert_array_equal(again.tetrahedra, robot.tetrahedra)
    np.testing.assert_array_equal(again.edge_nodes, robot.edge_nodes)
    data = mesh.point_data["displacement_mm"]
    np.testing.assert_array_equal(data, shape.displacements)


def test_regions_of_meshio(examples: Path) -> None:
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    mesh = meshio.read(examples / "two_material_bar/two_material_bar.msh")
    file = softkin.load(examples / "two_material_bar/two_material_bar.yaml")
    robot = softkin.Robot.from_meshio(mesh, **DESCRIPTION)
    assert set(file.region_names) <= set(robot.region_names)


def test_pyvista_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch, robot: softkin.Robot) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyvista", None)
    with pytest.raises(ImportError, match="pyvista"):
        robot.solve().to_pyvista()
