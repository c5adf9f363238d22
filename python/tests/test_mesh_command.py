"""python -m softkin mesh generate."""

import json

import pytest
from mesh_shapes import box, needs_tetwild, run_softkin

from softkin.mesh import VolumeMesh, from_surfaces, scene_text, write_stl
from softkin.mesh.command import main

BODY = box((0, 0, 0), (40, 10, 10))
CAVITY = box((5, 3, 3), (35, 7, 8.5))


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_stl("finger.stl", BODY)
    write_stl("cavity.stl", CAVITY)
    write_stl("metres.stl", BODY.scaled(0.001))
    return tmp_path


def generate(*arguments):
    return main(["generate", "--body", "finger.stl", "--edge-length", "5", "-o", "finger.msh", *arguments])


def tip_height(folder, fraction):
    done = run_softkin("fk", "finger.yaml", "--set", f"air={fraction}", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    (step,) = json.loads(done.stdout)["steps"]
    assert step["status"] == "converged"
    return step["markers"]["tip"][2]


@pytest.mark.deep
@needs_tetwild
@pytest.mark.parametrize("chambers_as", ["region", "void"])
def test_from_stl_files_to_a_scene_that_moves(files, capsys, chambers_as):
    assert (
        generate(
            "--chamber",
            "air=cavity.stl",
            "--region",
            "base=plane x=0",
            "--scene",
            "finger.yaml",
            "--chambers-as",
            chambers_as,
        )
        == 0
    )
    said = capsys.readouterr().out
    assert (
        "region body:" in said
        and "least dihedral angle" in said
        and said.endswith("written: finger.msh and finger.yaml\n")
    )
    scene = (files / "finger.yaml").read_text()
    assert "edit" in scene and "region: base" in scene
    at_rest, inflated = (tip_height(files, fraction) for fraction in (1, 1.1))
    assert inflated - at_rest == pytest.approx(-0.075, abs=0.02)  # mm: the wall above the cavity is the thinner one


@pytest.mark.deep
@needs_tetwild
def test_scenes_without_chambers_hold_the_low_end_and_keep_names(files):
    mesh = from_surfaces(BODY, parts={"on": box((10, 3, 3), (20, 7, 7))}, edge_length=5)
    mesh.write("bar.msh")
    scene = scene_text(mesh, "bar.msh", [])
    assert '{region: "on", youngs_modulus: 100' in scene and "halfspace" in scene
    (files / "bar.yaml").write_text(scene)
    done = run_softkin("fk", "bar.yaml", "--json", cwd=files)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["steps"][0]["markers"]["tip"][0] == pytest.approx(40, abs=0.1)


def test_metres_warn_on_one_line(files, capsys):
    assert main(["generate", "--body", "metres.stl", "--edge-length", "5", "-o", "a.msh"]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].startswith("warning: metres.stl measures 0.04 x 0.01 x 0.01 mm: are these metres?")
    assert lines[1].startswith("error: edge_length=5 mm is longer than the body") and len(lines) == 2


@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["--chamber", "air"], "error: --chamber air: give NAME=FILE"),
        (["--chamber", "air=a.stl", "--chamber", "air=b.stl"], "error: --chamber air: given twice"),
        (["--chamber", "air=no.stl"], "error: no.stl: No such file or directory"),
        (["--region", "base"], "error: --region base: give NAME=FACES"),
        (["--unit", "parsec"], "invalid choice: 'parsec'"),
        (["-o", "a.vtk"], "error: -o a.vtk: meshes are written as .msh"),
    ],
)
def test_bad_usage_is_one_line_and_2(files, capsys, arguments, reported):
    assert generate(*arguments) == 2
    assert reported in capsys.readouterr().err


def test_files_of_others_stay(files, capsys):
    (files / "finger.msh").write_text("mine")
    assert generate("--region", "base=plane x=0") == 2
    assert "-o finger.msh: is there already, and not by softkin" in capsys.readouterr().err
    (files / "finger.msh").unlink()
    (files / "finger.yaml").write_text("softkin: 1\n")
    assert generate("--region", "base=plane x=0", "--scene", "finger.yaml") == 2
    assert "--scene finger.yaml: is there already" in capsys.readouterr().err
    assert (files / "finger.yaml").read_text() == "softkin: 1\n"


def test_help_is_at_most_100_wide(capsys):
    assert main(["generate", "--help"]) == 0
    said = capsys.readouterr().out
    assert "Exit code" in said and max(map(len, said.splitlines())) <= 100


def test_scene_text_names_unknown_regions():
    import numpy as np

    mesh = VolumeMesh(np.eye(4, 3), np.array([[0, 1, 2, 3]]), {"body": np.array([0])})
    with pytest.raises(ValueError, match="no region 'air'; there are: body"):
        scene_text(mesh, "a.msh", ["air"])
