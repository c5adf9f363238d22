"""What Python costs around a warm solve, and warm inverse kinematics per second, on a beam of about 2000 tetrahedra.

A warm solve is measured in pairs: the time of the call from Python, and within it that of the C++ solve, which the
shape tells. One thread unless asked otherwise, so that a busy machine disturbs both alike.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
import warnings
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from beams import beam  # noqa: E402

import softkin  # noqa: E402


def overhead(robot: softkin.Robot, repeats: int, solver: softkin.Solver) -> None:
    """Call minus C++ solve, median over warm solves along a slow ramp."""
    session = robot.session()
    session.solve(air1=1.3, solver=solver)
    calls, solves = [], []
    for i in range(repeats):
        ratio = 1.3 + 0.05 * math.sin(i / 20)
        begin = time.perf_counter()
        shape = session.solve(air1=ratio, solver=solver)
        calls.append(time.perf_counter() - begin)
        solves.append(shape.seconds)
        assert shape.converged
    differences = 1e6 * (np.array(calls) - np.array(solves))
    low, middle, high = np.percentile(differences, [10, 50, 90])
    print(f"warm solve: {1e3 * np.median(calls):.3f} ms from Python, {1e3 * np.median(solves):.3f} ms of it in C++")
    print(f"Python costs {middle:.1f} us more (10 % below {low:.1f}, 90 % below {high:.1f}; {repeats} pairs)")


def inverse(robot: softkin.Robot, updates: int, solver: softkin.Solver, step_mm: float) -> None:
    """A target that moves along a closed curve inside the reach, as in bench_inverse --mode drag."""
    session = robot.session()
    curve = []
    for i in range(48):
        phases = 2 * np.pi * (i / 48 + np.arange(3) / 3)
        curve.append(session.solve(1 + 0.35 + 0.25 * np.cos(phases), solver=solver).require()["tip"])
    session.solve(1 + 0.35 + 0.25 * np.cos(2 * np.pi * np.arange(3) / 3), solver=solver)
    at, following, reached, equilibria = curve[0].copy(), 1, 0, 0
    times, solves = [], []
    for _ in range(updates):
        left = step_mm
        while np.linalg.norm(curve[following] - at) < left:
            left -= float(np.linalg.norm(curve[following] - at))
            at, following = curve[following].copy(), (following + 1) % len(curve)
        at += left * (curve[following] - at) / np.linalg.norm(curve[following] - at)
        begin = time.perf_counter()
        answer = session.inverse(tip=at, solver=solver)
        times.append(time.perf_counter() - begin)
        solves.append(answer.seconds)
        reached += answer.reached
        equilibria += answer.equilibria
    print(
        f"warm inverse: {updates / sum(times):.0f} per second (median {1 / np.median(times):.0f}), target moves "
        f"{step_mm:g} mm per update; {reached} of {updates} reached, {equilibria / updates:.2f} equilibria each; "
        f"Python costs {1e6 * np.median(np.array(times) - np.array(solves)):.1f} us more than C++ (in pairs)"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=1000)
    parser.add_argument("--updates", type=int, default=300)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--step", type=float, default=0.5, help="of the target per update [mm]")
    options = parser.parse_args()
    warnings.simplefilter("ignore", softkin.SoftkinWarning)
    robot = beam(15, 5)
    print(repr(robot))
    solver = softkin.Solver(threads=options.threads)
    overhead(robot, options.repeats, solver)
    inverse(robot, options.updates, solver, options.step)


if __name__ == "__main__":
    main()
