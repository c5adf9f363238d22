"""Evaluates a map that `softkin map export --numpy` wrote, with numpy alone: many commands at once.

    robot = NumpyMap("robot.npz")
    outputs, cells = robot.fk(commands)      # a row per command; NaN where it is outside the map
    points = robot.shape(commands, cells)    # of a map with the robot's shape: x, y, z of each vertex [mm]"""

from pathlib import Path
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[Any]]


class NumpyMap:
    def __init__(self, path: str | Path) -> None:
        with np.load(path) as arrays:
            self.a: dict[str, Array] = dict(arrays)

    def sums(self, cells: Array, commands: Array, size: int, what: str = "") -> Array:
        found = np.full((len(commands), size), np.nan)
        for cell in np.unique(cells[cells >= 0]):
            inputs, low, high = (self.a[f"cell{cell}_{name}"] for name in ("inputs", "low", "high"))
            x, terms = (2 * commands[cells == cell][:, inputs] - low - high) / (high - low), np.ones(1)
            for j, degrees in enumerate(self.a[f"cell{cell}{what}_degrees"].T):
                terms = terms * np.polynomial.chebyshev.chebvander(x[:, j], degrees.max())[:, degrees]
            found[cells == cell] = terms @ self.a[f"cell{cell}{what}_coefficients"]
        return found

    def cells(self, taut: Array, commands: Array) -> Array:
        node = self.a["roots"][taut]
        while ((tree := self.a["tree"][node])[:, 0] >= 0).any():
            below = np.take_along_axis(commands, tree[:, :1].astype(int), 1)[:, 0] < tree[:, 1]
            node = np.where(tree[:, 0] < 0, node, np.where(below, tree[:, 2], tree[:, 3])).astype(int)
        return tree[:, 4].astype(int)

    def fk(self, commands: Array) -> tuple[Array, Array]:
        a, cables = self.a, np.arange(len(self.a["cable_inputs"]))
        asked = np.where(a["cable_inputs"] < 0, a["cable_commands"], commands[:, a["cable_inputs"]])
        taut = np.full(len(commands), 2 ** len(cables) - 1)
        inside = ((commands >= a["low"]) & (commands <= a["high"])).all(axis=1)
        cells = np.where(inside, self.cells(taut, commands), -1)
        outputs = self.sums(cells, commands, len(a["outputs"]))
        for change in range(4 * len(cables) + 1):  # cables that would push go slack, ones too long are taken up
            pull = (taut[:, None] >> cables & 1).astype(bool)
            by = np.where(pull, -outputs[:, a["cable_tensions"]], outputs[:, a["cable_ratios"]] - asked * (1 + 1e-12))
            accuracy = a["accuracy"][np.where(pull, a["cable_tensions"], a["cable_ratios"])]
            ends = a["roots"][taut[:, None] ^ 1 << cables] < 0
            by -= accuracy * (ends | (change >= 2 * len(cables)))  # no piece, or circles: less than that is not wrong
            by[((by > 0) & pull).any(axis=1)[:, None] & ~pull] = 0  # pushing ones first
            wrong = (by > 0).any(axis=1)
            if not wrong.any() or change == 4 * len(cables):
                break
            taut[wrong] ^= 1 << by[wrong].argmax(axis=1)
            cells[wrong] = self.cells(taut[wrong], commands[wrong])
            outputs[wrong] = self.sums(cells[wrong], commands[wrong], len(a["outputs"]))
        outputs[wrong], cells[wrong] = np.nan, -1
        return outputs, cells

    def shape(self, commands: Array, cells: Array) -> Array:
        amplitudes = self.sums(cells, commands, len(self.a["shape_units"]), "_mode") * self.a["shape_units"]
        return np.asarray(self.a["shape_mean"] + np.tensordot(amplitudes, self.a["shape_modes"], 1))
