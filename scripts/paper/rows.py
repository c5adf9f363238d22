"""The results of a part of the paper's evaluation: rows, pictures, and commands."""

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
    """A command of a part failed."""


@dataclass
class Row:
    """A printed number or claim, and the corresponding result of softkin.

    conditions  mesh, weights and solver
    figure      the number of `found`, with the relative `tolerance` of its changes; None for times and texts
    verdict     agrees; differs; cannot be computed, as a measurement on their robot
    why         the reason, unless the verdict is "agrees"
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
            raise ValueError(f"{self.item}: a row that does not agree needs a reason")
        if not (self.item and self.printed and self.found and self.conditions):
            raise ValueError(f"{self.item}: a row needs an item, a printed and a found value, and conditions")


@dataclass
class Result:
    """The rows, pictures and commands of a part."""

    rows: list[Row] = field(default_factory=list)
    pictures: list[str] = field(default_factory=list)  # files of the part's folder
    commands: list[str] = field(default_factory=list)
    seconds: float = 0.0

    def text(self) -> str:
        return json.dumps(asdict(self), indent=1) + "\n"

    @staticmethod
    def read(file: Path) -> Result:
        data = json.loads(file.read_text())
        data["rows"] = [Row(**row) for row in data["rows"]]
        return Result(**data)


class Bench:
    """Runs the program for a part, in the part's folder, and records the commands."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.program, self.folder = program, folder
        self.result = Result()
        folder.mkdir(parents=True, exist_ok=True)

    def run(self, *arguments: object, codes: tuple[int, ...] = (0,)) -> tuple[str, float]:
        """Runs the program; returns its standard output and the seconds."""
        words = [str(word) for word in arguments]
        self.result.commands.append("build/softkin " + " ".join(re.sub(rf"^{re.escape(str(ROOT))}/", "", word) for word in words))
        begin = time.monotonic()
        done = subprocess.run([str(self.program), *words], capture_output=True, text=True, cwd=ROOT)
        seconds = time.monotonic() - begin
        if done.returncode not in codes:
            raise Failed(f"{self.result.commands[-1]}: exit code {done.returncode}: {done.stderr.strip()[-400:]}")
        return done.stdout, seconds

    def report(self, *arguments: object, codes: tuple[int, ...] = (0,)) -> dict[str, Any]:
        """Runs the program with --json; returns its report."""
        return dict(json.loads(self.run(*arguments, "--json", codes=codes)[0]))

    def bench(self, name: str, *arguments: object) -> str:
        """Runs a program of build/bench; returns its standard output."""
        words = [str(word) for word in arguments]
        self.result.commands.append(" ".join([f"build/bench/{name}", *words]))
        program = self.program.parent / "bench" / name
        if not program.exists():
            raise Failed(f"{program} is not built; `make paper` builds it")
        return subprocess.run([str(program), *words], capture_output=True, text=True, check=True).stdout

    def table(self, name: str, columns: Sequence[str], rows: Iterable[Sequence[float]]) -> Path:
        """Writes a .csv in the part's folder; returns its path."""
        file = self.folder / name
        file.write_text("\n".join([",".join(columns), *(",".join(f"{value:.10g}" for value in row) for row in rows)]) + "\n")
        return file

    def picture(self, name: str) -> Path:
        """Registers a picture in the part's folder that the page shows; returns its path."""
        self.result.pictures.append(name)
        return self.folder / name

    def row(self, item: str, printed: str, found: str, verdict: str, why: str = "", **more: Any) -> None:
        self.result.rows.append(Row(item, printed, found, verdict, why, **more))

    def claim(self, item: str, printed: str, found: str, agrees: bool, why: str, **more: Any) -> None:
        """Adds a row with the verdict "agrees" or, for the reason why, "differs"."""
        self.row(item, printed, found, "agrees" if agrees else "differs", "" if agrees else why, **more)


def columns_of(file: Path) -> dict[str, list[float]]:
    """Returns the columns of a table that contain numbers."""
    rows = list(csv.DictReader(line for line in file.read_text().splitlines() if not line.startswith("#")))
    return {name: [float(row[name]) for row in rows] for name in rows[0] if rows[0][name].replace(".", "").lstrip("-")[:1].isdigit()}


def example(name: str, file: str = "") -> Path:
    """Returns the scene of an example, or another file of its folder."""
    return ROOT / "examples" / name / (file or f"{name}.yaml")


SHAPES = ("--formulation", "target-shape")
AS_ABOVE = "as in the row above"
PRINTED_WEIGHTS = "target shapes, weights 1 and 5, Newton's method"
PHYSICAL = "physical, Newton's method"


def elements_of(report: dict[str, Any]) -> str:
    """Returns the number and the order of the elements of a report as text."""
    mesh = report["mesh"]
    return f"{mesh['tetrahedra']:,} tetrahedra of order {mesh['order']}"
