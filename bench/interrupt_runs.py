#!/usr/bin/env python3
"""Interrupts commands by Ctrl-C (SIGINT) at random instants and continues from their outputs.

fk --path, follow, walk, workspace and map continue by --resume: at the end every file must be identical to that of an
undisturbed run, except for the seconds in reports. fk and ik continue by --start from the shape at which they stopped,
and fk continues from the shape of grasp: each must end at the shape of an undisturbed run. The script needs only
Python.
"""

import argparse
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
import small_robot
from kill_runs import files_of, write_targets

GRIPPER = pathlib.Path(__file__).resolve().parent.parent / "examples/two_finger_gripper/two_finger_gripper.yaml"


def long_bar(cells):
    """Returns the scene of a bar of `cells` cubes of 10 mm with a tendon along its top."""
    points = ", ".join(f"[{10 * i}, 5, 10]" for i in range(0, cells + 1, 4))
    return small_robot.RUBBER.replace("bar.msh", "long.msh") + f"""fixed: [{{region: base}}]
actuators:
  - {{name: upper, kind: cable, points: [{points}], control: length, range: [0.4, 1.2]}}
markers: [{{name: tip, region: tip}}]
"""


def resumable_commands(steps):
    """Returns the commands that continue by --resume, by name."""
    return {
        "fk --path": ["fk", "../bend.yaml", "--path", "../path.csv", "-o", "s.pvd", "--report", "r.json"],
        "follow": ["follow", "../bend.yaml", "../targets.csv", "-o", "out"],
        "walk": ["walk", "../walk.yaml", "../gait.csv", "-o", "out", "--cycles", str(max(1, steps // 4))],
        "workspace": ["workspace", "../bend.yaml", "--samples", str(10 * steps), "--sampling", "sobol", "-o", "w.csv"],
        "map": ["map", "../bend.yaml", "-o", "m.skmap", "--accuracy", "1e-5"],
    }


class Stops:
    """Runs of one program, each interrupted at a random instant or run to its end."""

    def __init__(self, program, generator):
        self.program, self.generator = program, generator
        self.stops = 0

    def run(self, words, folder, seconds=None):
        """Runs the program; returns its exit code and its standard error.

        If seconds is given, the run is interrupted at a random instant within that time after its first output.
        """
        process = subprocess.Popen([self.program, *words, "--threads", "1"], cwd=folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        first_line = process.stdout.readline()  # the program prints the robot after its assembly
        if seconds is not None and first_line:
            time.sleep(self.generator.random() * seconds)
            process.send_signal(signal.SIGINT)
        errors = process.communicate()[1].decode()
        if process.returncode < 0:
            sys.exit(f"interrupt_runs: {' '.join(words)}: ended by signal {-process.returncode}: {errors}")
        if process.returncode == 1 and "interrupted" not in errors:
            sys.exit(f"interrupt_runs: {' '.join(words)}: exit code 1: {errors}")
        if process.returncode not in (0, 1):
            sys.exit(f"interrupt_runs: {' '.join(words)}: exit code {process.returncode}: {errors}")
        self.stops += process.returncode == 1
        return process.returncode, errors

    def run_undisturbed(self, words, folder):
        """Runs the program to its end in a new folder; returns the seconds."""
        folder.mkdir()
        begin = time.monotonic()
        code, errors = self.run(words, folder)
        if code != 0:
            sys.exit(f"interrupt_runs: {' '.join(words)}: {errors}")
        return time.monotonic() - begin


def check_resume(name, words, program, max_stops, folder, generator):
    """Continues each interrupted run by --resume until it is complete, and compares its files."""
    stops = Stops(program, generator)
    seconds = stops.run_undisturbed(words, folder / f"{name} whole")
    expected = files_of(folder / f"{name} whole")
    runs = 0
    while stops.stops < max_stops:
        place = folder / f"{name} {runs}"
        place.mkdir()
        code, _ = stops.run(words, place, seconds)
        while code != 0:
            code, _ = stops.run([*words, "--resume"], place, seconds if stops.stops < max_stops else None)
        files = files_of(place)
        for file in sorted(files.keys() | expected.keys()):
            if files.get(file) != expected.get(file):
                sys.exit(f"interrupt_runs: {name}: {file} differs from that of an undisturbed run")
        runs += 1
    print(f"{name}: {stops.stops} stops in {runs} runs of {seconds:.2f} s, "
          f"{len(expected)} files identical to those of an undisturbed run",
          flush=True)


def tip_of(report):
    """Returns the position of the marker tip, and the status, of the first step of a report."""
    step = json.loads(report.read_text())
    step = step["steps"][0] if "steps" in step else step
    return step["markers"]["tip"], step.get("status")


def check_start(name, words, program, max_stops, folder, generator, tolerance_mm):
    """Continues each interrupted run by --start from its last shape until it is complete, and compares the tip."""
    stops = Stops(program, generator)
    outputs = ["-o", "0.vtu", "--report", "0.json"]
    seconds = stops.run_undisturbed([*words, *outputs], folder / name)
    expected_tip, _ = tip_of(folder / name / "0.json")
    runs, percentages = 0, []
    while stops.stops < max_stops:
        place = folder / f"{name} {runs}"
        place.mkdir()
        start, number, code = [], 0, 1
        while code != 0:
            outputs = ["-o", f"{number}.vtu", "--report", f"{number}.json"]
            code, errors = stops.run([*words, *start, *outputs], place, seconds if stops.stops < max_stops else None)
            shape = place / f"{number}.vtu"
            if not shape.exists():
                sys.exit(f"interrupt_runs: {name}: the interrupted run wrote no shape: {errors}")
            if percentage := re.search(r"at ([0-9.]+) % of the ", errors):
                percentages.append(float(percentage[1]))
            start, number = ["--start", shape.name], number + 1
        tip, _ = tip_of(place / f"{number - 1}.json")
        if max(abs(a - b) for a, b in zip(tip, expected_tip)) > tolerance_mm:
            sys.exit(f"interrupt_runs: {name}: the tip is at {tip}, that of an undisturbed run at {expected_tip}")
        runs += 1
    where = f", at {min(percentages):.1f} to {max(percentages):.1f} % of the load path" if percentages else ""
    print(f"{name}: {stops.stops} stops in {runs} runs of {seconds:.2f} s{where}, "
          f"each continued to the tip of an undisturbed run",
          flush=True)


def check_grasp(program, max_stops, folder, generator):
    """Interrupts grasp in any of its stages, and continues by fk from the shape that it writes."""
    stops = Stops(program, generator)
    closed = ["--set", "left.air=1.15", "--set", "right.air=1.15"]
    words = ["grasp", str(GRIPPER), *closed, "--pull", "x"]
    seconds = stops.run_undisturbed([*words, "-o", "g.vtu"], folder / "grasp")
    for number in range(max_stops):
        place = folder / f"grasp {number}"
        place.mkdir()
        stops.run([*words, "-o", "g.vtu"], place, seconds)
        if not (place / "g.vtu").exists():
            sys.exit("interrupt_runs: grasp: the interrupted run wrote no shape")
        code, errors = stops.run(["fk", str(GRIPPER), *closed, "--start", "g.vtu"], place)
        if code != 0:
            sys.exit(f"interrupt_runs: fk from the shape of grasp failed: {errors}")
    print(f"grasp: {stops.stops} stops in runs of {seconds:.1f} s, fk continued from the shape of each", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/softkin")
    parser.add_argument("--stops", type=int, default=20, help="number of interruptions of each command (default: 20)")
    parser.add_argument("--steps", type=int, default=60,
                        help="number of steps of the paths; the workspace has ten times as many samples")
    parser.add_argument("--cells", type=int, default=120, help="number of cubes of the bar that fk and ik bend")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="one of the commands: fk, ik, fk --path, follow, walk, workspace, map, grasp; grasp "
                                       "runs only if it is given here")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        small_robot.write(folder, options.steps)
        (folder / "long.msh").write_text(small_robot.bar(options.cells))
        (folder / "long.yaml").write_text(long_bar(options.cells))
        write_targets(program, folder)
        if options.only == "grasp":
            return check_grasp(program, options.stops, folder, random.Random(options.seed))
        for name, words in resumable_commands(options.steps).items():
            if options.only in (None, name):
                check_resume(name, words, program, options.stops, folder, random.Random(f"{options.seed} {name}"))
        bend = ["fk", "../long.yaml", "--set", "upper=0.6"]
        if options.only in (None, "fk"):
            check_start("fk", bend, program, options.stops, folder, random.Random(f"{options.seed} fk"), 1e-4)
        if options.only in (None, "ik"):
            stops = Stops(program, random)
            (folder / "target").mkdir()
            stops.run(["fk", "../long.yaml", "--set", "upper=0.97", "--report", "r.json"], folder / "target")
            target, _ = tip_of(folder / "target/r.json")
            check_start("ik", ["ik", "../long.yaml", "--target", f"tip={target[0]},,{target[2]}"], program,
                        options.stops, folder,
                        random.Random(f"{options.seed} ik"), 2e-3)


if __name__ == "__main__":
    main()
