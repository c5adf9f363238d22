#!/usr/bin/env python3
"""What a row of fk --path costs as rows become many, on a robot of 12 tetrahedra.

Measures processor time per row in the first and the last tenth, as rows come out of the program, what comes after the
last row, and the peak of its memory; with the report alone, with a plot, with the shapes of a series. Needs Linux and Python.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
import small_robot

FORMS = {"report": ["--report", "r.json"], "report and plot": ["--report", "r.json", "--plot", "p.svg"],
         "report and shapes": ["--report", "r.json", "-o", "s.pvd"]}


def processor_seconds(process):
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure(program, rows, options, folder):
    """Seconds per row of the first and the last tenth, after the last row, peak of memory [MiB], seconds of the clock."""
    small_robot.write(folder, rows)
    words = [program, "fk", "bend.yaml", "--path", "path.csv", "--threads", "1", *options]
    begin = time.monotonic()
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, pipesize=4096)
    marks, at = {}, 0
    for line in process.stdout:
        if line.split()[:1] == [str(at).encode()]:
            at += 1
            if at in (1, rows // 10, rows - rows // 10, rows):
                marks[at] = processor_seconds(process)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0 or at != rows:
        sys.exit(f"long_path: {' '.join(words)}: status {status} after {at} of {rows} rows")
    end = usage.ru_utime + usage.ru_stime
    first, last = marks[rows // 10] - marks[1], marks[rows] - marks[rows - rows // 10]
    return first / (rows // 10 - 1), last / (rows // 10), end - marks[rows], usage.ru_maxrss / 1024, time.monotonic() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/softkin")
    parser.add_argument("--rows", default="10000,100000", help="default: 10000,100000")
    parser.add_argument("--forms", default=",".join(FORMS), help="of " + ", ".join(FORMS))
    asked = parser.parse_args()
    print(f"{'rows':>8} {'form':18} {'first [ms]':>10} {'last [ms]':>10} {'ratio':>6} {'end [s]':>8} {'clock [s]':>9} {'MiB':>7}")
    for form in asked.forms.split(","):
        for rows in map(int, asked.rows.split(",")):
            with tempfile.TemporaryDirectory() as folder:
                first, last, end, memory, seconds = measure(os.path.abspath(asked.program), rows, FORMS[form],
                                                            pathlib.Path(folder))
            print(f"{rows:8} {form:18} {1e3 * first:10.3f} {1e3 * last:10.3f} {last / first:6.2f} {end:8.1f} "
                  f"{seconds:9.1f} {memory:7.1f}", flush=True)


if __name__ == "__main__":
    main()
