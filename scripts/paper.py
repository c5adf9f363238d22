"""Compares the paper's tables, figures and claims with the results of softkin, on one page and in a table.

  scripts/paper.py [PART ...] [--program build/softkin] [--out out/paper] [--table FILE] [--only short|long] [--check] [--accept]

The page is out/paper/index.html. The script does not repeat a part that the same program has completed. --only short
selects the parts that take a second or two, --only long the others that a test checks. --check fails if the figure of
a row differs from scripts/paper/figures.json by more than its tolerance, or if a number or claim of the paper is not
in exactly one row. --accept writes that file.
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
import air_parts as air  # noqa: E402
import fem_parts as fem  # noqa: E402
import forward_parts as forward  # noqa: E402
import inverse_parts as inverse  # noqa: E402
import material_parts as material  # noqa: E402
import method_parts as method  # noqa: E402
import size_parts as sizes  # noqa: E402
from printed import missing  # noqa: E402
from rows import ROOT, Bench, Failed, Result, Row  # noqa: E402

Part = Callable[[Bench], None]
SHORT, LONG, ALONE = "short", "long", "alone"  # one test runs SHORT, another LONG; none runs ALONE
PARTS: dict[str, tuple[str, Part, str]] = {
    "table1": ("Table I and the constants of the method", method.notation, SHORT),
    "fig1": ("Figures 1 to 4: robots and their elements", method.robots, SHORT),
    "fig5": ("Figure 5: the iteration", method.iteration, LONG),
    "fig6": ("Figure 6: strains", material.strains, LONG),
    "fig7": ("Figure 7 and Table II: ratios of R_omega", material.ratios, SHORT),
    "fig8": ("Figure 8: a gripper", forward.gripper, LONG),
    "fig9": ("Figure 9: a finger by air", forward.finger, LONG),
    "table3": ("Table III: times of a finger", fem.times, ALONE),
    "calculix": ("Figure 9 and Table III: FEM by another program", fem.finite_elements, ALONE),
    "fig10": ("Figure 10: a crawler", forward.crawler, SHORT),
    "fig11": ("Figure 11: two materials", forward.two_materials, SHORT),
    "fig12": ("Figure 12(a), (b): the workspace", inverse.workspace, LONG),
    "fig12c": ("Figure 12(c): starts of inverse kinematics", inverse.starts, LONG),
    "fig13": ("Figure 13: paths", inverse.paths, LONG),
    "nearest": ("V-B: the nearest sample instead of inverse kinematics", inverse.nearest, LONG),
    "fig14": ("Figure 14: a path beyond the reach", inverse.beyond, LONG),
    "fig15": ("Figure 15(a), (b), (d): three chambers", air.chambers, SHORT),
    "fig15c": ("Figure 15(c): pressures and ratios", air.coupled, SHORT),
    "fig15mesh": ("Figure 15: as many elements", air.as_fine, LONG),
    "fig16": ("Figure 16: a path by air", air.air_path, LONG),
    "fig17": ("Figure 17 and 25 fps: time over the size of the mesh", sizes.iteration_times, ALONE),
    "fig17accuracy": ("Figure 17: accuracy over the size of the mesh", sizes.accuracy, LONG),
}
FIGURES = ROOT / "scripts/paper/figures.json"


def key_of(program: Path) -> str:
    """Returns a digest of the program, of the scripts that run it and of the files that it reads."""
    digest = hashlib.sha256(program.read_bytes())
    robots = [file for file in (ROOT / "examples").glob("**/*") if file.suffix in (".yaml", ".csv", ".msh")]
    for file in sorted([*(ROOT / "scripts/paper").glob("*.py"), ROOT / "bench/weights_study.py", *robots]):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def run_part(name: str, program: Path, out: Path, key: str) -> Result:
    """Runs a part, or reads its result where the same program has completed it before."""
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


def rows_with_figures(results: dict[str, Result]) -> dict[str, Row]:
    """Returns the rows that have a figure, by part and item."""
    return {f"{name}: {row.item}": row for name, result in results.items() for row in result.rows if row.figure is not None}


def figure_faults(results: dict[str, Result]) -> list[str]:
    """Returns one message for each row whose figure has changed, that is new, or that is missing."""
    accepted: dict[str, float] = json.loads(FIGURES.read_text())
    absent = [item for item in accepted if item.split(":")[0] in results and item not in rows_with_figures(results)]
    faults = [f"{item}: there is no such row" for item in absent]
    for item, row in rows_with_figures(results).items():
        before = accepted.get(item)
        if before is None or row.figure is None or not abs(row.figure - before) <= row.tolerance * abs(before):
            faults.append(f"{item}: the figure is {row.figure!r}; the accepted one is {before!r} "
                          f"(within {100 * row.tolerance:g} %)")
    return faults


def picture_html(folder: Path, picture: str) -> str:
    """Returns a picture as HTML without references to other files."""
    file = folder / picture
    if file.suffix == ".svg":
        return f"<div style='display:inline-block;width:520px'>{file.read_text()}</div>"
    data = base64.b64encode(file.read_bytes()).decode()
    return f"<img alt='{picture}' style='width:340px' src='data:image/png;base64,{data}'>"


def page(results: dict[str, Result], out: Path, machine: str) -> str:
    """Returns the page as one HTML file that needs no network."""
    style = ("body{font-family:sans-serif;max-width:1120px;margin:2em auto}"
             "td,th{border:1px solid #ccc;padding:4px;text-align:left;vertical-align:top}")
    text = [f"<!doctype html><html lang='en'><meta charset='utf-8'><title>The paper by softkin</title><style>{style}</style>"]
    text.append(f"<h1>The paper's tables and figures by softkin</h1><p>{html.escape(machine)}</p>")
    for name, result in results.items():
        text.append(f"<h2 id='{name}'>{html.escape(PARTS[name][0])}</h2><table style='border-collapse:collapse'><tr>")
        text += [f"<th>{head}</th>" for head in HEADS]
        text += ["</tr><tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells(row)) for row in result.rows]
        text.append("</tr></table><p>")
        text += [picture_html(out / name, picture) for picture in result.pictures]
        tables = [Path(picture).with_suffix(".csv").name for picture in result.pictures if picture.endswith(".svg")]
        text.append("</p><p>data: " + ", ".join(f"<a href='{name}/{table}'>{table}</a>" for table in tables)
                    if tables else "")
        commands = html.escape("\n".join(result.commands))
        text.append(f"</p><details><summary>commands, {result.seconds:.0f} s</summary><pre>{commands}</pre></details>")
    return "\n".join(text) + "\n</html>\n"


def table(results: dict[str, Result], machine: str) -> str:
    """Returns the rows of all parts as Markdown."""
    lines = ["# The paper's numbers by softkin", "", "Made by `make paper`; the same with pictures is `out/paper/index.html`. " + machine]
    for name, result in results.items():
        lines += ["", f"## {PARTS[name][0]}", "", "| " + " | ".join(HEADS) + " |", "|---" * len(HEADS) + "|"]
        lines += ["| " + " | ".join(cells(row)) + " |" for row in result.rows]
    return "\n".join(lines) + "\n"


HEADS = ("", "printed", "softkin", "conditions", "verdict")


def cells(row: Row) -> tuple[str, ...]:
    return row.item, row.printed, row.found, row.conditions, row.verdict + (f": {row.why}" if row.why else "")


def machine_of(program: Path) -> str:
    """Returns the version of the program, the processor and the number of cores."""
    version = subprocess.run([str(program), "--version"], capture_output=True, text=True, check=True).stdout
    cpu = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if "model name" in line), "")
    return f"{' '.join(version.split())}; {cpu}, {os.cpu_count()} cores."


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--program", type=Path, default=ROOT / "build/softkin")
    parser.add_argument("--out", type=Path, default=ROOT / "out/paper")
    parser.add_argument("--table", type=Path, help="file for the rows as Markdown")
    parser.add_argument("--only", choices=(SHORT, LONG))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--accept", action="store_true")
    options = parser.parse_args()
    for name in options.parts:
        if name not in PARTS:
            parser.error(f"unknown part '{name}'; the parts are {', '.join(PARTS)}")
    names = options.parts or [name for name, (_, _, kind) in PARTS.items() if options.only in (None, kind)]
    key, results = key_of(options.program), {}
    for i, name in enumerate(names):
        print(f"[{i + 1}/{len(names)}] {PARTS[name][0]}", flush=True)
        try:
            results[name] = run_part(name, options.program, options.out, key)
        except Failed as failed:
            print(f"paper: {name}: {failed}", file=sys.stderr)
            return 1
        print(f"  {len(results[name].rows)} rows, {results[name].seconds:.1f} s", flush=True)
    machine = machine_of(options.program)
    (options.out / "index.html").write_text(page(results, options.out, machine))
    print(f"the page: {options.out / 'index.html'}")
    if options.table:
        options.table.write_text(table(results, machine))
    if options.accept:
        figures = json.loads(FIGURES.read_text()) if FIGURES.exists() else {}
        figures = {item: figure for item, figure in figures.items() if item.split(":")[0] in PARTS.keys() - results.keys()}
        figures |= {item: row.figure for item, row in rows_with_figures(results).items()}
        FIGURES.write_text(json.dumps(dict(sorted(figures.items())), indent=1) + "\n")
    if options.check:
        faults = figure_faults(results) + missing(results)
        print("\n".join(faults) or f"{sum(len(result.rows) for result in results.values())} rows, none has moved")
        return 1 if faults else 0
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
