"""Parts of Section V-A: forward kinematics, Figs. 8 to 11."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from plots import Curve, plot
from rows import AS_ABOVE, PHYSICAL, PRINTED_WEIGHTS, ROOT, SHAPES, Bench, columns_of, elements_of, example

Step = dict[str, Any]
Point = Sequence[float]
SMALL = 1e-4  # change of a ratio from rest, for the derivatives of linear FEM


def steps_of(report: dict[str, Any], marker: str) -> list[Point]:
    """Returns the position of a marker at each step of a report."""
    return [step["markers"][marker] for step in report["steps"]]


def values(first: float, last: float, step: float) -> list[float]:
    """Returns equidistant values from first to last."""
    count = round(abs(last - first) / step)
    return [first + (last - first) * i / count for i in range(count + 1)]


def linear(bench: Bench, scene: Path, actuator: str, marker: str, commands: Sequence[float]) -> list[Point]:
    """Returns the positions of a marker by linear FEM, with the mesh and the moduli of the physical formulation.

    The displacements are the derivative of the nonlinear ones at rest (difference of second order) times the command.
    """
    sign = 1 if commands[-1] > 1 else -1
    path = bench.table("linear.csv", [actuator], [[1 + sign * SMALL * i] for i in (0, 1, 2)])
    rest, once, twice = steps_of(bench.report("fk", scene, "--path", path, "--solver-tolerance", "1e-10"), marker)
    derivative = [(4 * b - c - 3 * a) / (2 * sign * SMALL) for a, b, c in zip(rest, once, twice)]
    return [[a + s * (value - 1) for a, s in zip(rest, derivative)] for value in commands]


def in_plane(name: str, points: Sequence[Point], marks: bool = False) -> Curve:
    """Returns the curve of z over x."""
    return Curve(name, [p[0] for p in points], [p[2] for p in points], points=marks)


def within(points: Sequence[Point]) -> list[Point]:
    """Returns the points that are no farther up or down than the robot is long."""
    return [point for point in points if abs(point[2]) < 120]


def draw(bench: Bench, curves: list[Curve]) -> None:
    plot(bench.picture("tip.svg"), curves, "x of the tip [mm]", "z of the tip [mm]", even=True)


def distance_from_track(point: Point, track: Sequence[Point]) -> float:
    """Returns the distance of a point from a line through points."""
    distance = math.inf
    for a, b in zip(track, track[1:]):
        along = [q - p for p, q in zip(a, b)]
        fraction = sum((x - p) * d for x, p, d in zip(point, a, along)) / sum(d * d for d in along)
        foot = [p + min(1.0, max(0.0, fraction)) * d for p, d in zip(a, along)]
        distance = min(distance, math.dist(point, foot))
    return distance


def bend(steps: list[Step]) -> float:
    """Returns the rotation of the line from tip to end about y along a path that begins at rest [degrees]."""
    lines = [[b - a for a, b in zip(step["markers"]["tip"], step["markers"]["end"])] for step in steps]
    angles = [math.degrees(math.atan2(line[2], line[0])) for line in lines]
    return abs(sum((b - a + 180) % 360 - 180 for a, b in zip(angles, angles[1:])))


def gripper(bench: Bench) -> None:
    """Adds the rows of Fig. 8."""
    scene, commands = example("cable_gripper"), values(1.0, 0.55, 0.05)
    path = bench.table("path.csv", ["cable"], [[value] for value in commands])
    for ratio in (0.9, 0.7, 0.55):
        bench.report("fk", scene, *SHAPES, "--set", f"cable={ratio}", "--image", bench.picture(f"cable_{ratio}.png"))
    ours, physical = bench.report("fk", scene, *SHAPES, "--path", path), bench.report("fk", scene, "--path", path)
    tips, reference = steps_of(ours, "tip"), steps_of(physical, "tip")
    linear_tips = linear(bench, scene, "cable", "tip", commands)
    draw(bench, [in_plane("target shapes", tips), in_plane("physical", reference),
                 in_plane("linear FEM", within(linear_tips))])
    apart = [math.dist(a, b) for a, b in zip(tips, reference)]
    errors = [math.dist(a, b) for a, b in zip(linear_tips, reference)]
    first_percent = next(100 * (1 - value) for value, error in zip(commands, errors) if error > 5)
    conditions = f"{elements_of(ours)}; {PRINTED_WEIGHTS}"
    bench.claim("Fig. 8: ours", "our simulation closes as the physical test does, of flexible PLA",
                f"the tip is within {max(apart):.2f} mm of the physical formulation to 45 % of the cable", max(apart) < 3,
                "the formulations differ",
                conditions=f"{conditions}; compared with {elements_of(physical)}, {PHYSICAL}",
                figure=max(apart), tolerance=0.02)
    bench.row("Fig. 8: the test", "pictures at several instants", "none", "cannot", "it is a measurement on their robot",
              conditions="their gripper")
    bench.row("Fig. 8: SOFA", "varies from reality when the cable's change is larger than 45 %", "none; linear FEM is more than 5 mm off "
              f"from {first_percent:.0f} % on", "cannot",
              "SOFA is not packaged; linear FEM does not represent large rotations", figure=errors[-1],
              tolerance=1e-3, conditions=f"linear FEM: derivative at rest of the physical formulation, {elements_of(physical)}")


def finger(bench: Bench) -> None:
    """Adds the rows of Fig. 9, without those of other programs."""
    scene, commands = example("pneumatic_finger"), values(1.0, 1.4, 0.025)[:-1] + values(1.4, 2.6, 0.1)
    path = bench.table("path.csv", ["air"], [[value] for value in commands])
    tracks: dict[str, list[Point]] = {}
    for name, options, method in (("target shapes", SHAPES, PRINTED_WEIGHTS), ("physical", (), PHYSICAL)):
        report = bench.report("fk", scene, "--path", path, *options, "--image",
                              bench.picture(f"{name.split()[0]}.png"))
        tracks[name], turn = steps_of(report, "tip"), bend(report["steps"])
        bench.claim(f"Fig. 9, {name}", "the track of the tip, bent up to 240 degrees" if options else AS_ABOVE,
                    f"{turn:.0f} degrees at a ratio of 2.6", turn >= 240,
                    "with weights of 5 the chamber's elements hold the finger back: docs/formulations.md",
                    conditions=f"{elements_of(report)}; {method}", figure=turn, tolerance=2e-3)
    slim_finger(bench)
    compare_tracks(bench, tracks, elements_of(report))
    linear_tips = linear(bench, scene, "air", "tip", commands)
    draw(bench, [*(in_plane(name, track) for name, track in tracks.items()),
                 in_plane("linear FEM", within(linear_tips))])
    error = math.dist(linear_tips[commands.index(1.2)], tracks["physical"][commands.index(1.2)])
    bench.row("Fig. 9, linear FEM", "none: their FEM 1 and FEM 2 follow large turns",
              f"the tip is {error:.0f} mm off the physical one at a ratio of 1.2, straight down", "differs",
              "linear FEM does not represent large rotations",
              conditions=f"derivative at rest of the physical formulation, {elements_of(report)}",
              figure=error, tolerance=1e-2)
    bench.row("Fig. 9, test", "the bending in a physical test", "none", "cannot", "it is a measurement on their robot",
              conditions="their finger")
    bench.row("Fig. 9, SOFA", "unrealistic after being bent for more than 90 degrees", "none", "cannot", "SOFA is not packaged",
              conditions="their finger")


def slim_finger(bench: Bench) -> None:
    """Adds the row of a finger that target shapes with the paper's weights bend by 240 degrees."""
    folder = ROOT / "examples/paper/slim_finger"
    report = bench.report("fk", folder / "slim_finger.yaml", "--path", folder / "path.csv", "--image",
                          bench.picture("slim.png"))
    last, turn = report["steps"][-1], bend(report["steps"])
    bench.claim("Fig. 9, target shapes, a slim finger", AS_ABOVE, f"{turn:.0f} degrees at a ratio of {last['actuation']['air']:g}, "
                f"{last['inverted_elements']} elements inverted", turn >= 240 and last["inverted_elements"] == 0,
                "it bends less, or elements are inverted",
                conditions=f"examples/paper/slim_finger, 12 mm high instead of 25, {elements_of(report)}; "
                f"{PRINTED_WEIGHTS}",
                figure=turn, tolerance=2e-3)


