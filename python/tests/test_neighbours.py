"""To other packages and back; a test skips, and says so, where one is not installed."""

from __future__ import annotations

import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from beams import block

import softkin
from softkin.mesh import VolumeMesh, read_msh

pytestmark = pytest.mark.deep

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


@pytest.mark.parametrize("name", BOTH_WAYS)
def test_regions_there_and_back(name: str, examples: Path) -> None:
    pytest.importorskip(name, reason=f"{name} is not installed")
    mesh = read_msh(examples / "two_material_bar/two_material_bar.msh")
    file = softkin.load(examples / "two_material_bar/two_material_bar.yaml")
    robot = BOTH_WAYS[name][1](getattr(mesh, f"to_{name}")(), **DESCRIPTION)
    assert sorted(robot.region_names) == sorted(file.region_names)
    for one in (robot, file):
        assert [one.region_names[i] for i in one.element_regions[[0, -1]]] == ["A", "B"]


def test_regions_of_a_shape_keep_their_names(robot: softkin.Robot) -> None:
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    grid = robot.solve().to_pyvista()
    assert {f"region_{name}" for name in robot.region_names} <= set(grid.field_data.keys())
    middle = {"regions": {"middle": np.arange(40)}, **DESCRIPTION}
    shape = softkin.Robot(*block((6, 2, 2), (60, 20, 20)), **middle).solve()
    again = softkin.Robot.from_pyvista(shape.to_pyvista(), **DESCRIPTION)
    assert again.region_names == ["middle"] and (again.element_regions[:40] == 0).all()
    with pytest.raises(softkin.InvalidInput, match="must be a pyvista.UnstructuredGrid, not a PolyData"):
        softkin.Robot.from_pyvista(pyvista.Sphere(), **DESCRIPTION)


def test_a_grid_has_what_the_vtu_has(robot: softkin.Robot, tmp_path: Path) -> None:
    """As another reader reads it: cells, arrays of points, cells and the whole; with obstacles and a layer, too."""
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    ball = {"name": "ball", "sphere": {"center": (30, 10, 30), "radius": 5}}
    top = {"name": "skin", "region": "top", "thickness": 0.1, "youngs_modulus": 1, "poisson_ratio": 0.3}
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    faces = [t[list(c)] for t in tetrahedra for c in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)) if (vertices[t[list(c)], 2] == 20).all()]
    touching = softkin.Robot(
        vertices, tetrahedra, order=2, regions={"top": np.array(faces)}, layers=[top], contact={}, obstacles=[ball], **DESCRIPTION
    )
    for number, shape in enumerate((robot.solve(air1=1.3), touching.solve())):
        file = tmp_path / f"{number}.vtu"
        shape.save(file)
        grid, read = shape.to_pyvista(), pyvista.read(file)
        np.testing.assert_array_equal(grid.points, read.points)
        np.testing.assert_array_equal(grid.celltypes, read.celltypes)
        np.testing.assert_array_equal(grid.cells, read.cells)
        for ours, theirs in ((grid.point_data, read.point_data), (grid.cell_data, read.cell_data), (grid.field_data, read.field_data)):
            assert sorted(ours.keys()) == sorted(theirs.keys())
            for name in ours.keys():
                np.testing.assert_array_equal(ours[name], theirs[name], err_msg=name)
        assert {"principal_stress_MPa", "converged"} <= set(grid.cell_data.keys()) and "support" in grid.point_data.keys()
        meshio = pytest.importorskip("meshio", reason="meshio is not installed")
        mesh = shape.to_meshio()
        assert sorted(mesh.point_data) == sorted(grid.point_data.keys()) and sorted(mesh.cell_data) == sorted(grid.cell_data.keys())
        assert meshio.read(file).points.shape == mesh.points.shape


def test_a_script_ends_without_a_word(tmp_path: Path, robot: softkin.Robot) -> None:
    """Objects that live until Python ends, such as a grid of the module, cause no message about leaks."""
    pytest.importorskip("pyvista", reason="PyVista is not installed")
    script = tmp_path / "script.py"
    script.write_text(
        "import sys, pickle, softkin\n"
        f"robot = pickle.loads(open({str(tmp_path / 'robot')!r}, 'rb').read())\n"
        "shape = robot.solve()\ngrid = shape.to_pyvista()\nsys.kept = [robot, shape, shape.positions]\n"
        "class Loop:\n    pass\nloop = Loop()\nloop.self, loop.shape = loop, shape\n"
    )
    (tmp_path / "robot").write_bytes(pickle.dumps(robot))
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_groups_of_gmsh_without_names() -> None:
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    numbers = np.zeros(len(tetrahedra), dtype=int)
    numbers[10:20], numbers[20:30] = 7, 8
    mesh = meshio.Mesh(
        vertices,
        [("tetra", tetrahedra), ("line", np.array([[0, 1]])), ("triangle", tetrahedra[:4, :3])],
        cell_data={"gmsh:physical": [numbers, np.array([7]), np.array([7, 7, 0, 0])]},
        cell_sets={"all_of_it": [np.arange(len(tetrahedra)), None, np.array([3])], "gmsh:bounding_entities": [[]] * 3},
        field_data={"stiff": np.array([8, 3])},
        point_sets={"pins": np.array([0, 1, 3])},
    )
    faces, pins = {"all_of_it_2d": "all_of_it_2d", "physical_2_7": "physical_2_7"}, {"fixed": [{"region": "pins"}]}
    robot = softkin.Robot.from_meshio(mesh, **{**DESCRIPTION, **pins, "markers": faces})
    assert set(robot.region_names) == {"all_of_it", "physical_3_7", "stiff"} and robot.supports == ["pins"]
    volume = VolumeMesh.from_meshio(mesh)
    assert set(volume.regions) == set(robot.region_names) | set(faces)
    np.testing.assert_array_equal(volume.volume_regions["stiff"], np.arange(20, 30))
    assert volume.face_regions["physical_2_7"].shape == (2, 3)


def test_what_is_no_robot() -> None:
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    vertices, tetrahedra = block((1, 1, 1), (10, 10, 10))
    quadratic = np.hstack([tetrahedra, tetrahedra, tetrahedra[:, :2]])
    for readers, cells, message in (
        ((softkin.Robot, VolumeMesh), [("hexahedron", np.arange(8)[None])], "hexahedron: only tetrahedra, wedges"),
        ((softkin.Robot, VolumeMesh), [("triangle", tetrahedra[:, :3])], "no tetrahedra and no wedges, but triangle"),
        ((softkin.Robot, VolumeMesh), [("tetra", tetrahedra), ("tetra10", quadratic)], "of order 1 and of order 2"),
        ((VolumeMesh,), [("tetra10", quadratic)], "has tetrahedra of order 2: a VolumeMesh has those of order 1"),
    ):
        for reader in readers:
            with pytest.raises(softkin.InvalidInput, match=message):
                reader.from_meshio(meshio.Mesh(vertices, cells), **(DESCRIPTION if reader is softkin.Robot else {}))


def test_pyvista_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch, robot: softkin.Robot) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyvista", None)
    with pytest.raises(ImportError, match="pyvista"):
        robot.solve().to_pyvista()
