"""The paper's tables, figures and claims, each beside what softkin gives for it: one page, out/paper/index.html, and a table.

  scripts/paper.py [PART ...] [--program build/softkin] [--out out/paper] [--table FILE] [--short] [--check] [--accept]

A part that was done by the same program is not run again. --short: parts of some seconds alone. --check: fails where the
figure of a row has moved by more than its tolerance from scripts/paper/figures.json. --accept: writes that file.
Exit codes: 0 done, 1 a part failed or a figure has moved, 2 usage."""

from __future__ import annotations

import argparse
import base64
import hashlib
import html
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "paper"))
import inverse_parts as inverse  # noqa: E402
import kinematics_parts as kinematics  # noqa: E402
from rows import ROOT, Bench, Failed, Result, Row  # noqa: E402

Part = Callable[[Bench], None]
PARTS: dict[str, tuple[str, Part, bool]] = {  # title, part, is it short
    "table1": ("Table I", kinematics.notation, True),
    "fig1": ("Figures 1 to 4", kinematics.robots, True),
    "fig5": ("Figure 5: the iteration", kinematics.iteration, False),
    "fig6": ("Figure 6: strains", kinematics.strains, True),
    "fig7": ("Figure 7 and Table II: ratios of R_omega", kinematics.ratios, False),
    "fig8": ("Figure 8: a gripper", kinematics.gripper, True),
    "fig9": ("Figure 9 and Table III: a finger by air", kinematics.finger, False),
    "fig10": ("Figure 10: a crawler", kinematics.crawler, False),
    "fig11": ("Figure 11: two materials", kinematics.two_materials, True),
    "fig12b": ("Figure 12(b): the workspace", inverse.workspace, True),
    "fig12c": ("Figure 12(c): starts of inverse kinematics", inverse.starts, True),
    "fig13": ("Figure 13: paths", inverse.paths, True),
    "fig14": ("Figure 14: a path beyond the reach", inverse.beyond, True),
    "fig15": ("Figure 15: three chambers", inverse.chambers, True),
    "fig16": ("Figure 16: a path by air", inverse.air_path, False),
    "fig17": ("Figure 17 and 25 fps: sizes of meshes", inverse.sizes, False),
}
FIGURES = ROOT / "scripts/paper/figures.json"


def key_of(program: Path) -> str:
    """Of the program and of what runs it."""
    digest = hashlib.sha256(program.read_bytes())
    for file in sorted((ROOT / "scripts/paper").glob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def run_part(name: str, program: Path, out: Path, key: str) -> Result:
    folder = out / name
    done, stamp = folder / "result.json", folder / "program.txt"
    if done.exists() and stamp.exists() and stamp.read_text() == key:
        return Result.read(done)
    bench = Bench(program, folder)
    begin = time.monotonic()
    PARTS[name][1](bench)
    bench.result.seconds = time.monotonic() - begin
    done.write_text(bench.result.text())
    stamp.write_text(key)
    return bench.result


def figured(results: dict[str, Result]) -> dict[str, Row]:
    """Rows with a figure, by part and item."""
    return {f"{name}: {row.item}": row for name, result in results.items() for row in result.rows if row.figure is not None}


def moved(results: dict[str, Result]) -> list[str]:
    """Rows whose figure is not what it was, or that have none there."""
    known: dict[str, float] = json.loads(FIGURES.read_text())
    faults = []
    for item, row in figured(results).items():
        before = known.get(item)
        if before is None or not abs(row.figure - before) <= row.tolerance * abs(before):
            faults.append(f"{item}: {row.figure!r}, and was {before!r} (within {100 * row.tolerance:g} %)")
    return faults


def shown(folder: Path, picture: str) -> str:
    file = folder / picture
    if file.suffix == ".svg":
        return f"<div style='display:inline-block;width:520px'>{file.read_text()}</div>"
    data = base64.b64encode(file.read_bytes()).decode()
    return f"<img alt='{picture}' style='width:340px' src='data:image/png;base64,{data}'>"


def page(results: dict[str, Result], out: Path, machine: str) -> str:
    """One file, without a network."""
    style = "body{font-family:sans-serif;max-width:1120px;margin:2em auto}td,th{border:1px solid #ccc;padding:4px;text-align:left;vertical-align:top}"
    text = [f"<!doctype html><html lang='en'><meta charset='utf-8'><title>The paper by softkin</title><style>{style}</style>"]
    text.append(f"<h1>The paper's tables and figures by softkin</h1><p>{html.escape(machine)}</p>")
    for name, result in results.items():
        text.append(f"<h2 id='{name}'>{html.escape(PARTS[name][0])}</h2><table style='border-collapse:collapse'><tr>")
        text += [f"<th>{head}</th>" for head in HEADS]
        text += ["</tr><tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells(row)) for row in result.rows]
        text.append("</tr></table><p>")
        text += [shown(out / name, picture) for picture in result.pictures]
        commands = html.escape("\n".join(result.commands))
        text.append(f"</p><details><summary>commands, {result.seconds:.0f} s</summary><pre>{commands}</pre></details>")
    return "\n".join(text) + "\n</html>\n"


def table(results: dict[str, Result], machine: str) -> str:
    lines = ["# The paper's numbers by softkin", "", "Made by `make paper`; the same with pictures is `out/paper/index.html`. " + machine, ""]
    lines += ["| " + " | ".join(HEADS) + " |", "|---" * len(HEADS) + "|"]
    lines += ["| " + " | ".join(cells(row)) + " |" for result in results.values() for row in result.rows]
    return "\n".join(lines) + "\n"


HEADS = ("", "printed", "softkin", "conditions", "verdict")


def cells(row: Row) -> tuple[str, ...]:
    return row.item, row.printed, row.found, row.conditions, row.verdict + (f": {row.why}" if row.why else "")


def machine_of(program: Path) -> str:
    version = subprocess.run([str(program), "--version"], capture_output=True, text=True, check=True).stdout
    cpu = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if "model name" in line), "")
    return f"{' '.join(version.split())}; {cpu}, {os.cpu_count()} cores."


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--program", type=Path, default=ROOT / "build/softkin")
    parser.add_argument("--out", type=Path, default=ROOT / "out/paper")
    parser.add_argument("--table", type=Path, help="the rows as Markdown")
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--accept", action="store_true")
    options = parser.parse_args()
    for name in options.parts:
        if name not in PARTS:
            parser.error(f"there is no part '{name}'; there are {', '.join(PARTS)}")
    names = options.parts or [name for name, (_, _, short) in PARTS.items() if short or not options.short]
    key, results = key_of(options.program), {}
    for i, name in enumerate(names):
        print(f"[{i + 1}/{len(names)}] {PARTS[name][0]}", flush=True)
        try:
            results[name] = run_part(name, options.program, options.out, key)
        except Failed as failed:
            print(f"paper: {name}: {failed}", file=sys.stderr)
            return 1
    machine = machine_of(options.program)
    (options.out / "index.html").write_text(page(results, options.out, machine))
    print(f"the page: {options.out / 'index.html'}")
    if options.table:
        options.table.write_text(table(results, machine))
    if options.accept:
        figures = json.loads(FIGURES.read_text()) if FIGURES.exists() else {}
        figures = {item: figure for item, figure in figures.items() if item.split(":")[0] not in results}
        figures |= {item: row.figure for item, row in figured(results).items()}
        FIGURES.write_text(json.dumps(dict(sorted(figures.items())), indent=1) + "\n")
    if options.check:
        faults = moved(results)
        print("\n".join(faults) or f"{sum(len(result.rows) for result in results.values())} rows, none has moved")
        return 1 if faults else 0
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
