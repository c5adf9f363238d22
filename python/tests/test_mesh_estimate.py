"""How large a mesh will be is known before it is made, and its making can be watched and stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from mesh_shapes import box, needs_tetwild

from softkin.mesh import InvalidInput, MeshWarning, from_surfaces, write_stl
from softkin.mesh.child import run
from softkin.mesh.estimate import check_size, counted, expected_tetrahedra

FINGER = box((0, 0, 0), (120, 25, 25))


@pytest.mark.parametrize("backend", ["tetwild", "gmsh"])
def test_an_edge_far_too_short_is_refused_at_once(backend: str) -> None:
    begin = time.monotonic()
    with pytest.raises(InvalidInput, match=r"edge_length=0.001 mm for a body of 120 x 25 x 25 mm makes about .* tetrahedra, "
                       r"which take about .* GiB of memory to make, and .* are free: take a longer edge, such as .* mm"):
        check_size([FINGER], 0.001, backend, False)
    assert time.monotonic() - begin < 1
    if backend == "tetwild":
        with pytest.raises(InvalidInput, match="take a longer edge"):
            from_surfaces(FINGER, edge_length=1e-6)


def test_a_short_edge_is_warned_of() -> None:
    with pytest.warns(MeshWarning, match="takes long, and few machines solve for so many: an edge of .* mm makes about 30,000"):
        assert check_size([FINGER], 0.8, "tetwild", False) > 1e6


def test_numbers_in_words() -> None:
    numbers = (0, 12, 1234, 34_567, 1_260_000, 12_345_678, 3.2e9, 1e22)
    assert [counted(n) for n in numbers] == ["1", "12", "1,200", "35,000", "1.3 million", "12 million", "3.2 billion", "1e22"]


@pytest.mark.deep
@needs_tetwild
def test_the_number_that_is_expected_is_about_right() -> None:
    body = box((0, 0, 0), (40, 10, 10))
    reported: list[tuple[str, float]] = []
    mesh = from_surfaces(body, edge_length=1.5, progress=lambda what, seconds: reported.append((what, seconds)))
    expected = expected_tetrahedra([body], 1.5, "tetwild")  # of the box with its margin, of which the body is the larger part
    assert 0.2 < len(mesh.tetrahedra) / expected < 2
    assert reported and reported[0][0].startswith("meshing, about ") and [s for _, s in reported] == sorted(s for _, s in reported)


def test_what_progress_raises_ends_the_program(tmp_path: Path) -> None:
    class Stop(Exception):
        pass

    def stop(what: str, seconds: float) -> None:
        assert what == "sleeping"
        if seconds > 0.3:
            raise Stop

    begin = time.monotonic()
    with pytest.raises(Stop):
        run([sys.executable, "-c", "import time; time.sleep(60)"], tmp_path, "sleeping", stop)
    assert time.monotonic() - begin < 30
    done = run([sys.executable, "-c", "import sys; print(1); sys.exit('no')"], tmp_path, "failing", None)
    assert (done.returncode, done.stdout, done.stderr) == (1, "1\n", "no\n")


@pytest.mark.deep
@needs_tetwild
def test_ctrl_c_ends_the_command_and_nothing_is_written(tmp_path: Path, patience: float) -> None:
    write_stl(tmp_path / "a.stl", FINGER)
    command = [sys.executable, "-m", "softkin", "mesh", "generate", "--body", "a.stl", "--edge-length", "0.9", "-o", "a.msh"]
    child = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=dict(os.environ))
    time.sleep(3 * patience)
    child.send_signal(signal.SIGINT)
    output, errors = child.communicate(timeout=20 * patience)
    assert child.returncode == 1 and output == "" and errors.endswith("interrupted: nothing was written\n"), errors
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.stl"]
