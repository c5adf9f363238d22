from __future__ import annotations

import json
import os
import pty
import re
import subprocess
import threading
import time
import tty
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import softkin
from softkin import drive

SCENE = "three_tendon_finger/three_tendon_finger.yaml"


class Board:
    """What a Marlin board answers, at the other end of a pseudo terminal."""

    def __init__(self, delay_s: float = 0) -> None:
        self.controller, self.device = pty.openpty()
        tty.setraw(self.device)
        self.port = os.ttyname(self.device)
        self.position: dict[str, float] = {}
        self.executed: list[str] = []
        self.delay_s = delay_s
        self.server = threading.Thread(target=self.serve, daemon=True)
        self.server.start()

    def serve(self) -> None:
        pending = b""
        while True:
            try:
                pending += os.read(self.controller, 4096)
            except OSError:
                return
            *lines, pending = pending.split(b"\n")
            for line in filter(None, lines):  # Marlin passes over empty ones
                os.write(self.controller, (self.answer(line.decode()) + "\n").encode())

    def answer(self, line: str) -> str:
        text = re.sub(r"^N\d+ ", "", line.split("*")[0])
        self.executed.append(text)
        if text.startswith(("G1", "G92")):
            time.sleep(self.delay_s)
            self.position.update({axis: float(value) for axis, value in re.findall(r"([XYZ])(-?[\d.]+)", text)})
        if text.startswith("M114"):
            return " ".join(f"{axis}:{value:.4f}" for axis, value in self.position.items()) + " Count X:0\nok"
        return "ok"

    def close(self) -> None:
        os.close(self.device)  # the last one that was open: it ends what the server reads
        self.server.join(timeout=10)
        assert not self.server.is_alive(), "it would read from the next board, which gets its descriptor's number"
        os.close(self.controller)


@pytest.fixture(scope="module")
def finger(examples: Path) -> softkin.Robot:
    return softkin.load(examples / SCENE)


@pytest.fixture
def board() -> Iterator[Board]:
    made = Board()
    yield made
    made.close()


@pytest.fixture(scope="module")
def short(finger: softkin.Robot) -> drive.Plan:
    return drive.plan(finger, [[1, 1, 1], [0.99, 1, 1], [0.98, 1, 0.99]], times=[0, 1, 2], return_home=True)


def test_plan_is_the_command_s(finger: softkin.Robot, examples: Path, command: str) -> None:
    path = examples / "three_tendon_finger/path.csv"
    plan = drive.plan(finger, path)
    arguments = [command, "drive", finger.name, str(path), "--dry-run", "--json"]
    reported = subprocess.run(arguments, check=True, capture_output=True, text=True)
    assert plan.report == json.loads(reported.stdout)
    assert plan.gcode == plan.report["gcode"] and plan.schedule == "" and plan.lines == plan.report["lines"]
    assert plan.seconds > 0 and plan.defaults == plan.report["defaults"] and "G-code" in repr(plan)


def test_plan_of_a_run(finger: softkin.Robot) -> None:
    run = finger.follow([finger.solve(tendon1=0.99)["tip"]], marker="tip")
    list(run)
    assert drive.plan(finger, run).lines > 0


def test_wrong_plans(finger: softkin.Robot, robot: softkin.Robot, tmp_path: Path) -> None:
    with pytest.raises(softkin.InvalidInput, match="tendon1"):
        drive.plan(finger, [[1, 1, 1], [0.7, 1, 1]], times=[0, 0.01])
    with pytest.raises(ValueError, match=r"commands must have shape \(n, 3\)"):
        drive.plan(finger, [[1, 1]])
    with pytest.raises(ValueError, match="hardware: there is no beam.hardware.yaml"):
        drive.plan(robot, [[1, 1, 1]])
    hardware = tmp_path / "h.yaml"
    hardware.write_text("softkin_hardware: 1\nchambers:\n" + "".join(f"  - {{actuator: air{i}}}\n" for i in (1, 2, 3)))
    with pytest.raises(softkin.InvalidInput, match="pressure"):
        drive.plan(robot, [[1, 1, 1]], times=[0], hardware=hardware)
    plan = drive.plan(
        robot, np.ones((2, 3)), times=[0, 1], hardware=hardware, pressures={f"air{i}": [0, 1] for i in (1, 2, 3)}
    )
    assert plan.schedule.startswith("t_s,air1_kPa") and plan.gcode == "" and plan.lines == 0


