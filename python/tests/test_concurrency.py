from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from beams import beam

import softkin

RATIOS = [1.05 + 0.02 * i for i in range(16)]


def solve(robot: softkin.Robot, ratio: float) -> softkin.Shape:
    return robot.solve(air1=ratio)


def test_threads_with_one_robot_give_the_serial_results(robot: softkin.Robot) -> None:
    serial = [solve(robot, ratio).fingerprint for ratio in RATIOS]
    with ThreadPoolExecutor(8) as pool:
        shared = [shape.fingerprint for shape in pool.map(lambda ratio: solve(robot, ratio), RATIOS * 2)]
    assert shared == serial * 2


def test_process_pools(robot: softkin.Robot) -> None:
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        found = list(pool.map(solve, [robot] * 3, RATIOS[:3]))
    assert [shape.fingerprint for shape in found] == [solve(robot, ratio).fingerprint for ratio in RATIOS[:3]]


def test_the_gil_is_free_while_it_solves() -> None:
    big = beam(46, 13)
    ticks: list[float] = []
    with ThreadPoolExecutor(1) as pool:
        working = pool.submit(big.solve, air1=1.5, air2=1.2)
        while not working.done():
            ticks.append(time.perf_counter())
            time.sleep(0.001)
    assert working.result().converged
    assert max(np.diff(ticks)) < 0.5 * (ticks[-1] - ticks[0])


INTERRUPTED = """
import sys, threading, time
sys.path.insert(0, {tests!r})
from beams import beam
import numpy as np, os, signal, softkin
signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background of a shell begins without it
{prepare}
sent = []
def send():
    time.sleep({after})
    sent.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=send, daemon=True).start()
try:
    {work}
except KeyboardInterrupt:
    print("interrupted", time.perf_counter() - sent[0])
else:
    print("not interrupted")
print("usable", robot.solve(air1=1.01).converged)
"""

WORK = {
    "solve": ("robot = beam(46, 13)", "robot.solve(air1=1.9, air2=1.1)"),
    "workspace": ("robot = beam(15, 5)", "robot.workspace(3375, solver=softkin.Solver(threads=2))"),
    "follow": (
        "robot = beam(15, 5)\n"
        "a, b = robot.solve(air1=1.2)['tip'], robot.solve(air1=1.6)['tip']\n"
        "path = np.linspace(a, b, 3000)",
        "list(robot.follow(path))",
    ),
    "inverse": ("robot = beam(46, 13)", "robot.inverse(tip=(60, 12, 12))"),
    "map": ("robot = beam(15, 5)", "robot.map(accuracy_mm=1e-7, solver=softkin.Solver(threads=2))"),
    "map that answers": ("robot = beam(4, 5)\nmade = robot.map(checks=1)", "made.solve(np.full((4 * 10**6, 3), 1.5))"),
}


@pytest.mark.parametrize("what", WORK)
def test_ctrl_c(what: str, patience: float) -> None:
    prepare, work = WORK[what]
    code = INTERRUPTED.format(tests=str(Path(__file__).parent), prepare=prepare, work=work, after=0.2)
    call = [sys.executable, "-W", "ignore", "-c", code]
    done = subprocess.run(call, capture_output=True, text=True, timeout=120 * patience)
    assert done.returncode == 0, done.stderr
    words = done.stdout.split()
    assert words[0] == "interrupted" and words[-1] == "True", done.stdout
    print(f"{what}: {1e3 * float(words[1]):.0f} ms")
    assert float(words[1]) < 0.3 * patience


def resident_kib() -> int:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    raise AssertionError("no VmRSS")


@pytest.mark.skipif(not os.path.exists("/proc/self/status"), reason="the system does not report memory use")
def test_memory_does_not_grow() -> None:
    small = beam(4, 5)
    session = small.session()
    last = None

    def work(count: int) -> None:
        nonlocal last
        for i in range(count):
            last = session.solve(air1=1.2 + 0.01 * (i % 5))
            last.positions, last["tip"], last.actuators
            if i % 50 == 0:
                small.solve(air1=1.1)
                last.report

    work(300)
    before = resident_kib()
    work(1500)
    assert resident_kib() - before < 4096


def test_signals_of_the_user_are_handled() -> None:
    called: list[int] = []
    big = beam(32, 14)
    before = signal.signal(signal.SIGALRM, lambda number, _: called.append(number))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.02)
        assert big.solve(air1=1.5, air2=1.2).converged
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert called == [signal.SIGALRM]
