#!/usr/bin/env python3
"""What ways to equilibria take: iterations, factorisations, projections and steps, and why steps were not taken.

Runs `softkin fk --trace` along the path of every shipped robot in the physical formulation, and prints a table in
Markdown. So are scenes of the folders that are named: along the table beside them, NAME_path.csv or NAME.csv, or at
the commands that `--set NAME A=V` gives them.
"""

import argparse
import collections
import csv
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
COLUMNS = ["shapes", "iterations", "most in a shape", "factorisations", "projections", "steps", "not taken", "most often because"]


def shipped():
    """Scene and path of the robots of examples."""
    for path in sorted(ROOT.glob("examples/*/path.csv")) + sorted(ROOT.glob("examples/paper/*/path.csv")):
        folder = path.parent
        own = folder / f"{folder.name}.yaml"
        for scene in [own] if own.exists() else sorted(folder.glob("*.yaml")):
            yield scene, ["--path", str(path)]


def of_folder(folder, commands):
    for scene in sorted(folder.glob("*.yaml")):
        tables = [folder / f"{scene.stem}_path.csv", folder / f"{scene.stem}.csv"]
        table = next((t for t in tables if t.exists()), None)
        if table:
            yield scene, ["--path", str(table)]
        elif scene.stem in commands:
            yield scene, ["--set", commands[scene.stem]]


def counted(program, scene, options, threads, seconds):
    """The row of a scene; None where it is not physical and cannot be made so."""
    with tempfile.TemporaryDirectory() as folder:
        trace = pathlib.Path(folder) / "trace.csv"
        words = [program, "fk", str(scene), *options, "--formulation", "physical", "--trace", str(trace), "--threads", str(threads)]
        try:
            ended = subprocess.run(words, capture_output=True, text=True, timeout=seconds, check=False)
        except subprocess.TimeoutExpired:
            return [f"not done in {seconds} s"] + [""] * (len(COLUMNS) - 1)
        if ended.returncode == 2:
            return None
        with trace.open(newline="") as file:
            rows = list(csv.DictReader(file))
    per_shape = collections.Counter()
    for row in rows:
        per_shape[row["shape"]] += int(row["iterations"])
    sums = {key: sum(int(row[key]) for row in rows) for key in ("iterations", "factorisations", "projections")}
    missed = collections.Counter(row["why"] for row in rows if row["taken"] != "1")
    why = f"{missed.most_common(1)[0][0]} ({missed.most_common(1)[0][1]})" if missed else ""
    return [len(per_shape), sums["iterations"], max(per_shape.values(), default=0), sums["factorisations"],
            sums["projections"], len(rows), sum(missed.values()), why]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", metavar="SOFTKIN")
    parser.add_argument("folders", metavar="FOLDER", nargs="*", type=pathlib.Path)
    parser.add_argument("--set", nargs=2, action="append", default=[], metavar=("NAME", "A=V"), help="of a scene of a folder")
    parser.add_argument("--only", default="", help="scenes whose path has this")
    parser.add_argument("--threads", type=int, default=0, help="0: all")
    parser.add_argument("--seconds", type=float, default=300, help="longest run of a scene")
    options = parser.parse_args()
    print("| scene | " + " | ".join(COLUMNS) + " |")
    print("|---|" + "---|" * len(COLUMNS))
    count = 0
    commands = dict(options.set)
    for scene, words in [*shipped(), *(pair for folder in options.folders for pair in of_folder(folder, commands))]:
        if options.only not in str(scene):
            continue
        row = counted(options.program, scene, words, options.threads, options.seconds)
        if row is None:
            continue
        count += 1
        name = scene.relative_to(ROOT) if scene.is_relative_to(ROOT) else scene.name
        print(f"| `{name}` | " + " | ".join(map(str, row)) + " |", flush=True)
    if count == 0:
        sys.exit("way_counts: no scene was run")


if __name__ == "__main__":
    main()
