"""The program gmsh as the mesher."""

import pytest
from mesh_shapes import EXAMPLES, box, check_usable, fine_box, joined, sphere, turned

from softkin.mesh import InvalidInput, MeshWarning, Surface, from_surfaces, mesh_geo
from softkin.mesh.command import main
from softkin.mesh.gmsh_program import find_gmsh

pytestmark = [pytest.mark.deep, pytest.mark.skipif(find_gmsh() is None, reason="the program gmsh is not installed")]

BODY = box((0, 0, 0), (20, 10, 10))
CAVITY = box((3, 3, 3), (12, 7, 7))


def test_flat_surfaces_are_kept_exactly(tmp_path):
    mesh = from_surfaces(
        BODY,
        {"air": CAVITY},
        {"rib": box((14, 3, 3), (17, 7, 7))},
        edge_length=3,
        regions={"base": "plane x=0"},
        backend="gmsh",
    )
    volumes = {name: mesh.element_volumes[region].sum() for name, region in mesh.volume_regions.items()}
    assert volumes == pytest.approx({"body": 1808, "air": 144, "rib": 48}, rel=1e-9)
    assert max(mesh.deviation_mm.values()) < 1e-9
    assert Surface(mesh.vertices, mesh.face_regions["base"]).area == pytest.approx(100)
    check_usable(mesh, tmp_path)


def test_a_hollow_body_with_two_shells():
    hollow = from_surfaces(joined(BODY, turned(CAVITY)), edge_length=4, backend="gmsh")
    assert hollow.boundary().volume == pytest.approx(1856)


def test_a_coarse_sphere_warns_how_far_it_is_from_its_surface():
    with pytest.warns(MeshWarning, match="surface body: the mesh is 0[.][45].* mm from it, tolerance 0.03"):
        ball = from_surfaces(sphere(10, rings=12), edge_length=4, backend="gmsh")
    assert ball.volumes["body"].mesh_mm3 == pytest.approx(sphere(10, rings=12).volume, rel=0.05)


def test_surfaces_that_cross_are_one_clear_error():
    with pytest.raises(InvalidInput, match="gmsh: .*backend='tetwild' bears bad surfaces") as raised:
        from_surfaces(BODY, {"air": fine_box((15, 3, 3), (25, 7, 7), 3)}, edge_length=4, backend="gmsh")
    assert "\n" not in str(raised.value)


def test_a_geo_brings_its_groups_and_the_command_takes_it(tmp_path, capsys):
    geo = tmp_path / "bar.geo"
    geo.write_text(
        """SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 30, 10, 10};
Box(2) = {5, 3, 3, 20, 4, 4};
v() = BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; };
Physical Volume("air") = {2};
Physical Volume("solid") = {3};
Physical Surface("end") = Surface In BoundingBox{-0.1, -1, -1, 0.1, 11, 11};
Mesh.Binary = 1;
"""
    )
    mesh = mesh_geo(geo, 4)
    assert {name: mesh.element_volumes[r].sum() for name, r in mesh.volume_regions.items()} == pytest.approx(
        {"air": 320, "solid": 2680}
    )
    arguments = [
        "generate",
        "--body",
        geo,
        "--edge-length",
        4,
        "--backend",
        "gmsh",
        "-o",
        tmp_path / "bar.msh",
        "--chamber",
        "air",
    ]
    assert main([str(a) for a in [*arguments, "--scene", tmp_path / "bar.yaml", "--fixed", "end"]]) == 0
    assert "region: air" in (tmp_path / "bar.yaml").read_text()
    assert main([str(a) for a in [*arguments, "--chamber", "water"]]) == 2
    assert "--chamber water: of a .geo give the name of a physical group: " in capsys.readouterr().err


def test_a_geo_with_a_mistake_is_one_clear_error(tmp_path):
    geo = tmp_path / "bad.geo"
    geo.write_text("Box(1) = {0, 0;\n")
    with pytest.raises(InvalidInput, match="bad.geo: gmsh: "):
        mesh_geo(geo, 4)
    with pytest.raises(InvalidInput, match="nothing.geo: no such file"):
        mesh_geo(tmp_path / "nothing.geo", 4)


def test_step_files_of_a_body_and_its_chamber(tmp_path):
    import subprocess

    for name, shape in (("body", "Box(1) = {0, 0, 0, 30, 10, 10};"), ("air", "Cylinder(1) = {5, 5, 5, 20, 0, 0, 3};")):
        (tmp_path / f"{name}.geo").write_text(f'SetFactory("OpenCASCADE");\n{shape}\n')
        arguments = [*find_gmsh(), f"{name}.geo", "-0", "-format", "step", "-o", f"{name}.step"]
        subprocess.run(arguments, cwd=tmp_path, check=True, capture_output=True)
    mesh = from_surfaces(
        tmp_path / "body.step", {"air": tmp_path / "air.step"}, edge_length=3, backend="gmsh", tolerance=0.15
    )
    assert mesh.volumes["body"].mesh_mm3 == pytest.approx(3000)
    assert mesh.volumes["air"].mesh_mm3 == pytest.approx(565.5, rel=0.07)
    with pytest.raises(InvalidInput, match="backend 'gmsh' reads CAD"):
        from_surfaces(tmp_path / "body.step", edge_length=3)


def test_the_shipped_geo_gives_the_shipped_mesh():
    mesh = mesh_geo(EXAMPLES / "pneumatic_finger" / "pneumatic_finger.geo", 4.4)
    assert mesh.boundary().volume == pytest.approx(51942, rel=1e-6)
    assert set(mesh.regions) == {"body", "chamber", "base", "tip", "cavity_wall"}
