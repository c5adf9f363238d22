"""Writes what a syringe and a pressure sensor would read while a chamber goes through the steps of `softkin fk`.

    python3 syringe.py OUT.csv REPORT.json [REPORT.json ...]

A run for each report, for `softkin calibrate pressure OUT.csv --chamber-volume 22518mm3 --syringe-volume 60mL`. The air
in chamber and syringe keeps its temperature: Eq. (19) of the paper, read backwards. Needs Python 3 alone.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

CHAMBER_MM3 = 22518.0  # at rest, as softkin fk says
SYRINGE_MM3 = 60000.0
ATMOSPHERE_KPA = 100.0


def rows(run: int, report: Path) -> list[str]:
    air = CHAMBER_MM3 + SYRINGE_MM3
    lines = []
    for step in json.loads(report.read_text())["steps"]:
        chamber = step["actuators"]["air"]
        gauge = chamber["pressure_kPa"]
        left = air * ATMOSPHERE_KPA / (ATMOSPHERE_KPA + gauge)
        pushed = chamber["achieved"] * CHAMBER_MM3 + SYRINGE_MM3 - left
        lines.append(f"{run},{step['time_s']:g},{gauge:.6f},{pushed:.3f}\n")
    return lines


def main() -> None:
    out, *reports = map(Path, sys.argv[1:])
    lines = ["run,t_s,p_gauge_kpa,dv_sy_mm3\n"]
    for run, report in enumerate(reports, 1):
        lines += rows(run, report)
    out.write_text("".join(lines))


if __name__ == "__main__":
    main()
