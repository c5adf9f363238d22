#!/usr/bin/env python3
"""Stops commands by Ctrl-C (SIGINT) at random instants of their work and goes on from what they leave.

fk --path, follow, walk, workspace and map go on by --resume: at the end every file must be that of an undisturbed run, byte
for byte but for the seconds that a report tells. fk and ik go on by --start from the shape that was stopped on its way, grasp's
shape is taken up by fk: each must end where an undisturbed run does. Needs Python alone.
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
    """A bar of so many cubes of 10 mm with a tendon along its top."""
    points = ", ".join(f"[{10 * i}, 5, 10]" for i in range(0, cells + 1, 4))
    return small_robot.RUBBER.replace("bar.msh", "long.msh") + f"""fixed: [{{region: base}}]
actuators:
  - {{name: upper, kind: cable, points: [{points}], control: length, range: [0.4, 1.2]}}
markers: [{{name: tip, region: tip}}]
"""


def resumed(steps):
    """By name what goes on by --resume."""
    return {
        "fk --path": ["fk", "../bend.yaml", "--path", "../path.csv", "-o", "s.pvd", "--report", "r.json"],
        "follow": ["follow", "../bend.yaml", "../targets.csv", "-o", "out"],
        "walk": ["walk", "../walk.yaml", "../gait.csv", "-o", "out", "--cycles", str(max(1, steps // 4))],
        "workspace": ["workspace", "../bend.yaml", "--samples", str(10 * steps), "--sampling", "sobol", "-o", "w.csv"],
        "map": ["map", "../bend.yaml", "-o", "m.skmap", "--accuracy", "1e-5"],
    }


class Stops:
    """Runs of one program, each stopped at an instant of its work or let go to its end."""

    def __init__(self, program, generator):
        self.program, self.generator = program, generator
        self.stops = 0

    def run(self, words, folder, seconds=None):
        """Exit code, and what was said on standard error. seconds: of the work, within which it is stopped."""
        process = subprocess.Popen([self.program, *words, "--threads", "1"], cwd=folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE)
        begun = process.stdout.readline()  # the robot is told when it is assembled
        if seconds is not None and begun:
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

    def undisturbed(self, words, folder):
        folder.mkdir()
        begin = time.monotonic()
        code, errors = self.run(words, folder)
        if code != 0:
            sys.exit(f"interrupt_runs: {' '.join(words)}: {errors}")
        return time.monotonic() - begin


def by_resume(name, words, program, most, folder, generator):
    stops = Stops(program, generator)
    seconds = stops.undisturbed(words, folder / f"{name} whole")
    expected = files_of(folder / f"{name} whole")
    runs = 0
    while stops.stops < most:
        place = folder / f"{name} {runs}"
        place.mkdir()
        code, _ = stops.run(words, place, seconds)
        while code != 0:
            code, _ = stops.run([*words, "--resume"], place, seconds if stops.stops < most else None)
        files = files_of(place)
        for file in sorted(files.keys() | expected.keys()):
            if files.get(file) != expected.get(file):
                sys.exit(f"interrupt_runs: {name}: {file} is not that of an undisturbed run")
        runs += 1
    print(f"{name}: {stops.stops} stops in {runs} runs of {seconds:.2f} s, {len(expected)} files as those of an undisturbed run",
          flush=True)


def tip_of(report):
    step = json.loads(report.read_text())
    step = step["steps"][0] if "steps" in step else step
    return step["markers"]["tip"], step.get("status")


def by_start(name, words, program, most, folder, generator, near_mm):
    """Goes on from the shape that each stop leaves, until it is done."""
    stops = Stops(program, generator)
    outputs = ["-o", "0.vtu", "--report", "0.json"]
    seconds = stops.undisturbed([*words, *outputs], folder / name)
    there, _ = tip_of(folder / name / "0.json")
    runs, shares = 0, []
    while stops.stops < most:
        place = folder / f"{name} {runs}"
        place.mkdir()
        start, number, code = [], 0, 1
        while code != 0:
            outputs = ["-o", f"{number}.vtu", "--report", f"{number}.json"]
            code, errors = stops.run([*words, *start, *outputs], place, seconds if stops.stops < most else None)
            shape = place / f"{number}.vtu"
            if not shape.exists():
                sys.exit(f"interrupt_runs: {name}: no shape was left: {errors}")
            if share := re.search(r"at ([0-9.]+) % of the way", errors):
                shares.append(float(share[1]))
            start, number = ["--start", shape.name], number + 1
        tip, _ = tip_of(place / f"{number - 1}.json")
        if max(abs(a - b) for a, b in zip(tip, there)) > near_mm:
            sys.exit(f"interrupt_runs: {name}: ended at {tip}, undisturbed at {there}")
        runs += 1
    told = f", stopped at {min(shares):.1f} to {max(shares):.1f} % of the way" if shares else ""
    print(f"{name}: {stops.stops} stops in {runs} runs of {seconds:.2f} s{told}, each went on to where it was to", flush=True)


def of_grasp(program, most, folder, generator):
    """The gripper's shape is left in each stage, and fk goes on from it."""
    stops = Stops(program, generator)
    closed = ["--set", "left.air=1.15", "--set", "right.air=1.15"]
    words = ["grasp", str(GRIPPER), *closed, "--pull", "x"]
    seconds = stops.undisturbed([*words, "-o", "g.vtu"], folder / "grasp")
    for number in range(most):
        place = folder / f"grasp {number}"
        place.mkdir()
        stops.run([*words, "-o", "g.vtu"], place, seconds)
        if not (place / "g.vtu").exists():
            sys.exit("interrupt_runs: grasp: no shape was left")
        code, errors = stops.run(["fk", str(GRIPPER), *closed, "--start", "g.vtu"], place)
        if code != 0:
            sys.exit(f"interrupt_runs: fk from the shape that grasp left: {errors}")
    print(f"grasp: {stops.stops} stops in runs of {seconds:.1f} s, each left a shape to go on from", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/softkin")
    parser.add_argument("--stops", type=int, default=20, help="of each command (default: 20)")
    parser.add_argument("--steps", type=int, default=60, help="of the paths; of the workspace ten times as many samples")
    parser.add_argument("--cells", type=int, default=120, help="of the bar that fk and ik bend")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="one of the commands: fk, ik, fk --path, follow, walk, workspace, map, grasp; grasp "
                                       "runs alone")
    asked = parser.parse_args()
    program = os.path.abspath(asked.program)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        small_robot.write(folder, asked.steps)
        (folder / "long.msh").write_text(small_robot.bar(asked.cells))
        (folder / "long.yaml").write_text(long_bar(asked.cells))
        write_targets(program, folder)
        if asked.only == "grasp":
            return of_grasp(program, asked.stops, folder, random.Random(asked.seed))
        for name, words in resumed(asked.steps).items():
            if asked.only in (None, name):
                by_resume(name, words, program, asked.stops, folder, random.Random(f"{asked.seed} {name}"))
        bend = ["fk", "../long.yaml", "--set", "upper=0.6"]
        if asked.only in (None, "fk"):
            by_start("fk", bend, program, asked.stops, folder, random.Random(f"{asked.seed} fk"), 1e-4)
        if asked.only in (None, "ik"):
            stops = Stops(program, random)
            (folder / "target").mkdir()
            stops.run(["fk", "../long.yaml", "--set", "upper=0.97", "--report", "r.json"], folder / "target")
            target, _ = tip_of(folder / "target/r.json")
            by_start("ik", ["ik", "../long.yaml", "--target", f"tip={target[0]},,{target[2]}"], program, asked.stops, folder,
                     random.Random(f"{asked.seed} ik"), 2e-3)


if __name__ == "__main__":
    main()
