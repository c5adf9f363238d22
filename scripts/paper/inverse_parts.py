"""Sections V-B, V-C and VI: inverse kinematics, paths, workspaces, Figs. 12 to 17."""

from __future__ import annotations

import csv
import subprocess
from pathlib import Path

from plots import Curve, plot
from rows import Bench, example

SHAPES = ("--formulation", "target-shape")
ROBOT = "ours, of 120 x 25 x 25 mm and three tendons"


def table(file: Path) -> dict[str, list[float]]:
    """Columns of numbers."""
    rows = list(csv.DictReader(file.read_text().splitlines()))
    return {name: [float(row[name]) for row in rows] for name in rows[0] if rows[0][name].replace(".", "").lstrip("-")[:1].isdigit()}


def workspace(bench: Bench) -> None:
    file = bench.folder / "workspace.csv"
    told = bench.report("workspace", example("three_tendon_finger"), *SHAPES, "--samples", 125, "-o", file, "--plot",
                        bench.picture("workspace.svg"), "--force-overwrite")
    x, z = told["reach_mm"]["x"], told["reach_mm"]["z"]
    bench.row("Fig. 12(b)", "125 samples in 8.3 s", f"{told['converged']} in {told['seconds']:.1f} s", "agrees", conditions=ROBOT)
    bench.row("Fig. 12(b), extent", "drawn", f"{x[1] - x[0]:.1f} x {z[1] - z[0]:.1f} mm", "differs", "another finger",
              figure=x[1] - x[0], tolerance=1e-3)
    each = told["seconds"] / told["samples"]
    bench.row("V-B, 3375 samples", "more than 5 min", f"{each * 3375:.0f} s at the pace of the 125", "differs",
              "Newton's method, groups of neighbours, another machine", conditions=ROBOT)


def starts(bench: Bench) -> None:
    """Fig. 12(c): the objective over the iterations from several starts."""
    target = ("--target", "tip=80,,70")
    curves, counts = [], []
    for method, options in (("gradient", ("--method", "gradient", "--descents", "200")), ("newton", ())):
        for name, start in (("rest", 1.0), ("0.85", 0.85), ("0.7", 0.7)):
            begin = [word for i in (1, 2, 3) for word in ("--start", f"tendon{i}={start}")]
            told = bench.report("ik", example("three_tendon_finger"), *SHAPES, *target, *options, *begin, codes=(0, 1))["ik"]
            errors = [e for e in told["history"]["error_mm"] if e > 0]
            curves.append(Curve(f"{method}, {name}", list(range(1, len(errors) + 1)), [e * e for e in errors]))
            counts.append((method, name, told["iterations"], told["reached"]))
    plot(bench.picture("convergence.svg"), curves, "iteration", "J [mm^2]", log="y")
    by = {method: [n for m, _, n, _ in counts if m == method] for method in ("gradient", "newton")}
    bench.row("Fig. 12(c)", "a start near the goal converges much faster", f"Algorithm 2: {min(by['gradient'])} to "
              f"{max(by['gradient'])} iterations from three starts, Gauss-Newton {min(by['newton'])} to {max(by['newton'])}",
              "agrees", conditions=f"{ROBOT}; starts at the same ratio of all tendons")


def paths(bench: Bench) -> None:
    """Fig. 13."""
    for name, file, seconds in (("L", "letter_l.csv", 38), ("flame", "flame.csv", 46)):
        folder = bench.folder / name
        _, took = bench.run("follow", example("three_tendon_finger"), example("three_tendon_finger", file), *SHAPES, "-o", folder,
                            "--force-overwrite")
        columns = table(folder / "errors.csv")
        errors, count = columns["error_mm"], len(columns["error_mm"])
        plot(bench.picture(f"{name}.svg"), [Curve("asked", columns["tip_target_x_mm"], columns["tip_target_z_mm"]),
             Curve("reached", columns["tip_x_mm"], columns["tip_z_mm"], points=True)], "x [mm]", "z [mm]", even=True)
        plot(bench.picture(f"{name}_errors.svg"), [Curve(name, list(range(count)), errors)], "waypoint", "error [mm]")
        bench.row(f"Fig. 13, {name}: time", f"{count} waypoints in {seconds} s, to 0.2 mm", f"{count} in {took:.1f} s, to "
                  f"{max(errors):.5f} mm", "agrees", conditions=ROBOT)
        bench.row(f"Fig. 13, {name}: measured error", "curves of the experiment", "of the computation alone", "cannot",
                  "it is a measurement on their robot")