def test_syringes(examples: Path, tmp_path: Path) -> None:
    robot = softkin.load(examples / "three_chamber_actuator/measured/actuator.yaml")  # air1 has a curve
    hardware = tmp_path / "h.yaml"
    hardware.write_text(
        "softkin_hardware: 1\nsyringes:\n"
        + "".join(
            f"  - {{actuator: air{i}, axis: {axis}, syringe_mL: 60, dead_volume_mL: 1.5, mL_per_mm: 0.66, "
            "max_speed_mm_per_s: 10}\n"
            for i, axis in ((1, "X"), (2, "Y"), (3, "Z"))
        )
    )
    commands = [[1, 1, 1], [1.1, 1, 1.05], [1.2, 1, 1.1]]
    pressures = {"air2": [0, 0, 0], "air3": [0, 20, 40]}
    plan = drive.plan(robot, commands, times=[0, 8, 16], hardware=hardware, pressures=pressures)
    reported = {name: syringe["rows"] for name, syringe in plan.report["syringes"].items()}
    assert [row["pressure_kPa"] for row in reported["air3"]] == [0, 20, 40]
    for row, (ratio, gauge) in zip(reported["air3"], ((1, 0), (1.05, 20), (1.1, 40))):
        air = (21.1046927 + 61.5) * 100 / (100 + gauge)
        assert row["plunger_mm"] == pytest.approx((ratio * 21.1046927 + 61.5 - air) / 0.66, abs=0.51 / 80)
        assert row["leads_to"] == pytest.approx(ratio, abs=1e-3)
    given = robot.solve(air1=1.1).report["steps"][0]["actuators"]["air1"]["curve_pressure_kPa"]
    assert reported["air1"][1]["pressure_kPa"] == pytest.approx(given, abs=1e-6)
    assert plan.lines == 2 and plan.gcode.count("\nG1 X") == 2 and plan.schedule == ""
    with pytest.raises(softkin.InvalidInput, match="the commands:2: chamber 'air1': the loading branch"):
        shut = {"air2": [0, 0], "air3": [0, 0]}
        drive.plan(robot, [[1, 1, 1], [1.5, 1, 1]], times=[0, 9], hardware=hardware, pressures=shut)


def test_send(short: drive.Plan, board: Board, tmp_path: Path) -> None:
    counts: list[int] = []
    with drive.Marlin(board.port, boot_wait_s=0) as link:
        assert link.last is None
        sent = link.send(short, log=tmp_path / "log", progress=counts.append)
        assert link.last is not None and link.last.end == "finished"
    assert sent.finished and sent.end == "finished" and sent.message and "finished" in repr(sent)
    assert sent.acknowledged == sent.sent == sent.lines == short.lines and counts[-1] == sent.lines
    assert sent.resends == sent.timeouts == 0
    assert sent.position_mm is not None and sent.position_mm["X"] == pytest.approx(board.position["X"])
    assert any(line.startswith("G1") for line in board.executed) and (tmp_path / "log").stat().st_size > 100
    with pytest.raises(softkin.InvalidInput, match="closed"):
        link.send(short)


def test_orders_from_another_thread(finger: softkin.Robot) -> None:
    board = Board(delay_s=0.02)

    def at(lines: int, order: Callable[[], None]) -> None:
        """Gives it when so many more lines than now have been executed."""
        from_now = lines + len(board.executed)

        def wait() -> None:
            while len(board.executed) < from_now:
                time.sleep(0.001)
            order()

        threading.Thread(target=wait, daemon=True).start()

    # to and fro, as lines that go on in one direction are one; so many that orders on a busy machine do not come too late
    plan = drive.plan(finger, [[1 - 0.002 * (i % 2), 1, 1] for i in range(200)], times=[0.2 * i for i in range(200)])
    assert plan.lines >= 150
    with drive.Marlin(board.port, boot_wait_s=0) as link:

        def pause_a_while() -> None:
            link.pause()
            time.sleep(0.1)
            link.go_on()

        at(15, pause_a_while)
        at(30, link.stop)
        sent = link.send(plan)
        assert sent.end == "stopped" and 0 < sent.acknowledged < sent.lines
        at(15, link.quick_stop)
        assert link.send(plan).end == "quick stopped"

        def give(*orders: Callable[[], None]) -> None:
            for order in orders:
                order()

        at(15, lambda: give(link.pause, link.stop, link.go_on, link.pause))
        assert link.send(plan).end == "stopped", "what pauses or goes on takes no stop back"
        at(15, lambda: give(link.stop, link.quick_stop, link.stop, link.go_on))
        assert link.send(plan).end == "quick stopped"
        link.close()
    board.close()


def test_no_port() -> None:
    with pytest.raises(softkin.InvalidInput, match="no_such_port"):
        drive.Marlin("/dev/no_such_port")
