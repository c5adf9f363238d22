"""Other programs, watched while they run."""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

ProgressFunction = Callable[[str, float], object]
"""called with what is being done and for how long it has been [s]"""

BETWEEN_LOOKS_S = 0.1


def run(
    command: Sequence[str],
    folder: Path,
    what: str,
    progress: ProgressFunction | None,
    environment: Mapping[str, str] | None = None,
) -> subprocess.CompletedProcess[str]:
    """Runs a program to its end. Ctrl-C, and what `progress` raises, ends it.

    what      is done, for progress
    progress  called about ten times a second; None: nobody
    """
    begin = time.monotonic()
    with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
        child = subprocess.Popen(command, cwd=folder, env=environment, stdout=output, stderr=errors, text=True)
        try:
            while True:
                try:
                    child.wait(BETWEEN_LOOKS_S)
                    break
                except subprocess.TimeoutExpired:
                    if progress is not None:
                        progress(what, time.monotonic() - begin)
        except BaseException:
            child.kill()
            child.wait()
            raise
        output.seek(0)
        errors.seek(0)
        return subprocess.CompletedProcess(list(command), child.returncode, output.read(), errors.read())
