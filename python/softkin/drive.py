"""Commands to hardware: moves of stepper motors, pressures over time, and the link to a Marlin board."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import floats
from ._compiled import Compiled
from ._core import InvalidInput
from ._files import PathLike, optional
from ._kinds import named_file
from ._of_robot import parsed
from .runs import FollowRun, times_of

__all__ = ["Marlin", "Plan", "Sent", "plan"]


class Plan:
    """Motor moves and chamber pressures, checked against all limits of the hardware."""

    def __init__(self, core: _core.Plan) -> None:
        self._core = core

    @property
    def gcode(self) -> str:
        """The moves of tendons and plungers for Marlin, as a file; '' where there is none."""
        return self._core.gcode if self._core.has_motors else ""

    @property
    def schedule(self) -> str:
        """The regulators' gauge pressures over time, as a CSV file: t_s, air_kPa; '' where there is none."""
        return self._core.schedule if self._core.has_chambers else ""

    @property
    def lines(self) -> int:
        """Of G-code."""
        return self._core.lines

    @property
    def seconds(self) -> float:
        """Of the motors' moves, after the approach [s]."""
        return self._core.seconds

    @property
    def defaults(self) -> list[str]:
        """Entries that the hardware file lacks, with the default values that are used."""
        return self._core.defaults

    @property
    def report(self) -> dict[str, Any]:
        """What `softkin drive --dry-run --json` prints."""
        return parsed(self._core.json())

    def __repr__(self) -> str:
        return f"<softkin.drive.Plan: {self.lines} lines of G-code, {self.seconds:.4g} s>"


class Sent:
    """How a plan was sent. Lines are those of the program, from 1."""

    def __init__(self, core: _core.Sent) -> None:
        self._core = core

    @property
    def end(self) -> str:
        """'finished', 'stopped', 'quick stopped', 'rebooted', 'halted', 'no answer', 'wrong position', 'port lost'."""
        return self._core.end

    @property
    def finished(self) -> bool:
        """Was everything executed, and does the board stand where it should?"""
        return self._core.finished

    @property
    def message(self) -> str:
        return self._core.message

    @property
    def lines(self) -> int:
        return self._core.lines

    @property
    def acknowledged(self) -> int:
        """Lines up to this one were accepted by the board."""
        return self._core.acknowledged

    @property
    def sent(self) -> int:
        """Lines up to this one perhaps."""
        return self._core.sent

    @property
    def resends(self) -> int:
        return self._core.resends

    @property
    def timeouts(self) -> int:
        return self._core.timeouts

    @property
    def position_mm(self) -> dict[str, float] | None:
        """By axis, where the motors stand; None: not known."""
        return dict(self._core.position) if self._core.position_known else None

    def __repr__(self) -> str:
        return f"<softkin.drive.Sent {self.end}: {self.acknowledged} of {self.lines} lines; {self.message}>"


class Marlin:
    """The link to a board with Marlin at a serial port; a context manager.

    with softkin.drive.Marlin("/dev/ttyUSB0") as board:
        sent = board.send(plan)
    """

    def __init__(self, port: PathLike, *, baud: int = 115200, boot_wait_s: float = 3) -> None:
        """Opens the port.

        baud         many boards have 250000
        boot_wait_s  before the first line [s]: many boards boot when their port is opened
        raises       InvalidInput where it cannot be opened, is no serial port, or is in use
        """
        self._core = _core.Link(os.fspath(port), baud, boot_wait_s)

    def send(self, plan: Plan, *, log: PathLike | None = None, progress: Callable[[int], object] | None = None) -> Sent:
        """Sends a plan's moves and waits until they are made. The returned object reports a
        fault of board, line or port.

        Ctrl-C stops after the moves that the board has, a second one at once; KeyboardInterrupt is raised then, and
        `last` contains the positions of the motors.

        log       file of every line sent and received, with its time
        progress  called with the lines that were acknowledged
        """
        if plan.lines == 0:
            raise InvalidInput("plan has no moves of motors: there is no tendon and no syringe")
        return Sent(self._core.send(plan._core, optional(log), progress))

    @property
    def last(self) -> Sent | None:
        """How the last plan was sent."""
        last = self._core.last
        return None if last is None else Sent(last)

    def pause(self) -> None:
        """From another thread: no more lines are sent, the board ends the moves that it has."""
        self._core.pause()

    def go_on(self) -> None:
        """After a pause."""
        self._core.go_on()

    def stop(self) -> None:
        """From another thread: the board ends the moves that it has, and `send` returns."""
        self._core.stop()

    def quick_stop(self) -> None:
        """From another thread: at once, in the middle of a move."""
        self._core.quick_stop()

    def close(self) -> None:
        self._core.close()

    def __enter__(self) -> Marlin:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def plan(
    robot: Compiled,
    commands: PathLike | FollowRun | ArrayLike,
    *,
    hardware: PathLike | None = None,
    times: ArrayLike | None = None,
    pressures: PathLike | Mapping[str, ArrayLike] | None = None,
    return_home: bool = False,
) -> Plan:
    """Moves and pressures for commands, checked against all limits.

    commands   a CSV file (what `softkin follow` writes), a FollowRun, or (k, m) in the order of `robot.actuators`
    hardware   motors, syringes and regulators (docs/drive.md); None: beside the robot's scene, finger.hardware.yaml of
               finger.yaml
    times      (k,) of an array of commands [s], ascending; without, motors go at the hardware's approach speed
    pressures  of chambers that are commanded by volume: the report of the run that made the commands, a measured
               table of coupled chambers (.csv; docs/pressure.md), or by actuator (k,) gauge [kPa]; what they lack is
               of measured curves, where there are any
    raises     InvalidInput naming row, tendon, syringe or chamber, value and limit
    """
    board = Path(robot.name).with_suffix(".hardware.yaml") if hardware is None else Path(hardware)
    if hardware is None and not board.exists():
        raise InvalidInput(f"hardware: there is no {board}; describe motors and regulators there (docs/drive.md)")
    if isinstance(commands, (str, os.PathLike)):
        named_file("commands", commands)
        if times is not None:
            raise InvalidInput("times: a file of commands has its own, in column t_s")
        if isinstance(pressures, Mapping):
            raise InvalidInput("pressures: of a file of commands they come from a report or a table")
        core = _core.Plan.of_file(robot._core, os.fspath(commands), optional(pressures), os.fspath(board), return_home)
        return Plan(core)
    given: dict[str, Any] = {}
    if isinstance(commands, FollowRun):
        steps = commands.report["steps"]
        commands = [[step["actuators"][name]["requested"] for name in robot.actuators] for step in steps]
        if steps and steps[0].get("time_s") is not None:
            times = [step["time_s"] for step in steps]
        for info in robot.actuator_infos:
            state = steps[0]["actuators"][info.name] if steps else {}
            # a measured curve comes before the model, and the plan takes its pressures itself
            if info.kind == "pneumatic" and "pressure_kPa" in state and "curve_pressure_kPa" not in state:
                given[info.name] = [step["actuators"][info.name]["pressure_kPa"] for step in steps]
    rows = floats("commands", commands, (None, len(robot.actuators)))
    if isinstance(pressures, Mapping):
        given.update(pressures)
    elif pressures is not None:
        raise InvalidInput("pressures: of an array of commands they are arrays by actuator")
    table = np.full(rows.shape, np.nan)
    for name, values in given.items():
        table[:, robot._place(name)] = floats(f"pressures: {name}", values, (len(rows),))
    core = _core.Plan.of_rows(
        robot._core, rows, times_of(times, len(rows)), table if given else None, os.fspath(board), return_home
    )
    return Plan(core)
