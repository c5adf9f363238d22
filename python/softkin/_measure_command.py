"""`softkin measure` of a softkin that pip installed; others have it as a program of its own."""

from __future__ import annotations

import importlib
import signal
import sys

from .measure import INSTALL


def main() -> int:
    try:
        importlib.import_module("softkin._opencv")
    except ImportError as error:
        print(f"softkin: measure {INSTALL} ({error})", file=sys.stderr)
        return 2
    from . import _vision

    signal.signal(signal.SIGINT, signal.SIG_DFL)  # as of any program: Python's would wait for the end
    return _vision.program(["softkin measure", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
