#!/usr/bin/env python3
"""Kills fk --path, follow, walk and workspace with SIGKILL at random instants and resumes them.

After every kill no record that was on disk before may be lost or changed; at the end every file must be that of an
undisturbed run, byte for byte but for the seconds that a report tells. Needs Python alone.
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
    """By name what is run, and where its records are while it goes on: the journal, or the table itself."""
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
    """What follow is to follow: where the path of fk leads the tip."""
    subprocess.run([program, "fk", "bend.yaml", "--path", "path.csv", "--report", "r.json", "--threads", "1"], cwd=folder,
                   check=True, capture_output=True)
    steps = json.loads((folder / "r.json").read_text())["steps"]
    rows = [f"{x!r},{z!r}" for x, _, z in (step["markers"]["tip"] for step in steps)]
    (folder / "targets.csv").write_text("\n".join(["x_mm,z_mm", *rows, ""]))


def start(program, words, folder):
    return subprocess.Popen([program, *words, "--threads", "1"], cwd=folder, stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE)


def finish(program, words, folder):
    process = start(program, words, folder)
    errors = process.communicate()[1].decode()
    if process.returncode != 0:
        sys.exit(f"kill_runs: {' '.join(words)}: exit code {process.returncode}: {errors}")


def files_of(folder):
    """Every file, without the seconds of reports."""
    return {str(path.relative_to(folder)): SECONDS.sub(rb"\1CLOCK", path.read_bytes()) if path.suffix == ".json"
            else path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def records_of(file):
    """The records on disk, the whole lines, and whether a torn one follows. None: there is no such file."""
    if not file.exists():
        return None, False
    lines = file.read_bytes().split(b"\n")
    if file.suffix == ".csv":
        return sorted(line for line in lines[:-1] if line[:1].isdigit()), lines[-1] != b""
    for line in lines[:-1]:
        json.loads(line)
    return lines[1:-1], lines[-1] != b""


class Kills:
    """The kills of one command, in as many runs as it takes."""

    def __init__(self, program, words, journal, folder, generator):
        self.program, self.words, self.journal, self.folder = program, words, journal, folder
        self.generator = generator
        self.kills = self.runs = self.torn = self.kept = 0

    def undisturbed(self):
        folder = self.folder / "undisturbed"
        self.make(folder)
        begin = time.monotonic()
        finish(self.program, self.words, folder)
        self.seconds = time.monotonic() - begin
        self.expected = files_of(folder)

    def make(self, folder):
        for each in sorted(folder.rglob("*"), reverse=True):
            each.rmdir() if each.is_dir() else each.unlink()
        folder.mkdir(exist_ok=True)

    def run(self, most):
        """One run from its beginning, killed until it is done or there were enough kills."""
        folder = self.folder / "killed"
        self.make(folder)
        before, resume = [], []
        while self.kills < most:
            process = start(self.program, self.words + resume, folder)
            time.sleep(self.generator.random() * self.seconds)
            process.send_signal(signal.SIGKILL)
            errors = process.communicate()[1].decode()
            resume = ["--resume"]
            if process.returncode == 0:
                break
            if process.returncode != -signal.SIGKILL:
                sys.exit(f"kill_runs: resumed after a kill: {errors}")
            self.kills += 1
            before = self.check(folder, before)
        finish(self.program, self.words + resume, folder)
        self.compare(files_of(folder))
        self.runs += 1

    def check(self, folder, before):
        """The records on disk after a kill: those before and perhaps more."""
        records, torn = records_of(folder / self.journal)
        self.torn += torn
        if records is None:  # nothing begun, or all of it done: the report is there
            if before and not (folder / self.journal.removesuffix(".run")).exists():
                sys.exit("kill_runs: the records are gone")
            return before
        kept = set(records) >= set(before) if self.journal.endswith(".csv") else records[:len(before)] == before
        if not kept:
            sys.exit(f"kill_runs: {len(before)} records were on disk, {len(records)} are, and they are not those")
        self.kept = max(self.kept, len(records))
        return records

    def compare(self, files):
        for name in sorted(files.keys() | self.expected.keys()):
            if files.get(name) != self.expected.get(name):
                sys.exit(f"kill_runs: after run {self.runs}, {self.kills} kills: {name} is not that of an undisturbed run: "
                         + ("missing" if name not in files else "not expected" if name not in self.expected else "differs"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/softkin")
    parser.add_argument("--kills", type=int, default=100, help="of each command (default: 100)")
    parser.add_argument("--steps", type=int, default=60, help="of the paths; of the workspace ten times as many samples")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="one of the commands: fk --path, follow, walk, workspace")
    asked = parser.parse_args()
    program = os.path.abspath(asked.program)
    for name, (words, journal) in commands(asked.steps).items():
        if asked.only not in (None, name):
            continue
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            small_robot.write(folder, asked.steps)
            write_targets(program, folder)
            each = Kills(program, words, journal, folder, random.Random(f"{asked.seed} {name}"))
            each.undisturbed()
            while each.kills < asked.kills:
                each.run(asked.kills)
            print(f"{name}: {each.kills} kills in {each.runs} runs of {each.seconds:.2f} s, {each.torn} torn last lines; "
                  f"every record kept, {len(each.expected)} files as those of an undisturbed run", flush=True)


if __name__ == "__main__":
    main()
