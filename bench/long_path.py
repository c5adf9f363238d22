#!/usr/bin/env python3
"""Measures the cost of a row of fk --path as the number of rows grows, on a robot of 12 tetrahedra.

The script prints the processor time per row in the first and the last tenth of the rows that the program prints, the
time after the last row, and the peak of memory; with the report alone, with a plot, and with the shapes of a series.
It needs Linux and Python.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True
import small_robot

FORMS = {"report": ["--report", "r.json"], "report and plot": ["--report", "r.json", "--plot", "p.svg"],
         "report and shapes": ["--report", "r.json", "-o", "s.pvd"]}


def processor_seconds(process):
    """Returns the processor time of a process until now [s]."""
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def watch(process, peaks):
    """Appends the peak of memory of a process [kiB] until it ends.

    The peak of wait4 would include that of the Python process from which it is forked.
    """
    while found := re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{process.pid}/status").read_text()):
        peaks.append(int(found[1]))
        time.sleep(0.02)


def measure(program, rows, options, folder):
    """Returns seconds per row of the first and last tenth, seconds after it, peak memory [MiB], wall time [s]."""
    small_robot.write(folder, rows)
    words = [program, "fk", "bend.yaml", "--path", "path.csv", "--threads", "1", *options]
    begin = time.monotonic()
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.PIPE, pipesize=4096)
    marks, count, peaks = {}, 0, []
    watcher = threading.Thread(target=watch, args=(process, peaks))
    watcher.start()
    for line in process.stdout:
        if line.split()[:1] == [str(count).encode()]:
            count += 1
            if count in (1, rows // 10, rows - rows // 10, rows):
                marks[count] = processor_seconds(process)
    watcher.join()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0 or count != rows:
        sys.exit(f"long_path: {' '.join(words)}: status {status} after {count} of {rows} rows")
    end = usage.ru_utime + usage.ru_stime
    first, last = marks[rows // 10] - marks[1], marks[rows] - marks[rows - rows // 10]
    return (first / (rows // 10 - 1), last / (rows // 10), end - marks[rows], max(peaks) / 1024,
            time.monotonic() - begin)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", default="build/softkin")
    parser.add_argument("--rows", default="10000,100000", help="numbers of rows (default: 10000,100000)")
    parser.add_argument("--forms", default=",".join(FORMS), help="outputs, of " + ", ".join(FORMS))
    options = parser.parse_args()
    print(f"{'rows':>8} {'form':18} {'first [ms]':>10} {'last [ms]':>10} {'ratio':>6} {'end [s]':>8} {'clock [s]':>9} {'MiB':>7}")
    for form in options.forms.split(","):
        for rows in map(int, options.rows.split(",")):
            with tempfile.TemporaryDirectory() as folder:
                first, last, end, memory, seconds = measure(os.path.abspath(options.program), rows, FORMS[form],
                                                            pathlib.Path(folder))
            print(f"{rows:8} {form:18} {1e3 * first:10.3f} {1e3 * last:10.3f} {last / first if first else float('nan'):6.2f} {end:8.1f} "
                  f"{seconds:9.1f} {memory:7.1f}", flush=True)


if __name__ == "__main__":
    main()
