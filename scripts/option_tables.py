#!/usr/bin/env python3
"""Writes the tables of tuned constants into docs/path_tracking.md: scripts/option_tables.py [SOFTKIN]"""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- options -->\n\n", "<!-- end of options -->\n"


def main() -> None:
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/softkin")
    tables = subprocess.run([program, "options"], check=True, capture_output=True, text=True).stdout
    page = ROOT / "docs/path_tracking.md"
    before, rest = page.read_text().split(BEGIN)
    after = rest.split(END)[1]
    page.write_text(before + BEGIN + tables + END + after)


if __name__ == "__main__":
    main()
