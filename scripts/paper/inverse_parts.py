"""Parts of Section V-B: workspaces, inverse kinematics and paths, Figs. 12 to 14."""

from __future__ import annotations

import json
from itertools import accumulate
from pathlib import Path
from typing import Any

from plots import Curve, plot
from rows import AS_ABOVE, PRINTED_WEIGHTS, SHAPES, Bench, columns_of, example

ROBOT = f"three-tendon finger, ours, 6,096 tetrahedra of order 1; {PRINTED_WEIGHTS}"
TARGET = "tip=80,,70"


def sampled(bench: Bench, *options: object) -> tuple[Path, dict[str, Any]]:
    """Samples the workspace of the finger at 125 points; returns the table and the report."""
    file = bench.folder / "workspace.csv"
    output = bench.run("workspace", example("three_tendon_finger"), *SHAPES, "--samples", 125, "-o", file, *options,
                       "--force-overwrite", "--json")[0]
    return file, dict(json.loads(output))


def workspace(bench: Bench) -> None:
    """Adds the rows of Fig. 12(a) and (b)."""
    _, report = sampled(bench, "--plot", bench.picture("workspace.svg"))
    x, z = report["reach_mm"]["x"], report["reach_mm"]["z"]
    bench.row("Fig. 12(a)", "a set-up with a motor for each of three cables", "none; softkin drive writes such motors' moves", "cannot",
              "it is their robot", conditions="hardware")
    bench.claim("Fig. 12(b)", "125 sample points in 8.3 s", f"{report['converged']} in {report['seconds']:.1f} s",
                report["converged"] == 125 and report["seconds"] < 8.3, "another machine, busy or slower",
                conditions=ROBOT)
    bench.row("Fig. 12(b), extent", "drawn", f"{x[1] - x[0]:.1f} x {z[1] - z[0]:.1f} mm", "differs", "another finger", conditions=ROBOT,
              figure=x[1] - x[0], tolerance=1e-3)
    each = report["seconds"] / report["samples"]
    bench.row("V-B: dense samples", "3375 sample points take more than 5 min", f"{each * 3375:.0f} s at the pace of the 125", "differs",
              "Newton's method, groups of neighbours, another machine", conditions=ROBOT)


def starts(bench: Bench) -> None:
    """Adds the rows of Fig. 12(c): the objective over the number of equilibria, from several starts.

    The number includes the equilibria of line searches.
    """
    file, _ = sampled(bench)
    begins = {"nearest": ["--workspace", file]}
    begins |= {name: [word for i in (1, 2, 3) for word in ("--start", f"tendon{i}={start}")]
               for name, start in (("rest", 1.0), ("0.85", 0.85), ("0.7", 0.7))}
    curves, counts = [], {}
    for method, options in (("gradient", ("--method", "gradient", "--descents", "200")), ("newton", ())):
        for name, begin in begins.items():
            result = bench.report("ik", example("three_tendon_finger"), *SHAPES, "--target", TARGET, *options, *begin,
                                  codes=(0, 1))["ik"]
            smallest = [error * error for error in accumulate(result["history"]["error_mm"], min) if error > 0]
            curves.append(Curve(f"{method}, {name}", list(range(1, len(smallest) + 1)), smallest))
            counts[method, name] = result["iterations"]
    plot(bench.picture("convergence.svg"), curves, "equilibria", "smallest J until then [mm^2]", log="xy")
    for method, title, printed in (("gradient", "Algorithm 2", "from the closest sample IK converges much faster"),
                                   ("newton", "Gauss-Newton", AS_ABOVE)):
        nearest_count, *others = [counts[method, name] for name in begins]
        bench.claim(f"Fig. 12(c), {title}", printed,
                    f"{nearest_count} iterations from there, {min(others)} to {max(others)} from three others",
                    nearest_count < min(others), "it does not need so good a start",
                    conditions=f"{ROBOT}; {title}, the tip to x = 80 and z = 70 mm", figure=nearest_count,
                    tolerance=0.1)


