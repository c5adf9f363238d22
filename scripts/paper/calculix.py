"""Bends the finger of Fig. 9 by CalculiX, if `ccx` is installed: same mesh, supports and moduli, follower loads."""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from meshes import read

FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # P1 to P4 of C3D10
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # nodes 5 to 10
RESIDUAL, CORRECTION = 5e-4, 1e-3  # R_n and C_n; with the default ones, ten times as large, the error is millimetres
CONTROLS = ("*CONTROLS, PARAMETERS=TIME INCREMENTATION\n30, 60, 100, 200, 60, 30, , 20\n"  # follower loads converge linearly
            f"*CONTROLS, PARAMETERS=FIELD\n{RESIDUAL}, {CORRECTION}, , , {RESIDUAL}, , {CORRECTION / 10}")


@dataclass
class Track:
    """The position of the tip after each completed increment."""

    times: list[float]  # 1 at the first pressure, 2 at the second, ...
    tips: list[tuple[float, float, float]]
    seconds: float
    failure: str = ""  # why the run ended before the last pressure

    def tip_after(self, step: int) -> tuple[float, float, float] | None:
        """Returns the tip at the end of a step, of which 1 is the first; None if the run did not complete it."""
        return next((tip for end, tip in zip(self.times, self.tips) if abs(end - step) < 1e-6), None)


def is_installed() -> bool:
    return shutil.which("ccx") is not None


class Deck:
    """An input of ccx: tetrahedra of order 2 with straight edges.

    The units are mm, mN and kPa, since ccx takes a residual below 1e-6 for zero.
    """

    def __init__(self, mesh: Any, fixed: str, body: str, chamber: str) -> None:
        number = {words.split()[2].strip('"'): words.split()[1] for words in mesh.names}
        of = {name: [v for _, group, v in mesh.elements if group == number[name]] for name in (fixed, body, chamber)}
        used = sorted({v for tetrahedron in of[body] for v in tetrahedron})
        self.nodes = {v: n for n, v in enumerate(used, 1)}
        self.places = [mesh.vertices[v] for v in used]
        self.middles: dict[tuple[int, int], int] = {}
        self.elements = [[self.nodes[v] for v in t] + [self.middle(t[a], t[b]) for a, b in EDGES] for t in map(positive(mesh), of[body])]
        edges = [(t[a], t[b]) for t in of[fixed] for a, b in ((0, 1), (1, 2), (2, 0))]
        self.fixed = sorted({self.nodes[v] for t in of[fixed] for v in t} | {self.middle(a, b) for a, b in edges})
        inside = {tuple(sorted(self.nodes.get(t[c], 0) for c in face)) for t in of[chamber] for face in FACES}
        self.walls = [(e, f) for e, nodes in enumerate(self.elements, 1) for f, face in enumerate(FACES, 1)
                      if tuple(sorted(nodes[c] for c in face)) in inside]

    def middle(self, a: int, b: int) -> int:
        """Returns the node in the middle of an edge, and adds it if it is new."""
        edge = (min(a, b), max(a, b))
        if edge not in self.middles:
            p, q = (self.places[self.nodes[v] - 1] for v in edge)
            self.places.append(tuple(0.5 * (x + y) for x, y in zip(p, q)))
            self.middles[edge] = len(self.places)
        return self.middles[edge]

    def nearest(self, point: Sequence[float]) -> int:
        """Returns the node that is nearest to a point."""
        return min(range(len(self.places)), key=lambda n: math.dist(self.places[n], point)) + 1

    def text(self, modulus_mpa: float, poisson: float, pressures: Sequence[float], tip: int) -> str:
        lines = ["*NODE, NSET=ALL", *(f"{n}, {x:.12g}, {y:.12g}, {z:.12g}" for n, (x, y, z) in enumerate(self.places, 1))]
        lines += ["*ELEMENT, TYPE=C3D10, ELSET=BODY"]
        lines += [", ".join(map(str, [e, *nodes])) for e, nodes in enumerate(self.elements, 1)]
        lines += ["*NSET, NSET=HELD", *(f"{n}," for n in self.fixed), "*NSET, NSET=TIP", f"{tip},"]
        lines += ["*MATERIAL, NAME=RUBBER", "*ELASTIC", f"{1000 * modulus_mpa:.12g}, {poisson:.12g}"]
        lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=RUBBER", "*BOUNDARY", "HELD, 1, 3"]
        for pressure in pressures:
            lines += ["*STEP, NLGEOM, INC=10000", "*STATIC", "0.1, 1, 1e-6", CONTROLS]
            lines += ["*DLOAD", *(f"{e}, P{f}, {pressure:.7g}" for e, f in self.walls)]
            lines += ["*NODE PRINT, NSET=TIP, FREQUENCY=1", "U", "*END STEP"]
        return "\n".join(lines) + "\n"


