"""Answers of a kinematic map per second on one core, of a beam with three chambers: forward kinematics of many commands
at once, with and without Jacobians; and what one call costs."""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from beams import beam  # noqa: E402

import softkin  # noqa: E402


def median_of(repeats: int, work: Callable[[], object]) -> float:
    """[s]"""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    print(f"  median {np.median(times):.4g} s, best {min(times):.4g} s of {repeats}")
    return float(np.median(times))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", help="a .skmap; a beam's is made where none is given")
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    warnings.simplefilter("ignore", softkin.SoftkinWarning)
    made = softkin.load_map(options.map) if options.map else beam(4, 5).map(checks=20)
    print(repr(made))
    low, high = made.ranges.T
    commands = low + (high - low) * np.random.default_rng(1).random((options.rows, len(low)))
    for jacobian in (False, True):
        what = "with Jacobians" if jacobian else "without"
        print(f"{len(low)} inputs, {len(made.outputs)} outputs, {what}, {options.rows} rows:")
        asked = partial(made.solve, commands, jacobian=jacobian, threads=options.threads, outside="leave out")
        seconds = median_of(options.repeats, asked)
        print(f"  {options.rows / seconds:,.0f} per second")
    few = commands[: min(5000, options.rows)]
    for jacobian in (False, True):
        seconds = median_of(options.repeats, lambda: [made.solve(row, jacobian=jacobian) for row in few])
        print(f"one call {'with' if jacobian else 'without'} Jacobian: {1e6 * seconds / len(few):.1f} us")


if __name__ == "__main__":
    main()
