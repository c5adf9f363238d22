"""Parts of Section V-C: actuators with three chambers, Figs. 15 and 16."""

from __future__ import annotations

import json
import time
from pathlib import Path

from meshes import refined
from plots import Curve, plot
from rows import PHYSICAL, PRINTED_WEIGHTS, SHAPES, Bench, columns_of, elements_of, example

SCENE = example("three_chamber_actuator")
AIRS = ("air1", "air2", "air3")
MAX_PRESSURE_KPA = 140  # gauge: 240 kPa absolute


def chambers(bench: Bench) -> None:
    """Adds the rows of Fig. 15(a), (b) and (d)."""
    size = json.loads(bench.run("mesh", "info", SCENE, "--json")[0])["size_mm"]
    bench.claim("V-C: the actuator", "48 x 48 x 136 mm", " x ".join(f"{side:.4g}" for side in size) + " mm",
                [round(side, 6) for side in size] == [48, 48, 136], "another size",
                conditions="three-chamber actuator, ours", figure=size[2], tolerance=1e-6)
    for count in (1, 2, 3):
        sets = [word for air in AIRS[:count] for word in ("--set", f"{air}=1.5")]
        report = bench.report("fk", SCENE, *SHAPES, *sets, "--image", bench.picture(f"{count}.png"))
        tip = report["steps"][0]["markers"]["tip"]
        bench.row(f"Fig. 15(b), {count} of 3 chambers", "drawn", "tip at " + ", ".join(f"{c:.1f}" for c in tip) + " mm", "differs",
                  "our bellows", conditions=f"{elements_of(report)}, ratio 1.5; {PRINTED_WEIGHTS}", figure=tip[2],
                  tolerance=1e-3)
    bench.row("Fig. 15(a)", "pictures of the actuator at rest, with one, two and three chambers", "none", "cannot",
              "it is a measurement on their robot", conditions="their actuator, of shore 70 A hardness")
    singles(bench)


def singles(bench: Bench) -> None:
    """Adds the rows of Fig. 15(d): the path of the tip, and the sum of the displacements by single chambers."""
    reports = {}
    for name in ("way", "single1", "single2", "single3"):
        reports[name] = bench.folder / f"{name}.json"
        bench.run("fk", SCENE, *SHAPES, "--path", example("three_chamber_actuator", f"measured/{name}.csv"), "--report", reports[name],
                  "--force-overwrite")
    table = bench.folder / "sum.csv"
    track = json.loads(bench.run("compare", reports["way"], "--sum", *(reports[f"single{i}"] for i in (1, 2, 3)), "-o",
                                 table, "--force-overwrite", "--json")[0])["tracks"][0]
    columns = columns_of(table)
    plot(bench.picture("tip.svg"), [Curve("together", columns["reference_y_mm"], columns["reference_z_mm"]),
         Curve("sum of singles", columns["other_y_mm"], columns["other_z_mm"])], "y of the tip [mm]", "z of the tip [mm]", even=True)
    bench.row("Fig. 15(d): the baseline", "more accurate than combining the results of individual chambers", "the sum of single "
              f"chambers is off by {track['largest_mm']:.1f} mm at most, {track['mean_mm']:.1f} in the mean, from "
              "what the chambers do "
              "together", "cannot", "which of the two a test is nearer to is a measurement",
              conditions=f"9,814 tetrahedra of order 1, ratios to 1.4; {PRINTED_WEIGHTS}; both are of the model",
              figure=track["largest_mm"], tolerance=5e-3)
    bench.row("Fig. 15(d): the test", "a maximum tracking error of less than 3 mm",
              "none; softkin compare computes it from a camera's track",
              "cannot", "it is a measurement on their robot", conditions="their actuator")


