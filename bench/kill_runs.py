#!/usr/bin/env python3
"""Kills fk --path, follow, walk and workspace with SIGKILL at random instants and resumes them.

After a kill no record that was on disk before may be lost or changed; at the end every file must be identical to that
of an undisturbed run, except for the seconds in reports. The script needs only Python.
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

SECONDS = re.compile(rb'("seconds": ?)[-+0-9.eE]+')


def commands(steps):
    """Returns by name each command and the file of its records while it runs: the journal, or the table itself."""
    return {
        "fk --path": (["fk", "../bend.yaml", "--path", "../path.csv", "-o", "s.pvd", "--report", "r.json", "--plot", "p.svg",
                       "--image", "i.png"], "r.json.run"),
        "follow": (["follow", "../bend.yaml", "../targets.csv", "-o", "out"], "out/report.json.run"),
        "walk": (["walk", "../walk.yaml", "../gait.csv", "-o", "out", "--cycles", str(max(1, steps // 4))],
                 "out/report.json.run"),
        "workspace": (["workspace", "../bend.yaml", "--samples", str(10 * steps), "--sampling", "sobol", "-o", "w.csv",
                       "--cloud", "c.vtu", "--hull", "h.stl", "--plot", "p.svg"], "w.csv"),
    }


def write_targets(program, folder):
    """Writes the waypoints of follow: the positions of the tip along the path of fk."""
    subprocess.run([program, "fk", "bend.yaml", "--path", "path.csv", "--report", "r.json", "--threads", "1"], cwd=folder,
                   check=True, capture_output=True)
    steps = json.loads((folder / "r.json").read_text())["steps"]
    rows = [f"{x!r},{z!r}" for x, _, z in (step["markers"]["tip"] for step in steps)]
    (folder / "targets.csv").write_text("\n".join(["x_mm,z_mm", *rows, ""]))


def start(program, words, folder):
    """Starts the program with one thread."""
    return subprocess.Popen([program, *words, "--threads", "1"], cwd=folder, stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE)


def finish(program, words, folder):
    """Runs the program to its end; exits with a message if it fails."""
    process = start(program, words, folder)
    errors = process.communicate()[1].decode()
    if process.returncode != 0:
        sys.exit(f"kill_runs: {' '.join(words)}: exit code {process.returncode}: {errors}")


def files_of(folder):
    """Returns the contents of every file by name, without the seconds of reports."""
    return {str(path.relative_to(folder)): SECONDS.sub(rb"\1CLOCK", path.read_bytes()) if path.suffix == ".json"
            else path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def records_of(file):
    """Returns the complete lines of a file of records, None without a file, and whether an incomplete line follows."""
    if not file.exists():
        return None, False
    lines = file.read_bytes().split(b"\n")
    if file.suffix == ".csv":
        return sorted(line for line in lines[:-1] if line[:1].isdigit()), lines[-1] != b""
    for line in lines[:-1]:
        json.loads(line)
    return lines[1:-1], lines[-1] != b""


class Kills:
    """Kills one command at random instants, in as many runs as necessary."""

    def __init__(self, program, words, journal, folder, generator):
        self.program, self.words, self.journal, self.folder = program, words, journal, folder
        self.generator = generator
        self.kills = self.runs = self.torn = self.kept = 0

    def run_undisturbed(self):
        """Measures the seconds of a run without kills, and reads the files that it writes."""
        folder = self.folder / "undisturbed"
        self.make_empty(folder)
        begin = time.monotonic()
        finish(self.program, self.words, folder)
        self.seconds = time.monotonic() - begin
        self.expected = files_of(folder)

    def make_empty(self, folder):
        """Makes a folder, or removes everything in it."""
        for each in sorted(folder.rglob("*"), reverse=True):
            each.rmdir() if each.is_dir() else each.unlink()
        folder.mkdir(exist_ok=True)

    def run(self, max_kills):
        """Starts the command, and kills and resumes it until it ends or there are max_kills kills."""
        folder = self.folder / "killed"
        self.make_empty(folder)
        before, resume = [], []
        while self.kills < max_kills:
            process = start(self.program, self.words + resume, folder)
            time.sleep(self.generator.random() * self.seconds)
            process.send_signal(signal.SIGKILL)
            errors = process.communicate()[1].decode()
            resume = ["--resume"]
            if process.returncode == 0:
                break
            if process.returncode != -signal.SIGKILL:
                sys.exit(f"kill_runs: the run failed after a kill: {errors}")
            self.kills += 1
            before = self.check(folder, before)
        finish(self.program, self.words + resume, folder)
        self.compare(files_of(folder))
        self.runs += 1

    def check(self, folder, before):
        """Checks that the records on disk after a kill start with those before it; returns them."""
        records, torn = records_of(folder / self.journal)
        self.torn += torn
        if records is None:  # the run had not begun, or it had written its report
            if before and not (folder / self.journal.removesuffix(".run")).exists():
                sys.exit("kill_runs: the file of records does not exist after the kill")
            return before
        kept = set(records) >= set(before) if self.journal.endswith(".csv") else records[:len(before)] == before
        if not kept:
            sys.exit(f"kill_runs: {len(before)} records were on disk; "
                     f"the {len(records)} after the kill do not contain them")
        self.kept = max(self.kept, len(records))
        return records

    def compare(self, files):
        """Exits with a message if a file differs from that of an undisturbed run."""
        for name in sorted(files.keys() | self.expected.keys()):
            if files.get(name) != self.expected.get(name):
                sys.exit(f"kill_runs: after run {self.runs}, {self.kills} kills: {name} is not that of an undisturbed run: "
                         + ("missing" if name not in files else "not expected" if name not in self.expected else "differs"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/softkin")
    parser.add_argument("--kills", type=int, default=100, help="number of kills of each command (default: 100)")
    parser.add_argument("--steps", type=int, default=60,
                        help="number of steps of the paths; the workspace has ten times as many samples")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="one of the commands: fk --path, follow, walk, workspace")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    for name, (words, journal) in commands(options.steps).items():
        if options.only not in (None, name):
            continue
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            small_robot.write(folder, options.steps)
            write_targets(program, folder)
            each = Kills(program, words, journal, folder, random.Random(f"{options.seed} {name}"))
            each.run_undisturbed()
            while each.kills < options.kills:
                each.run(options.kills)
            print(f"{name}: {each.kills} kills in {each.runs} runs of {each.seconds:.2f} s, {each.torn} torn last lines; "
                  f"every record kept, {len(each.expected)} files identical to those of an undisturbed run",
                  flush=True)


if __name__ == "__main__":
    main()