def beyond(bench: Bench) -> None:
    folder = bench.folder / "beyond"
    bench.run("follow", example("three_tendon_finger"), example("three_tendon_finger", "beyond.csv"), *SHAPES, "-o", folder,
              "--force-overwrite", codes=(0, 1))
    columns = table(folder / "errors.csv")
    plot(bench.picture("beyond.svg"), [Curve("asked", columns["tip_target_x_mm"], columns["tip_target_z_mm"]),
         Curve("reached", columns["tip_x_mm"], columns["tip_z_mm"])], "x [mm]", "z [mm]", even=True)
    out = [e for e in columns["error_mm"] if e > 0.01]
    x, z = columns["tip_x_mm"], columns["tip_z_mm"]
    steps = [((b - a) ** 2 + (d - c) ** 2) ** 0.5 for a, b, c, d in zip(x, x[1:], z, z[1:])]
    bench.row("Fig. 14", "a smooth path inside the reach where the asked one leaves it", f"{len(out)} of {len(columns['error_mm'])} "
              f"waypoints out of reach, by {max(out):.1f} mm at most; no step of the tip longer than {max(steps):.2f} mm", "agrees",
              conditions=ROBOT, figure=max(out), tolerance=1e-3)


def chambers(bench: Bench) -> None:
    """Fig. 15."""
    for command in (("air1=1.5",), ("air1=1.5", "air2=1.5"), ("air1=1.5", "air2=1.5", "air3=1.5")):
        sets = [word for each in command for word in ("--set", each)]
        step = bench.report("fk", example("three_chamber_actuator"), *SHAPES, *sets, "--image",
                            bench.picture(f"{len(command)}.png"))["steps"][0]
        tip = step["markers"]["tip"]
        bench.row(f"Fig. 15(b), {len(command)} of 3 chambers", "drawn", "tip at " + ", ".join(f"{c:.1f}" for c in tip) + " mm",
                  "differs", "our bellows, of 9,814 elements instead of 135k", figure=tip[2], tolerance=1e-3)
    bench.row("Fig. 15(a), (c), (d)", "a test, its hysteresis, errors below 3 mm", "none", "cannot", "measured on their robot; softkin "
              "calibrates such curves (docs/pressure.md) and compares with sums of single chambers (docs/compare.md)")


def air_path(bench: Bench) -> None:
    """Fig. 16."""
    folder = bench.folder / "curve"
    _, took = bench.run("follow", example("three_chamber_actuator"), example("three_chamber_actuator", "curve.csv"), "-o", folder,
                        "--force-overwrite")
    columns = table(folder / "errors.csv")
    plot(bench.picture("curve.svg"), [Curve("asked", columns["tip_target_x_mm"], columns["tip_target_y_mm"]),
         Curve("reached", columns["tip_x_mm"], columns["tip_y_mm"], points=True)], "x [mm]", "y [mm]", even=True)
    worst = max(columns["error_mm"])
    bench.row("Fig. 16, VI", "error less than 1 mm in the mean, measured", f"{worst:.5f} mm at most in {len(columns['error_mm'])} "
              f"waypoints, {took:.0f} s", "cannot", "theirs is a measurement; ours is of the computation alone, physical")


def sizes(bench: Bench) -> None:
    """Fig. 17: time of an iteration over the size of the mesh."""
    program = bench.program.parent / "bench/bench_iteration"
    text = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout
    bench.result.commands.append("build/bench/bench_iteration")
    rows = [[float(word) for word in line.replace("|", " ").split()] for line in text.splitlines() if line.strip()[:1].isdigit()]
    plot(bench.picture("time.svg"), [Curve("local step", [r[0] for r in rows], [r[3] for r in rows]),
         Curve("global step", [r[0] for r in rows], [r[4] for r in rows]), Curve("all threads", [r[0] for r in rows], [r[6] for r in rows])],
         "vertices", "time of an iteration [ms]", log="xy")
    at = min(rows, key=lambda r: abs(r[0] - 25800))
    bench.row("Fig. 17, time", "nearly linear in the vertices", f"{text.strip().splitlines()[-1]}", "agrees", conditions="bars with a chamber")
    bench.row("Fig. 17, 25.8k vertices", "chosen as fine enough", f"{at[6]:.1f} ms an iteration at {at[0]:.0f} vertices", "agrees")
    fps = [r for r in rows if r[1] <= 52000][-1]
    bench.row("V, 25 fps", "50k tetrahedra at 25 fps", f"{1000 / fps[6]:.0f} iterations a second at {fps[1]:.0f} tetrahedra", "agrees",
              conditions="an iteration, not a shape: docs/paper.md, Errata")
