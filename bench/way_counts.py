#!/usr/bin/env python3
"""Counts iterations, factorisations, projections and steps of paths to equilibria, and the reasons of rejected steps.

The script runs `softkin fk --trace` along the path of every shipped robot in the physical formulation, and prints a
table in Markdown. It also runs the scenes of the given folders: along the table next to each, NAME_path.csv or
NAME.csv, or with the commands of `--set NAME A=V`.
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
    """Yields the scene and the options of each robot of the examples."""
    for path in sorted(ROOT.glob("examples/*/path.csv")) + sorted(ROOT.glob("examples/paper/*/path.csv")):
        folder = path.parent
        own = folder / f"{folder.name}.yaml"
        for scene in [own] if own.exists() else sorted(folder.glob("*.yaml")):
            yield scene, ["--path", str(path)]


def scenes_of(folder, commands):
    """Yields the scene and the options of each robot of a folder."""
    for scene in sorted(folder.glob("*.yaml")):
        tables = [folder / f"{scene.stem}_path.csv", folder / f"{scene.stem}.csv"]
        table = next((t for t in tables if t.exists()), None)
        if table:
            yield scene, ["--path", str(table)]
        elif scene.stem in commands:
            yield scene, ["--set", commands[scene.stem]]


def count_row(program, scene, options, threads, seconds):
    """Returns the row of a scene; None if it has no physical formulation."""
    with tempfile.TemporaryDirectory() as folder:
        trace = pathlib.Path(folder) / "trace.csv"
        words = [program, "fk", str(scene), *options, "--formulation", "physical", "--trace", str(trace), "--threads", str(threads)]
        try:
            ended = subprocess.run(words, capture_output=True, text=True, timeout=seconds, check=False)
        except subprocess.TimeoutExpired:
            return [f"not completed in {seconds} s"] + [""] * (len(COLUMNS) - 1)
        if ended.returncode == 2:
            return None
        with trace.open(newline="") as file:
            rows = list(csv.DictReader(file))
    per_shape = collections.Counter()
    for row in rows:
        per_shape[row["shape"]] += int(row["iterations"])
    sums = {key: sum(int(row[key]) for row in rows) for key in ("iterations", "factorisations", "projections")}
    rejected = collections.Counter(row["why"] for row in rows if row["taken"] != "1")
    reason = max(rejected, key=rejected.get, default=None)
    why = f"{reason} ({rejected[reason]})" if rejected else ""
    return [len(per_shape), sums["iterations"], max(per_shape.values(), default=0), sums["factorisations"],
            sums["projections"], len(rows), sum(rejected.values()), why]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", metavar="SOFTKIN")
    parser.add_argument("folders", metavar="FOLDER", nargs="*", type=pathlib.Path)
    parser.add_argument("--set", nargs=2, action="append", default=[], metavar=("NAME", "A=V"),
                        help="commands of a scene of a folder")
    parser.add_argument("--only", default="", help="only scenes whose path contains this text")
    parser.add_argument("--threads", type=int, default=0, help="number of threads; 0 for all")
    parser.add_argument("--seconds", type=float, default=300, help="time limit of a scene")
    options = parser.parse_args()
    print("| scene | " + " | ".join(COLUMNS) + " |")
    print("|---|" + "---|" * len(COLUMNS))
    count = 0
    commands = dict(options.set)
    for scene, words in [*shipped(), *(pair for folder in options.folders for pair in scenes_of(folder, commands))]:
        if options.only not in str(scene):
            continue
        row = count_row(options.program, scene, words, options.threads, options.seconds)
        if row is None:
            continue
        count += 1
        name = scene.relative_to(ROOT) if scene.is_relative_to(ROOT) else scene.name
        print(f"| `{name}` | " + " | ".join(map(str, row)) + " |", flush=True)
    if count == 0:
        sys.exit("way_counts: no scene was run")


if __name__ == "__main__":
    main()
