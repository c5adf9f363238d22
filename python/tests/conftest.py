from __future__ import annotations

import os
import shutil
import sys
import time
from pathlib import Path

import pytest
from beams import beam

import softkin

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def examples() -> Path:
    return ROOT / "examples"


@pytest.fixture(scope="session")
def command() -> str:
    """The program of the same build: of the environment, or named by SOFTKIN_COMMAND."""
    found = os.environ.get("SOFTKIN_COMMAND") or shutil.which("softkin", path=str(Path(sys.executable).parent))
    assert found, "no softkin beside this Python, and SOFTKIN_COMMAND is not set"
    return found


@pytest.fixture
def patience() -> float:
    """Limits on time hold on an idle machine of 2023: how many times as long they are here, beside what else is done now."""
    begin, root = time.perf_counter(), 1.0
    for _ in range(500_000):
        root = 0.5 * (root + 2 / root)
    return max(1, (time.perf_counter() - begin) / 0.045)


@pytest.fixture(scope="session")
def robot() -> softkin.Robot:
    """A beam of about 1000 tetrahedra with three chambers."""
    return beam()