def compare_tracks(bench: Bench, tracks: dict[str, list[Point]], mesh: str) -> None:
    """Adds the row that compares the path of the tip by target shapes with that by nonlinear FEM."""
    distances = [distance_from_track(tip, tracks["physical"]) for tip in tracks["target shapes"]]
    apart = [math.dist(a, b) for a, b in zip(tracks["target shapes"], tracks["physical"])]
    bench.row("Fig. 9, ours beside FEM", "our result matches well with FEA with nonlinear properties (FEM 2)",
              f"the tip of target shapes is up to {max(distances):.1f} mm off the path of the physical one, and up to "
              f"{max(apart):.0f} mm off its place at the same ratio", "differs",
              "the chamber's elements resist like rubber: docs/formulations.md",
              conditions=f"10,879 tetrahedra of order 1; {PRINTED_WEIGHTS}; compared with {mesh}, "
              f"neo-Hookean, {PHYSICAL}", figure=max(distances),
              tolerance=1e-2)


def crawler(bench: Bench) -> None:
    """Adds the rows of Fig. 10."""
    folder = bench.folder / "walk"
    bench.run("walk", example("dea_crawler"), example("dea_crawler", "gait.csv"), "--cycles", "1", "-o", folder, "--force-overwrite")
    for skin in (0.7, 1.0):
        report = bench.report("fk", example("dea_crawler"), *SHAPES, "--set", f"skin={skin}", "--image",
                              bench.picture(f"skin_{skin}.png"))
        if skin == 0.7:
            height = report["steps"][0]["markers"]["middle"][2]
    mesh = f"{report['mesh']['prisms']:,} prisms"
    bench.row("Fig. 10, above", "an initial ratio lambda_init = 0.7 arches the planar model; legs stay on the plane",
              f"the middle stands {height:.1f} mm high, {report['steps'][0]['markers']['middle'][2]:.1f} at 1",
              "differs",
              "frames, arch and legs are ours: the paper gives no sizes", conditions=f"{mesh}; target shapes, weight of the membrane 0.1, "
              "uniform ratios, Newton's method", figure=height, tolerance=1e-3)
    columns = columns_of(folder / "walk.csv")
    column = next(column for name, column in columns.items() if name.startswith("travel") or name.endswith("_x_mm"))
    travel = column[-1] - column[0]
    plot(bench.picture("walk.svg"), [Curve("foot", columns["t_s"], column)], "time [s]", "x of a foot [mm]")
    bench.row("Fig. 10, below", "the locomotion of a real robot", f"the first cycle takes it {abs(travel):.1f} mm", "cannot",
              "theirs is a robot; ours is computed, with friction chosen here", conditions=f"{mesh}; {PHYSICAL}, feet that slide",
              figure=travel, tolerance=5e-3)
    bench.row("V-A: voltage to stretch", "lambda by the relationship of [46]", "softkin calibrate dea, from a measured curve or the "
              "equation of state; or the voltage itself as a load (docs/voltage.md)", "differs", "[46] is of their membrane",
              conditions="physical, for the voltage as a load")


def two_materials(bench: Bench) -> None:
    """Adds the rows of Fig. 11."""
    ends, curves = [], []
    for name in ("a", "b"):
        report = bench.report("fk", example("cable_gripper_two_materials", f"{name}.yaml"), *SHAPES, "--path",
                              example("cable_gripper_two_materials", "path.csv"), "--image",
                              bench.picture(f"{name}.png"))
        ends.append(report["steps"][-1]["largest_displacement_mm"])
        curves += [in_plane(f"{name}: {marker}", steps_of(report, marker)) for marker in report["steps"][0]["markers"]]
    plot(bench.picture("markers.svg"), curves, "x [mm]", "z [mm]", even=True)
    conditions = f"ours, {elements_of(report)}; target shapes, weight of the cable 1, Newton's method; " \
                 "their distributions are not published"
    bench.row("Fig. 11", "two distributions of two materials behave differently; three markers", f"{ends[0]:.1f} and {ends[1]:.1f} mm at "
              "the end of the path", "agrees", conditions=conditions, figure=ends[0] / ends[1], tolerance=1e-3)
    bench.row("Fig. 11: the test", "markers match those of the physical experiments", "none", "cannot",
              "it is a measurement on their robots", conditions="their grippers")
