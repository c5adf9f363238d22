"""Round trips through meshio, PyVista and .msh."""

import numpy as np
import pytest
from mesh_shapes import EXAMPLES, run_softkin

from softkin.mesh import InvalidInput, VolumeMesh, read_msh


def example():
    return read_msh(EXAMPLES / "pneumatic_finger" / "pneumatic_finger.msh")


def same(one, two):
    np.testing.assert_array_equal(one.vertices, two.vertices)
    np.testing.assert_array_equal(one.tetrahedra, two.tetrahedra)
    assert set(one.volume_regions) == set(two.volume_regions) and set(one.face_regions) == set(two.face_regions)
    for name, region in one.volume_regions.items():
        np.testing.assert_array_equal(region, two.volume_regions[name])
    for name, faces in one.face_regions.items():
        first, second = (np.unique(np.sort(f, axis=1), axis=0) for f in (faces, two.face_regions[name]))
        np.testing.assert_array_equal(first, second)


def overlapping():
    """Two tetrahedra, both in one region, one in another; a face in two regions."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float)
    tetrahedra = np.array([[0, 1, 2, 3], [1, 4, 2, 3]])
    return VolumeMesh(
        vertices,
        tetrahedra,
        {"both": np.array([0, 1]), "one": np.array([1])},
        {"a": np.array([[0, 2, 1]]), "b": np.array([[0, 2, 1], [0, 1, 3]])},
    )


def test_the_shipped_finger_is_read_as_softkin_reads_it():
    mesh = example()
    assert (len(mesh.vertices), len(mesh.tetrahedra)) == (2633, 10879)
    assert len(mesh.volume_regions["body"]) == 7894 and len(mesh.face_regions["cavity_wall"]) == 1926
    assert mesh.boundary("chamber").volume == pytest.approx(22518)


def test_msh_round_trip(tmp_path):
    for mesh in (example(), overlapping()):
        mesh.write(tmp_path / "a.msh")
        again = read_msh(tmp_path / "a.msh")
        assert sorted(len(r) for r in again.volume_regions.values()) == sorted(
            len(r) for r in mesh.volume_regions.values()
        )
        assert again.element_volumes.sum() == pytest.approx(mesh.element_volumes.sum(), rel=1e-12)
        again.write(tmp_path / "b.msh")
        same(read_msh(tmp_path / "b.msh"), again)


def test_softkin_reads_what_is_written(tmp_path):
    mesh = example()
    mesh.write(tmp_path / "a.msh")
    said = run_softkin("mesh", "info", tmp_path / "a.msh")
    assert said.returncode == 0, said.stderr
    for line in ("base         2D      104 faces", "body         3D  7894 elements", "chamber      3D  2985 elements"):
        assert line in said.stdout


def test_what_softkin_writes_is_read(tmp_path):
    source = EXAMPLES / "pneumatic_finger" / "pneumatic_finger.msh"
    for option in ([], ["--ascii"]):
        assert run_softkin("mesh", "convert", source, tmp_path / "a.msh", *option).returncode == 0
        same(read_msh(tmp_path / "a.msh"), example())


@pytest.mark.parametrize("cut", [100, 20_000, 300_000])
def test_a_cut_file_is_one_clear_error(tmp_path, cut):
    content = (EXAMPLES / "pneumatic_finger" / "pneumatic_finger.msh").read_bytes()
    (tmp_path / "cut.msh").write_bytes(content[:cut])
    with pytest.raises(InvalidInput, match=r"cut.msh: (no section|\$)"):
        read_msh(tmp_path / "cut.msh")


@pytest.mark.deep
def test_meshio_round_trip(tmp_path):
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    for mesh in (example(), overlapping()):
        same(VolumeMesh.from_meshio(mesh.to_meshio()), mesh)
    meshio.write(tmp_path / "a.msh", example().to_meshio(), file_format="gmsh22", binary=False)
    same(VolumeMesh.from_meshio(meshio.read(tmp_path / "a.msh")), example())
    same(read_msh(tmp_path / "a.msh"), example())
    with pytest.raises(InvalidInput, match="hexahedron: only tetrahedra"):
        VolumeMesh.from_meshio(meshio.Mesh(np.zeros((8, 3)), [("hexahedron", np.arange(8)[None])]))


@pytest.mark.deep
def test_pyvista_round_trip(tmp_path):
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    same(VolumeMesh.from_pyvista(example().to_pyvista()), example())
    example().to_pyvista().save(tmp_path / "a.vtu")
    same(VolumeMesh.from_pyvista(pyvista.read(tmp_path / "a.vtu")), example())
    said = run_softkin("mesh", "info", tmp_path / "a.vtu")
    assert said.returncode == 0 and "body         3D  7894 elements" in said.stdout, said.stdout + said.stderr
    with pytest.raises(InvalidInput, match="must be a pyvista.UnstructuredGrid, not a PolyData"):
        VolumeMesh.from_pyvista(pyvista.Sphere())


@pytest.mark.deep
def test_surfaces_of_pyvista_and_meshio():
    from softkin.mesh.surface import as_surface

    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    cube = pyvista.Cube(x_length=2, y_length=3, z_length=4)
    assert as_surface(cube, "cube").volume == pytest.approx(24)
    flat = cube.triangulate()
    assert as_surface(
        meshio.Mesh(flat.points, [("triangle", flat.faces.reshape(-1, 4)[:, 1:])]), "cube"
    ).volume == pytest.approx(24)


def test_bad_arrays_name_themselves():
    vertices, tetrahedra = np.eye(4, 3), np.array([[0, 1, 2, 3]])
    with pytest.raises(InvalidInput, match=r"tetrahedra: index 4 is not in 0 to 3"):
        VolumeMesh(vertices, tetrahedra + 1)
    with pytest.raises(InvalidInput, match=r"region 'a': index 1 is not in 0 to 0"):
        VolumeMesh(vertices, tetrahedra, {"a": np.array([1])})
    with pytest.raises(InvalidInput, match="region 'a' is one of elements and one of faces"):
        VolumeMesh(vertices, tetrahedra, {"a": np.array([0])}, {"a": np.array([[0, 1, 2]])})
    with pytest.raises(InvalidInput, match="no volume region 'b'; there are: a"):
        VolumeMesh(vertices, tetrahedra, {"a": np.array([0])}).boundary("b")
