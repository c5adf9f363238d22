"""The examples run: their notebooks, which hold the same code as the scripts, and one as a script."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from mesh_shapes import check_usable

from softkin.mesh import read_msh

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples" / "python").glob("*.py"))
WITH_CELLS = [path for path in EXAMPLES if "# %%\n" in path.read_text()]
NEEDS = {"plots": ["matplotlib"], "finger_from_stl": ["pytetwild"]}
SHOWN = {  # kinds of what a notebook shows, beside text
    "calibration": {"text/html"},
    "finger_from_stl": {"image/png"},
    "first_bend": {"image/png"},
    "inverse_and_path": {"text/html"},
    "plots": {"image/png"},
}


CHECKS = {  # of the notebook's own variables, after its last cell
    "calibration": """
assert abs(moduli["a_MPa"] - 45) < 0.5 and abs(moduli["b_MPa"] - 12) < 0.15 and abs(moved - 0.42) < 0.005
assert fit["quality"]["r_squared"] > 0.999
""",
    "control_loop": "assert max(errors) < 0.01 and len(late) == ROUNDS",
    "finger_from_stl": """
assert apart < 0.02 * LENGTH and np.linalg.norm(shape["end"] - [LENGTH, 0, 0]) > 100  # it did bend
assert max(mesh.deviation_mm.values()) <= 3 * mesh.tolerance_mm  # no two runs alike; from 1.5 on it warns
assert abs(mesh.volumes["chamber"].mesh_mm3 / 22518 - 1) < 2e-3 > abs(mesh.volumes["body"].mesh_mm3 / 51942 - 1)
""",
    "first_bend": "assert shape.actuation[0] == 1.4 and shape.converged",
    "map_closed_loop": "assert np.median(errors) < 0.03 < 0.3 < np.median(blind) and np.median(times) < 2e-4 * PATIENCE",
    "inverse_and_path": "assert answer.reached and not far.reached and waypoint.number == 12 and waypoint.reached",
}


def skip_without(*modules: str) -> None:
    for module in modules:
        if importlib.util.find_spec(module) is None:
            pytest.skip(f"{module} is not installed")


@pytest.fixture(scope="module")
def maker() -> ModuleType:
    spec = importlib.util.spec_from_file_location("notebooks", ROOT / "scripts" / "notebooks.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: str(path.stem))
def test_an_example_is_short_and_its_notebook_made_of_it(example: Path, maker: ModuleType) -> None:
    assert len(example.read_text().splitlines()) < 65
    notebook = example.with_suffix(".ipynb")
    made = maker.notebook(example)
    assert (made is None) == (example not in WITH_CELLS) == (not notebook.exists())
    if made is not None:
        assert notebook.read_text() == made, "python scripts/notebooks.py makes it anew"


@pytest.mark.deep
@pytest.mark.parametrize("example", WITH_CELLS, ids=lambda path: str(path.stem))
def test_notebook(example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, patience: float) -> None:
    skip_without("nbclient", "ipykernel", *NEEDS.get(example.stem, ()))
    import nbclient
    import nbformat

    monkeypatch.setenv("PYTHONPATH", str(example.parent), prepend=os.pathsep)
    monkeypatch.delenv("MPLBACKEND", raising=False)
    notebook: Any = nbformat.read(example.with_suffix(".ipynb"), as_version=4)
    nbformat.validate(notebook)
    if example.stem in CHECKS:
        notebook.cells.append(nbformat.v4.new_code_cell(f"PATIENCE = {patience}\n{CHECKS[example.stem]}"))
    client = nbclient.NotebookClient(
        notebook, timeout=int(300 * patience), kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert any(output.output_type == "stream" for output in outputs)
    shown = {kind for output in outputs for kind in output.get("data", ())}
    assert SHOWN.get(example.stem, set()) <= shown
    if example.stem == "finger_from_stl":
        check_usable(read_msh(tmp_path / "out/finger.msh"), tmp_path)


@pytest.mark.deep
def test_script_with_processes(tmp_path: Path, patience: float) -> None:
    script = ROOT / "examples" / "python" / "stiffness_study.py"
    run = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True, timeout=int(300 * patience))
    assert run.returncode == 0, run.stderr
    lines = run.stdout.splitlines()
    assert len(lines) == 8 and lines[0].startswith(" 0.20 MPa: ") and lines[7].startswith(" 2.00 MPa: ")
