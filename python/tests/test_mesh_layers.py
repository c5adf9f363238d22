"""Layers of prisms: sheets, skins upon bodies, and what becomes of them in files and robots."""

from pathlib import Path

import numpy as np
import pytest
from mesh_shapes import run_softkin

import softkin
from softkin.mesh import InvalidInput, VolumeMesh, read_msh, stacked


def rectangle(columns: int, rows: int, length: float, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices in the plane z = 0 and triangles, counterclockwise seen from above."""
    x, y = np.meshgrid(np.linspace(0, length, columns + 1), np.linspace(0, width, rows + 1), indexing="ij")
    corner = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    triangles = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    return np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]), triangles


def cube(size: float) -> VolumeMesh:
    """Six tetrahedra, and all of its boundary as region 'skin'."""
    corners = size * np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
    cells = np.array([[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]])
    mesh = VolumeMesh(corners, cells, {"body": np.arange(6)})
    faces = mesh.boundary().triangles
    top = faces[(corners[faces][:, :, 2] == size).all(axis=1)]
    return VolumeMesh(corners, cells, mesh.volume_regions, {"skin": faces, "above": top})


def test_a_sheet_has_layers_of_their_thickness() -> None:
    points, triangles = rectangle(6, 3, 30, 10)
    sheet = stacked((points, triangles), {"frame": 0.5, "membrane": 1.25})
    assert sheet.prisms.shape == (2 * len(triangles), 6) and len(sheet.tetrahedra) == 0
    volumes = sheet.element_volumes
    assert volumes[sheet.volume_regions["frame"]].sum() == pytest.approx(30 * 10 * 0.5, rel=1e-12)
    assert volumes[sheet.volume_regions["membrane"]].sum() == pytest.approx(30 * 10 * 1.25, rel=1e-12)
    assert np.unique(sheet.vertices[:, 2]).tolist() == [0, 0.5, 1.75]
    assert sheet.boundary().volume == pytest.approx(30 * 10 * 1.75) and sheet.boundary("frame").volume == pytest.approx(150)
    assert "region membrane: 36 prisms, 375 mm^3" in sheet.summary()
    with pytest.raises(InvalidInput, match="^the mesh has prisms alone"):
        _ = sheet.quality


def test_a_bent_sheet_keeps_its_thickness() -> None:
    flat, triangles = rectangle(40, 4, np.pi / 2, 10)
    radius, thickness = 20.0, 3.0
    points = np.column_stack([radius * np.sin(flat[:, 0]), flat[:, 1], radius * np.cos(flat[:, 0])])
    sheet = stacked((points, triangles), {"skin": thickness})
    tops = sheet.vertices[sheet.prisms[:, 3:]]
    bottoms = sheet.vertices[sheet.prisms[:, :3]]
    normals = np.cross(bottoms[:, 1] - bottoms[:, 0], bottoms[:, 2] - bottoms[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    heights = np.einsum("ijk,ik->ij", tops - bottoms[:, :1], normals)
    np.testing.assert_allclose(heights, thickness, rtol=1e-12)  # it bends along lines alone
    ring = np.pi / 4 * ((radius + thickness) ** 2 - radius**2) * 10
    assert sheet.element_volumes.sum() == pytest.approx(ring, rel=3e-3)  # its ends stand square to the last faces


def test_a_skin_fits_a_box_also_at_its_corners() -> None:
    mesh = cube(10).with_layer("skin", {"soft": 0.5, "hard": 0.25})
    np.testing.assert_allclose([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)], [[-0.75] * 3, [10.75] * 3], rtol=1e-12)
    volumes = mesh.element_volumes
    assert volumes[mesh.volume_regions["soft"]].sum() == pytest.approx(11**3 - 10**3, rel=1e-12)
    assert volumes[mesh.volume_regions["hard"]].sum() == pytest.approx(11.5**3 - 11**3, rel=1e-12)
    assert mesh.boundary().volume == pytest.approx(11.5**3) and len(mesh.vertices) == 24
    assert len(mesh.face_regions["hard_top"]) == 12


def test_layers_go_through_files(tmp_path: Path) -> None:
    mesh = cube(10).with_layer("above", {"membrane": 1})
    mesh.write(tmp_path / "a.msh")
    again = read_msh(tmp_path / "a.msh")
    np.testing.assert_array_equal(again.prisms, mesh.prisms)
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    for name, region in mesh.volume_regions.items():
        np.testing.assert_array_equal(again.volume_regions[name], region)
    said = run_softkin("mesh", "info", tmp_path / "a.msh")
    assert said.returncode == 0 and "6 tetrahedra, 2 prisms" in said.stdout, said.stdout + said.stderr


@pytest.mark.deep
@pytest.mark.parametrize("name", ["meshio", "pyvista"])
def test_layers_go_through_other_packages(name: str) -> None:
    pytest.importorskip(name)
    mesh = cube(10).with_layer("above", {"membrane": 1})
    other = getattr(VolumeMesh, f"from_{name}")(getattr(mesh, f"to_{name}")())
    np.testing.assert_array_equal(other.prisms, mesh.prisms)
    np.testing.assert_array_equal(other.volume_regions["membrane"], mesh.volume_regions["membrane"])


def test_a_membrane_of_a_sheet_spreads() -> None:
    points, triangles = rectangle(4, 4, 20, 20)
    sheet = stacked((points, triangles), {"membrane": 1})
    robot = softkin.Robot(
        sheet.vertices,
        prisms=sheet.prisms,
        regions=sheet.regions,
        materials=[{"region": "membrane", "youngs_modulus": 1, "poisson_ratio": 0.4}],
        fixed=[{"halfspace": {"point": [0.01, 0, 0], "normal": [-1, 0, 0]}}],
        actuators=[{"name": "skin", "kind": "dea", "region": "membrane", "range": [0.9, 1.5]}],
        markers=[{"name": "end", "point": [20, 10, 0]}],
        formulation="physical",
    )
    shape = robot.solve(skin=1.2)
    assert shape.converged and 20.5 < shape.markers["end"][0] < 24


def test_what_cannot_be_stacked() -> None:
    points, triangles = rectangle(2, 2, 10, 10)
    turned = triangles.copy()
    turned[0] = turned[0][::-1]
    bent = points.copy()
    bent[:, 2] = np.abs(points[:, 0] - 5)  # a valley of a right angle
    for surface, layers, message in (
        ((points, triangles), {}, "^layers: give one at least"),
        ((points, triangles), {"a": 0}, "^layers: 'a': thickness 0: give a length in mm, > 0"),
        ((points, turned), {"a": 1}, "turned against each other"),
        ((bent, triangles), {"a": 1, "b": 20}, "^layer 'b' folds at "),
    ):
        with pytest.raises(InvalidInput, match=message):
            stacked(surface, layers)
    with pytest.raises(InvalidInput, match="^no region of faces 'side'; there are: skin, above"):
        cube(1).with_layer("side", {"a": 1})
    with pytest.raises(InvalidInput, match="^'body' is a region already"):
        cube(1).with_layer("above", {"body": 1})
    inside = VolumeMesh(cube(1).vertices, cube(1).tetrahedra, {}, {"cut": np.array([[0, 3, 7]])})
    with pytest.raises(InvalidInput, match="has faces that are not on the boundary"):
        inside.with_layer("cut", {"a": 1})
