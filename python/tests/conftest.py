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


class Skips:
    """Lists skipped tests in the file SOFTKIN_SKIPPED. With SOFTKIN_NO_SKIP a run in which there are any fails."""

    def __init__(self) -> None:
        self.found: dict[str, str] = {}

    def _note(self, report: pytest.TestReport | pytest.CollectReport) -> None:
        if report.skipped and not hasattr(report, "wasxfail"):
            reason = report.longrepr[2] if isinstance(report.longrepr, (tuple, list)) else str(report.longrepr)
            self.found[report.nodeid] = reason.removeprefix("Skipped: ")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._note(report)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        self._note(report)

    @pytest.hookimpl(tryfirst=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if file := os.environ.get("SOFTKIN_SKIPPED"):
            with open(file, "a") as lines:
                lines.writelines(f"{test}: {reason}\n" for test, reason in self.found.items())
        if self.found and os.environ.get("SOFTKIN_NO_SKIP") and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if self.found and os.environ.get("SOFTKIN_NO_SKIP"):
            terminalreporter.section("skipped, where SOFTKIN_NO_SKIP forbids it", red=True)
            for test, reason in self.found.items():
                terminalreporter.line(f"{test}: {reason}", red=True)


def pytest_configure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):  # one for all processes of pytest-xdist
        config.pluginmanager.register(Skips())


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
