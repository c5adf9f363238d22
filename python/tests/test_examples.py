"""The examples run: their notebooks, which hold the same code as the scripts, and some as scripts."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

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
    assert len(example.read_text().splitlines()) < 60
    notebook = example.with_suffix(".ipynb")
    made = maker.notebook(example)
    assert (made is None) == (example not in WITH_CELLS) == (not notebook.exists())
    if made is not None:
        assert notebook.read_text() == made, "python scripts/notebooks.py makes it anew"


@pytest.mark.parametrize("example", WITH_CELLS, ids=lambda path: str(path.stem))
def test_notebook(example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    skip_without("nbclient", "ipykernel", *NEEDS.get(example.stem, ()))
    import nbclient
    import nbformat

    monkeypatch.setenv("PYTHONPATH", str(example.parent), prepend=os.pathsep)
    monkeypatch.delenv("MPLBACKEND", raising=False)
    notebook: Any = nbformat.read(example.with_suffix(".ipynb"), as_version=4)
    nbformat.validate(notebook)
    client = nbclient.NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": tmp_path}}
    )
    client.execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert any(output.output_type == "stream" for output in outputs)
    shown = {kind for output in outputs for kind in output.get("data", ())}
    assert SHOWN.get(example.stem, set()) <= shown


@pytest.mark.parametrize("name", ["calibration", "stiffness_study"])
def test_script(name: str, tmp_path: Path) -> None:
    script = ROOT / "examples" / "python" / f"{name}.py"
    run = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    expected = {"calibration": "moduli of the two materials: 45.07 and 11.91 MPa", "stiffness_study": "0.20 MPa: "}
    assert expected[name] in run.stdout