def positive(mesh: Any) -> Any:
    """Returns a function that orders the corners of a tetrahedron so that its volume is positive."""

    def oriented(t: tuple[int, ...]) -> tuple[int, ...]:
        a, b, c, d = (mesh.vertices[v] for v in t)
        u, v, w = ([q - p for p, q in zip(a, end)] for end in (b, c, d))
        volume = sum(u[i] * (v[i - 2] * w[i - 1] - v[i - 1] * w[i - 2]) for i in range(3))
        return t if volume > 0 else (t[0], t[2], t[1], t[3])

    return oriented


def read_tips(file: Path, rest: Sequence[float]) -> tuple[list[float], list[tuple[float, float, float]]]:
    """Reads the times and the positions of the node from a .dat file."""
    times: list[float] = []
    tips: list[tuple[float, float, float]] = []
    for line in file.read_text().splitlines() if file.exists() else []:
        words = line.split()
        if "and time" in line:
            times.append(float(words[-1]))
        elif len(words) == 4 and len(tips) < len(times):
            x, y, z = (float(u) + r for u, r in zip(words[1:], rest))
            tips.append((x, y, z))
    return times[:len(tips)], tips


def bend(mesh_file: Path, folder: Path, pressures: Sequence[float], tip: Sequence[float], modulus_mpa: float, poisson: float,
         limit_s: float) -> Track:
    """Bends the finger of St. Venant-Kirchhoff material from rest to each of the gauge pressures [kPa] in turn.

    The run takes at most limit_s. If ccx has completed the same deck in this folder, the function reads its result.
    """
    folder.mkdir(parents=True, exist_ok=True)
    deck = Deck(read(mesh_file.read_text()), "base", "body", "chamber")
    node = deck.nearest(tip)
    text, completed = deck.text(modulus_mpa, poisson, pressures, node), folder / "track.json"
    if completed.exists() and (folder / "finger.inp").read_text() == text:
        return Track(**json.loads(completed.read_text()))
    for old in [*folder.glob("finger.*"), completed]:
        old.unlink(missing_ok=True)
    (folder / "finger.inp").write_text(text)
    track = run(folder, deck.places[node - 1], len(pressures), limit_s)
    if not track.failure:
        completed.write_text(json.dumps(asdict(track)))
    return track


def run(folder: Path, rest: Sequence[float], steps: int, limit_s: float) -> Track:
    threads = str(os.cpu_count() or 1)
    begin, failure = time.monotonic(), ""
    with (folder / "ccx.log").open("w") as log:
        try:
            done = subprocess.run(["ccx", "-i", "finger"], cwd=folder, stdout=log, stderr=log, timeout=limit_s, check=False,
                                  env={**os.environ, "OMP_NUM_THREADS": threads, "CCX_NPROC_EQUATION_SOLVER": threads})
            failure = "" if done.returncode == 0 else f"exit code {done.returncode}"
        except subprocess.TimeoutExpired:
            failure = f"stopped after {limit_s:.0f} s"
    times, tips = read_tips(folder / "finger.dat", rest)
    if not failure and not (times and abs(times[-1] - steps) < 1e-6):
        failure = "ccx ended before the last pressure"
    return Track(times, tips, time.monotonic() - begin, failure)
