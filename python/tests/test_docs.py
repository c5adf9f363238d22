"""What the documents of the package show runs."""

from __future__ import annotations

import importlib.util
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beams import block

import softkin
from softkin.mesh.volume_mesh import boundary_faces

ROOT = Path(__file__).resolve().parents[2]


def blocks(document: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", (ROOT / "docs" / document).read_text(), re.M | re.S)


def test_the_tour_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tour,) = [block for block in blocks("python.md", "python") if "softkin.load(" in block and "bent.vtu" in block]
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    exec(compile(tour, "docs/python.md", "exec"), {})
    assert (tmp_path / "bent.vtu").exists() and (tmp_path / "bent.png").exists()


@pytest.mark.deep
def test_the_map_that_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (shown,) = [block for block in blocks("python.md", "python") if "robot.map(" in block]
    monkeypatch.chdir(tmp_path)
    robot = softkin.load(ROOT / "examples/three_chamber_actuator/three_chamber_actuator.yaml")
    names: dict[str, Any] = {"robot": robot, "softkin": softkin, "np": np}
    exec(compile(shown, "docs/python.md", "exec"), names)
    assert names["answer"].jacobian("tip").shape == (100_000, 3, 3)
    assert repr(softkin.load_map("actuator.skmap")) == repr(names["model"])


def hose(file: Path) -> None:
    """A tube of 60 x 20 x 20 mm with a closed hollow, as Abaqus writes it."""
    vertices, tetrahedra = block((6, 4, 4), (60, 20, 20))
    middle = vertices[tetrahedra].mean(axis=1)
    hollow = (np.abs(middle - (30, 10, 10)) < (20, 5, 5)).all(axis=1)
    inner = set(map(frozenset, boundary_faces(tetrahedra[hollow])))
    tetrahedra = tetrahedra[~hollow]
    walls, cap = [], []
    for number, corners in enumerate(tetrahedra, start=1):
        for side, face in enumerate(((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)), start=1):
            if frozenset(corners[list(face)]) in inner:
                walls.append(f"{number}, S{side}")
            elif (vertices[corners[list(face)], 0] == 60).all():
                cap.append(f"{number}, S{side}")
    clamp = np.flatnonzero(vertices[:, 0] == 0) + 1
    lines = ["*NODE", *(f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(vertices, start=1))]
    lines += ["*ELEMENT, TYPE=C3D4, ELSET=ALL"]
    lines += [f"{i}, {', '.join(map(str, corners + 1))}" for i, corners in enumerate(tetrahedra, start=1)]
    lines += ["*NSET, NSET=CLAMP", *map(str, clamp)]
    lines += ["*SURFACE, NAME=CAVITY", *walls, "*SURFACE, NAME=CAP", *cap]
    file.write_text("\n".join(lines) + "\n")


@pytest.mark.deep
@pytest.mark.parametrize("other, words", [("SOFA", "# MeshGmshLoader"), ("Abaqus", "hose.inp")], ids=["SOFA", "Abaqus"])
def test_coming_from(other: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (shown,) = [block for block in blocks("coming_from.md", "python") if words in block]
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    hose(tmp_path / "hose.inp")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile(shown, "docs/coming_from.md", "exec"), names)
    assert names["shape"].converged
    if other == "SOFA":
        assert names["answer"].reached and names["growth"] > 100
    else:
        assert names["shape"]["cap"][0] > 60.1  # [mm]


def test_a_neo_hooke_of_abaqus() -> None:
    """The conversion of docs/coming_from.md, against U = C10 (bar I1 - 3) + (J - 1)^2 / D1 of a bar that is stretched."""
    c10, d1, stretch = 0.2, 0.1, 1.5  # [MPa], [1/MPa]
    vertices, tetrahedra = block((1, 1, 1), (10, 10, 10))
    held = [
        {"vertices": np.flatnonzero(vertices[:, axis] == 0).tolist(), "axes": name} for axis, name in enumerate("xyz")
    ]
    end = {"vertices": np.flatnonzero(vertices[:, 0] == 10).tolist(), "axes": "x", "displacement": (5, 0, 0)}
    material = {"law": "mooney-rivlin", "c10": c10, "bulk_modulus": 2 / d1}
    robot = softkin.Robot(vertices, tetrahedra, materials=[material], fixed=[*held, end])
    shape = robot.solve(solver=softkin.Solver(tolerance_mm=1e-9)).require()

    def energy(along: float, across: float) -> float:  # per volume at rest [MPa]
        j = along * across**2
        return float(c10 * ((along**2 + 2 * across**2) / j ** (2 / 3) - 3) + (j - 1) ** 2 / d1)

    across = float(shape.positions[:, 1].max() / 10)
    h = 1e-6
    assert (energy(stretch, across + h) - energy(stretch, across - h)) / (2 * h) == pytest.approx(0, abs=1e-8)
    stress = (energy(stretch + h, across) - energy(stretch - h, across)) / (2 * h)  # over the area at rest [MPa]
    assert shape.reactions["fixed_4"].force_N[0] == pytest.approx(100 * stress, rel=1e-7)


@pytest.mark.deep
@pytest.mark.skipif(importlib.util.find_spec("pytetwild") is None, reason="pytetwild is not installed")
def test_a_mesh_from_the_shell(tmp_path: Path) -> None:
    from softkin.mesh import Surface, write_stl

    for name, low, high in (("finger", (0, 0, 0), (40, 12, 12)), ("cavity", (4, 4, 4), (36, 8, 8))):
        corners = [[(low, high)[bit >> axis & 1][axis] for axis in range(3)] for bit in range(8)]
        faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        triangles = [three for a, b, c, d in faces for three in ((a, b, c), (a, c, d))]
        write_stl(tmp_path / f"{name}.stl", Surface(corners, triangles, name))
    (shell,) = [block for block in blocks("python_mesh.md", "sh") if "--body finger.stl" in block]
    scripts = str(Path(sys.executable).parent)
    environment = {**os.environ, "PATH": scripts + os.pathsep + os.environ["PATH"]}
    for line in shell.replace("\\\n", " ").splitlines():
        run = subprocess.run(shlex.split(line), cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert run.returncode == 0, line + run.stdout + run.stderr
    assert (tmp_path / "finger.yaml").exists()


def test_the_layers_that_are_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    (shown,) = [block for block in blocks("python_mesh.md", "python") if "stacked(" in block]
    monkeypatch.chdir(tmp_path)
    import softkin.mesh

    names: dict[str, Any] = {"softkin": softkin}
    exec(compile(shown, "docs/python_mesh.md", "exec"), names)
    end = [float(word) for word in re.findall(r"-?\d+\.\d+", capsys.readouterr().out)]
    assert (tmp_path / "sheet.msh").exists() and end[2] < -1  # what stretches on top bends it down
    assert softkin.mesh.read_msh("sheet.msh").prisms.shape == (2 * 200, 6)
