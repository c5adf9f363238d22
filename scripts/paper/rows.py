"""What a part of the paper's evaluation says: rows, pictures, and the commands that were run."""

from __future__ import annotations

import csv
import json
import re
import subprocess
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
VERDICTS = ("agrees", "differs", "cannot")


class Failed(Exception):
    """A command of a part did not do what the part needs."""


@dataclass
class Row:
    """One printed number or claim beside softkin's.

    conditions  mesh, weights and solver
    figure      the number behind `found`, which must not move by more than `tolerance`, relative; None: a time, or none
    verdict     agrees; differs, because of `why`; cannot, as `why` says: it is a measurement on their robot
    """

    item: str
    printed: str
    found: str
    verdict: str
    why: str = ""
    conditions: str = ""
    figure: float | None = None
    tolerance: float = 0.0

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS or (self.verdict != "agrees" and not self.why):
            raise ValueError(f"{self.item}: a row that differs says why")
        if not (self.item and self.printed and self.found and self.conditions):
            raise ValueError(f"{self.item}: a row is empty")


@dataclass
class Result:
    rows: list[Row] = field(default_factory=list)
    pictures: list[str] = field(default_factory=list)  # files of the part's folder
    commands: list[str] = field(default_factory=list)
    seconds: float = 0.0

    def text(self) -> str:
        return json.dumps(asdict(self), indent=1) + "\n"

    @staticmethod
    def read(file: Path) -> Result:
        told = json.loads(file.read_text())
        told["rows"] = [Row(**row) for row in told["rows"]]
        return Result(**told)


class Bench:
    """Runs the program for a part, in the part's folder, and keeps what it was asked."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.program, self.folder = program, folder
        self.result = Result()
        folder.mkdir(parents=True, exist_ok=True)

    def run(self, *arguments: object, codes: tuple[int, ...] = (0,)) -> tuple[str, float]:
        """Standard output, and seconds."""
        words = [str(word) for word in arguments]
        self.result.commands.append("build/softkin " + " ".join(re.sub(rf"^{re.escape(str(ROOT))}/", "", word) for word in words))
        begin = time.monotonic()
        done = subprocess.run([str(self.program), *words], capture_output=True, text=True, cwd=ROOT)
        seconds = time.monotonic() - begin
        if done.returncode not in codes:
            raise Failed(f"{self.result.commands[-1]}: exit code {done.returncode}: {done.stderr.strip()[-400:]}")
        return done.stdout, seconds

    def report(self, *arguments: object, codes: tuple[int, ...] = (0,)) -> dict[str, Any]:
        """The report of `fk`."""
        return dict(json.loads(self.run(*arguments, "--json", codes=codes)[0]))

    def bench(self, name: str, *arguments: object) -> str:
        """What a program of build/bench prints."""
        words = [str(word) for word in arguments]
        self.result.commands.append(" ".join([f"build/bench/{name}", *words]))
        program = self.program.parent / "bench" / name
        if not program.exists():
            raise Failed(f"{program}: not built; make paper builds it")
        return subprocess.run([str(program), *words], capture_output=True, text=True, check=True).stdout

    def table(self, name: str, columns: Sequence[str], rows: Iterable[Sequence[float]]) -> Path:
        """A .csv of the part's folder."""
        file = self.folder / name
        file.write_text("\n".join([",".join(columns), *(",".join(f"{value:.10g}" for value in row) for row in rows)]) + "\n")
        return file

    def picture(self, name: str) -> Path:
        """A file of the part's folder that its page shows."""
        self.result.pictures.append(name)
        return self.folder / name

    def row(self, item: str, printed: str, found: str, verdict: str, why: str = "", **more: Any) -> None:
        self.result.rows.append(Row(item, printed, found, verdict, why, **more))

    def claim(self, item: str, printed: str, found: str, holds: bool, why: str, **more: Any) -> None:
        """A row that agrees if it holds, and else differs because of why."""
        self.row(item, printed, found, "agrees" if holds else "differs", "" if holds else why, **more)


def columns_of(file: Path) -> dict[str, list[float]]:
    """The columns of numbers of a table."""
    rows = list(csv.DictReader(line for line in file.read_text().splitlines() if not line.startswith("#")))
    return {name: [float(row[name]) for row in rows] for name in rows[0] if rows[0][name].replace(".", "").lstrip("-")[:1].isdigit()}


def example(name: str, file: str = "") -> Path:
    return ROOT / "examples" / name / (file or f"{name}.yaml")


SHAPES = ("--formulation", "target-shape")
AS_ABOVE = "as in the row above"
PRINTED_WEIGHTS = "target shapes, weights 1 and 5, Newton's method"
PHYSICAL = "physical, Newton's method"


def elements_of(report: dict[str, Any]) -> str:
    mesh = report["mesh"]
    return f"{mesh['tetrahedra']:,} tetrahedra of order {mesh['order']}"
