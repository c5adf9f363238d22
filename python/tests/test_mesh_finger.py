"""The surfaces of the shipped pneumatic finger become a robot that bends as the shipped one: by Gmsh; by tetwild in
test_examples.py, where the example does it."""

import json

import numpy as np
import pytest
from mesh_shapes import EXAMPLES, check_usable, run_softkin

from softkin.mesh import from_surfaces, read_msh, write_stl
from softkin.mesh.gmsh_program import find_gmsh

FOLDER = EXAMPLES / "pneumatic_finger"
LENGTH_MM = 120
EDGES_MM = 6


def markers(scene):
    done = run_softkin("fk", scene, "--set", "air=1.4", "--json")
    assert done.returncode == 0, done.stderr
    step = json.loads(done.stdout)["steps"][0]
    return {name: np.array(point) for name, point in step["markers"].items()}


@pytest.mark.deep
@pytest.mark.skipif(find_gmsh() is None, reason="the program gmsh is not installed")
def test_the_remeshed_finger_bends_as_the_shipped_one(tmp_path):
    theirs = markers(FOLDER / "pneumatic_finger.yaml")
    shipped = read_msh(FOLDER / "pneumatic_finger.msh")
    write_stl(tmp_path / "skin.stl", shipped.boundary("body", "chamber"))
    write_stl(tmp_path / "cavity.stl", shipped.boundary("chamber"))
    mesh = from_surfaces(
        tmp_path / "skin.stl", {"chamber": tmp_path / "cavity.stl"}, edge_length=EDGES_MM,
        regions={"base": "plane x=0", "tip": f"plane x={LENGTH_MM}"}, backend="gmsh",
    )  # fmt: skip
    assert max(mesh.deviation_mm.values()) <= 1.5 * mesh.tolerance_mm
    assert mesh.volumes["chamber"].mesh_mm3 == pytest.approx(22518, rel=1e-3)
    assert mesh.volumes["body"].mesh_mm3 == pytest.approx(51942, rel=1e-3)
    check_usable(mesh, tmp_path)
    mesh.write(tmp_path / "pneumatic_finger.msh")
    (tmp_path / "finger.yaml").write_text((FOLDER / "pneumatic_finger.yaml").read_text())
    ours = markers(tmp_path / "finger.yaml")
    for name in ("tip", "end"):
        apart = np.linalg.norm(ours[name] - theirs[name])
        print(f"{name} {apart:.3f} mm apart, {100 * apart / LENGTH_MM:.2f} % of the length; {mesh!r}")
        assert apart < 0.02 * LENGTH_MM
        assert np.linalg.norm(ours[name] - [LENGTH_MM, 0, 0]) > 100  # it did bend