def paths(bench: Bench) -> None:
    """Adds the rows of Fig. 13."""
    size = json.loads(bench.run("mesh", "info", example("three_tendon_finger"), "--json")[0])["size_mm"]
    bench.claim("Fig. 13: the actuator", "120 x 25 x 25 mm", " x ".join(f"{side:.4g}" for side in size) + " mm",
                [round(side, 6) for side in size] == [120, 25, 25], "another size",
                conditions="three-tendon finger, ours", figure=size[0], tolerance=1e-6)
    for name, file, seconds in (("L", "letter_l.csv", 38), ("flame", "flame.csv", 46)):
        folder = bench.folder / name
        _, took = bench.run("follow", example("three_tendon_finger"), example("three_tendon_finger", file), *SHAPES, "-o", folder,
                            "--force-overwrite")
        columns = columns_of(folder / "errors.csv")
        errors, count = columns["error_mm"], len(columns["error_mm"])
        plot(bench.picture(f"{name}.svg"), [Curve("target", columns["tip_target_x_mm"], columns["tip_target_z_mm"]),
             Curve("reached", columns["tip_x_mm"], columns["tip_z_mm"], points=True)], "x [mm]", "z [mm]", even=True)
        plot(bench.picture(f"{name}_errors.svg"), [Curve(name, list(range(count)), errors)], "waypoint", "error [mm]")
        bench.claim(f"Fig. 13, {name}", f"N = {55 if name == 'L' else 85} waypoints in {seconds} s", f"{count} in {took:.1f} s, to "
                    f"{max(errors):.5f} mm", took < seconds and max(errors) <= 0.2, "slower, or less accurate",
                    conditions=f"{ROBOT}; Gauss-Newton to 0.001 mm; the path is ours")
        bench.row(f"Fig. 13, {name}: error", "curves of the experiment", "of the computation alone, plotted", "cannot",
                  "it is a measurement on their robot", conditions=ROBOT)


def nearest(bench: Bench) -> None:
    """Adds the row of the baseline of V-B: the commands of the nearest sample for each waypoint."""
    file, _ = sampled(bench)
    rows = {}
    for method, options in (("newton", ()), ("nearest", ("--method", "nearest", "--workspace", file))):
        folder = bench.folder / method
        bench.run("follow", example("three_tendon_finger"), example("three_tendon_finger", "letter_l.csv"), *SHAPES, *options, "-o", folder,
                  "--force-overwrite", codes=(0, 1))
        rows[method] = columns_of(folder / "errors.csv")
    target = rows["newton"]
    plot(bench.picture("nearest.svg"), [Curve("target", target["tip_target_x_mm"], target["tip_target_z_mm"]),
         *(Curve(method, columns["tip_x_mm"], columns["tip_z_mm"], points=True) for method, columns in rows.items())],
         "x [mm]", "z [mm]", even=True)
    jump = {method: 100 * max(columns["command_change"]) for method, columns in rows.items()}
    error = {method: max(columns["error_mm"]) for method, columns in rows.items()}
    bench.claim("V-B: the nearest sample instead", "continuity is hard to be preserved on a path by the sample-searching method",
                f"off by {error['nearest']:.1f} mm at most, commands jump by {jump['nearest']:.0f} % of a range "
                f"from waypoint to waypoint; inverse kinematics {error['newton']:.5f} mm and {jump['newton']:.1f} %",
                jump["nearest"] > 5 * jump["newton"], "it does not jump more",
                conditions=f"{ROBOT}; the letter L, 125 samples", figure=error["nearest"], tolerance=1e-3)


def beyond(bench: Bench) -> None:
    """Adds the row of Fig. 14."""
    folder = bench.folder / "beyond"
    bench.run("follow", example("three_tendon_finger"), example("three_tendon_finger", "beyond.csv"), *SHAPES, "-o", folder,
              "--force-overwrite", codes=(0, 1))
    columns = columns_of(folder / "errors.csv")
    x, z = columns["tip_x_mm"], columns["tip_z_mm"]
    target_x, target_z = columns["tip_target_x_mm"], columns["tip_target_z_mm"]
    lines = [Curve("", [a, b], [c, d])
             for a, b, c, d, error in zip(target_x, x, target_z, z, columns["error_mm"]) if error > 0.01]
    plot(bench.picture("beyond.svg"), [Curve("target", target_x, target_z, points=True),
                                       Curve("reached", x, z, points=True), *lines],
         "x [mm]", "z [mm]", even=True)
    out = [error for error in columns["error_mm"] if error > 0.01]
    steps = [((b - a) ** 2 + (d - c) ** 2) ** 0.5 for a, b, c, d in zip(x, x[1:], z, z[1:])]
    bench.row("Fig. 14", "a smooth path inside the feasible region where the desired one falls out of it", f"{len(out)} of "
              f"{len(columns['error_mm'])} waypoints out of reach, by {max(out):.1f} mm at most; no step of the tip longer than "
              f"{max(steps):.2f} mm", "agrees", conditions=f"{ROBOT}; Gauss-Newton; the path is ours", figure=max(out), tolerance=1e-3)
