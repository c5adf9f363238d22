"""What the documents of the package show runs."""

from __future__ import annotations

import importlib.util
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def blocks(document: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", (ROOT / "docs" / document).read_text(), re.M | re.S)


def test_the_tour_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tour,) = [block for block in blocks("python.md", "python") if "softkin.load(" in block]
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    exec(compile(tour, "docs/python.md", "exec"), {})
    assert (tmp_path / "bent.vtu").exists() and (tmp_path / "bent.png").exists()


@pytest.mark.skipif(importlib.util.find_spec("pytetwild") is None, reason="pytetwild is not installed")
def test_a_mesh_from_the_shell(tmp_path: Path) -> None:
    from softkin.mesh import Surface, write_stl

    for name, low, high in (("finger", (0, 0, 0), (40, 12, 12)), ("cavity", (4, 4, 4), (36, 8, 8))):
        corners = [[(low, high)[bit >> axis & 1][axis] for axis in range(3)] for bit in range(8)]
        faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
        triangles = [three for a, b, c, d in faces for three in ((a, b, c), (a, c, d))]
        write_stl(tmp_path / f"{name}.stl", Surface(corners, triangles, name))
    shell = next(block for block in blocks("python_mesh.md", "sh") if "finger.stl" in block)
    scripts = str(Path(sys.executable).parent)
    environment = {**os.environ, "PATH": scripts + os.pathsep + os.environ["PATH"]}
    for line in shell.replace("\\\n", " ").splitlines():
        run = subprocess.run(shlex.split(line), cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert run.returncode == 0, line + run.stdout + run.stderr
    assert (tmp_path / "finger.yaml").exists()