def coupled(bench: Bench) -> None:
    """Adds the rows of Fig. 15(c): the ratio of a chamber over its pressure, at several pressures of the others."""
    own, others = [MAX_PRESSURE_KPA * i / 7 for i in range(8)], (0.0, 40.0, 80.0, 120.0)
    path = bench.table("pressures.csv", AIRS, [(p, other, other) for other in others for p in own])
    changes = [word for air in AIRS for word in ("--change", f"actuators.{air}.control=pressure", "--change",
                                                 f"actuators.{air}.range=[0,{MAX_PRESSURE_KPA}]")]
    report = bench.report("fk", SCENE, "--path", path, *changes)
    ratios = [step["actuators"]["air1"]["achieved"] for step in report["steps"]]
    by_other = {other: ratios[8 * i:8 * i + 8] for i, other in enumerate(others)}
    plot(bench.picture("ratio.svg"), [Curve(f"others at {100 + other:.0f} kPa", [100 + p for p in own], found)
                                      for other, found in by_other.items()], "pressure, absolute [kPa]", "ratio of the chamber")
    conditions = f"{elements_of(report)}, 5.5 MPa by its hardness; {PHYSICAL}, chambers by pressure"
    alone, together = by_other[0.0][-1], by_other[120.0][-1]
    bench.row("Fig. 15(c)", "alpha(P) for P = 100 ~ 240 kPa with one, two and three chambers", f"1 to {alone:.3f} alone, to {together:.3f} "
              "with the others at 220 kPa", "differs", "our bellows, and a modulus that hardness gives to a factor of two",
              conditions=conditions, figure=alone, tolerance=1e-3)
    bench.row("Fig. 15(c): coupling", "chambers change each other's ratio", f"by {together - alone:.4f} at 240 kPa", "agrees",
              conditions=conditions, figure=together - alone, tolerance=0.02)
    bench.row("Fig. 15(c): hysteresis", "loading and unloading differ", "a branch each in a curve of softkin calibrate pressure "
              "(docs/pressure.md); none in the elastic model", "cannot", "it is a measurement on their robot", conditions="their actuator")
    measured = example("three_chamber_actuator", "measured/syringe.csv")
    curve = bench.folder / "curve.yaml"
    bench.run("calibrate", "pressure", measured, "--scene", SCENE, "--actuator", "air1", "--syringe-volume", "60mL", "--tube-volume",
              "1.5mL", "-o", curve, "--force-overwrite")
    lines = curve.read_text().splitlines()
    atmosphere_kpa = next(float(line.split()[1]) for line in lines if line.startswith("atmosphere_kPa"))
    bench.row("Eqs. (18), (19)", "a standard atmospheric pressure of 100 kPa",
              f"{atmosphere_kpa:g} kPa by default, --atmosphere sets another",
              "agrees", conditions="made-up rows of a syringe; calibrate pressure", figure=atmosphere_kpa,
              tolerance=1e-9)


def as_fine(bench: Bench) -> None:
    """Adds the row of a mesh with as many elements as the paper's."""
    coarse, fine = bench.folder / "coarse.msh", bench.folder / "fine.msh"
    bench.run("mesh", "convert", example("three_chamber_actuator", "three_chamber_actuator.msh"), coarse, "--ascii", "--force-overwrite")
    fine.write_text(refined(coarse.read_text(), 0.78))
    report = bench.report("fk", SCENE, *SHAPES, "--set", "air1=1.5", "--change", f"mesh.file={fine}", "--image",
                          bench.picture("fine.png"))
    tip = report["steps"][0]["markers"]["tip"]
    count, place = report["mesh"]["tetrahedra"], ", ".join(f"{c:.1f}" for c in tip)
    bench.claim("V-C: its mesh", "135k tetrahedra",
                f"{count:,}: {report['seconds']:.1f} s from rest to 1.5 of a chamber, tip at {place} mm",
                abs(count / 135e3 - 1) < 0.2, "another number of elements",
                conditions=f"the shipped mesh, its edges halved where they are long; {PRINTED_WEIGHTS}", figure=tip[2], tolerance=1e-3)


def air_path(bench: Bench) -> None:
    """Adds the rows of Fig. 16."""
    cloud = bench.folder / "workspace.csv"
    begin = time.monotonic()
    bench.run("workspace", SCENE, "--samples", 125, "-o", cloud, "--force-overwrite")
    sampling = time.monotonic() - begin
    folder = bench.folder / "curve"
    _, took = bench.run("follow", SCENE, example("three_chamber_actuator", "curve.csv"), "-o", folder, "--force-overwrite")
    errors = draw_path(bench, columns_of(cloud), folder / "errors.csv")
    conditions = f"three-chamber actuator, ours, 7,319 tetrahedra of order 1; {PHYSICAL}"
    heights = columns_of(cloud)["tip_z_mm"]
    bench.row("Fig. 16(a)", "the configuration space and the path in it", f"125 samples in {sampling:.0f} s, {min(heights):.1f} to "
              f"{max(heights):.1f} mm high, drawn with the path", "differs", "our bellows", conditions=conditions,
              figure=max(heights), tolerance=1e-4)
    bench.claim("Fig. 16(b)", "the tracked path beside the desired one, from above", f"{len(errors)} waypoints in {took:.1f} s, "
                f"{max(errors):.5f} mm off at most", max(errors) <= 0.001, "not every waypoint is reached",
                conditions=f"{conditions}, Gauss-Newton to 0.001 mm; the path is ours")
    bench.row("Fig. 16(c), VI: error", "an average tracking error of less than 1 mm", "of the computation alone, plotted", "cannot",
              "it is a measurement on their robot", conditions=conditions)


def draw_path(bench: Bench, cloud: dict[str, list[float]], file: Path) -> list[float]:
    """Plots the target and the computed path in the workspace; returns the error of each waypoint [mm]."""
    columns = columns_of(file)
    for other in ("y", "z"):
        plot(bench.picture(f"path_x{other}.svg"), [
            Curve("workspace", cloud["tip_x_mm"], cloud[f"tip_{other}_mm"], points=True),
            Curve("target", columns["tip_target_x_mm"], columns[f"tip_target_{other}_mm"]),
            Curve("reached", columns["tip_x_mm"], columns[f"tip_{other}_mm"], points=True)], "x [mm]", f"{other} [mm]", even=other == "y")
    errors = columns["error_mm"]
    plot(bench.picture("errors.svg"), [Curve("computed", list(range(len(errors))), errors)], "waypoint", "error [mm]")
    return errors
