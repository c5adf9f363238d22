"""What a part of the paper's evaluation says: rows, pictures, and the commands that were run."""

from __future__ import annotations

import json
import re
import subprocess
import time
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

    figure     the number behind `found`, which must not move by more than `tolerance`, relative; None: a time, or none
    verdict    agrees; differs, because of `why`; cannot, as `why` says: it is a measurement on their robot
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
        if not (self.item and self.printed and self.found):
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
        self.result.commands.append("build/softkin " + " ".join(re.sub(rf"^{re.escape(str(ROOT))}/", "", w) for w in words))
        begin = time.monotonic()
        done = subprocess.run([str(self.program), *words], capture_output=True, text=True, cwd=ROOT)
        seconds = time.monotonic() - begin
        if done.returncode not in codes:
            raise Failed(f"{self.result.commands[-1]}: exit code {done.returncode}: {done.stderr.strip()[-400:]}")
        return done.stdout, seconds

    def report(self, *arguments: object, codes: tuple[int, ...] = (0,)) -> dict[str, Any]:
        """The report of `fk`."""
        return dict(json.loads(self.run(*arguments, "--json", codes=codes)[0]))

    def picture(self, name: str) -> Path:
        """A file of the part's folder that its page shows."""
        self.result.pictures.append(name)
        return self.folder / name

    def row(self, item: str, printed: str, found: str, verdict: str, why: str = "", **more: Any) -> None:
        self.result.rows.append(Row(item, printed, found, verdict, why, **more))


def example(name: str, file: str = "") -> Path:
    return ROOT / "examples" / name / (file or f"{name}.yaml")
