"""The examples run, as a user runs them."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = sorted((Path(__file__).resolve().parents[2] / "examples" / "python").glob("*.py"))
NEEDS = {"plots": "matplotlib", "finger_from_stl": "pytetwild"}


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: str(path.stem))
def test_example(example: Path, tmp_path: Path) -> None:
    needed = NEEDS.get(example.stem)
    if needed and importlib.util.find_spec(needed) is None:
        pytest.skip(f"{needed} is not installed")
    assert len(example.read_text().splitlines()) < 60
    run = subprocess.run([sys.executable, str(example)], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    assert run.stdout or example.stem == "beam"
