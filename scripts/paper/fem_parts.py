"""Parts of Table III and of the finite elements of Fig. 9: CalculiX, if it is installed, in place of Abaqus."""

from __future__ import annotations

import math
import re

import calculix
from forward_parts import Point, bend, draw, in_plane, linear, steps_of, values, within
from rows import AS_ABOVE, ROOT, SHAPES, Bench, Failed, elements_of, example

LIMIT_S = 1800
RATIOS = (1.0, 1.2, 1.4)  # beyond these ratios St. Venant-Kirchhoff inverts elements


def times(bench: Bench) -> None:
    """Adds the rows of Table III, ours on as many elements as the paper's."""
    text = bench.bench("bench_newton", "--sizes", "45000", "--solvers", "physical", "--repeat", "1")
    found = re.search(r"^ *(\d+)  physical +([\d.]+) +([\d.]+) +([\d.]+) *$", text, re.MULTILINE)
    if found is None:
        raise Failed("bench_newton did not bend the finger by 90, 180 and 240 degrees")
    elements, *seconds = found.groups()
    bench.row("Table III, our method", "45802 elements: 8.5 s to 90, 15.2 s to 180, 23.2 s to 240 degrees",
              f"{int(elements):,} elements: {seconds[0]}, {seconds[1]}, {seconds[2]} s, each from rest and set up anew", "differs",
              "another finger, machine and formulation; theirs are of an iteration that was stopped: docs/paper.md",
              conditions="bellows finger of bench_newton, linear tetrahedra; St. Venant-Kirchhoff, Newton's method, tip within 0.1 mm")
    scene, path = example("pneumatic_finger"), bench.table("path.csv", ["air"], [[v] for v in values(1.0, 2.6, 0.2)])
    for name, options in (("target shapes", SHAPES), ("physical", ())):
        report = bench.report("fk", scene, "--path", path, *options)
        bench.row(f"Table III, our finger, {name}", AS_ABOVE,
                  f"{report['seconds']:.1f} s for {len(report['steps'])} shapes, to "
                  f"{bend(report['steps']):.0f} degrees", "differs", "another finger, mesh and machine",
                  conditions=f"{elements_of(report)}; {name}, Newton's method")
    slim_times(bench)
    for name, printed in (("FEM 1", "44774 elements, linear material: 240, 529, 820 s"),
                          ("FEM 2", "nonlinear material: 288, 636, 1068 s")):
        bench.row(f"Table III, {name}", printed, "none; CalculiX in its place below, and in docs/benchmarks.md", "cannot",
                  "Abaqus is not free", conditions="Abaqus, on their machine")
    bench.row("Table III, SOFA", "44900 elements: 3.8 s, no result to 180 and 240 degrees", "none", "cannot", "SOFA is not packaged",
              conditions="SOFA, on their machine")


def slim_times(bench: Bench) -> None:
    """Adds the times of the solvers of the paper's formulation and weights, to 90, 180 and 240 degrees."""
    folder = ROOT / "examples/paper/slim_finger"
    for name, options in (("Newton's method", ()), ("Algorithm 1 as printed", ("--solver", "local-global", "--anderson", "0")),
                          ("Algorithm 1 with Anderson's acceleration", ("--solver", "local-global")),
                          ("stopped as published", ("--solver", "local-global", "--as-published"))):
        report = bench.report("fk", folder / "slim_finger.yaml", "--path", folder / "path.csv", *options, codes=(0, 1))
        steps, seconds, found = report["steps"], 0.0, []
        for i, step in enumerate(steps):
            seconds += step["seconds"]
            if len(found) < 3 and bend(steps[: i + 1]) >= (90, 180, 240)[len(found)]:
                found.append(f"{seconds:.2f}")
        num_failed = sum(step["status"] != "converged" for step in steps)
        times = f"{', '.join(found)} s to 90, 180 and 240 degrees" if len(found) == 3 else f"{bend(steps):.0f} degrees at the end"
        bench.row(f"Table III, slim finger, {name}", AS_ABOVE, f"{times}, {sum(step['iterations'] for step in steps):,} iterations"
                  + (f", {num_failed} of {len(steps)} shapes not converged" if num_failed else ""), "differs",
                  "another finger, mesh and machine",
                  conditions=f"examples/paper/slim_finger, {elements_of(report)}; target shapes, weights 1 and 5, "
                  f"{name}, shape by shape")


def finite_elements(bench: Bench) -> None:
    """Adds the row of the tip by CalculiX, at the pressures that softkin computes for the same material."""
    item, printed = "Fig. 9, FEM by another program", "much faster than Abaqus: 13.6 min to 240 degrees"
    if not calculix.is_installed():
        bench.row(item, printed, "not run: ccx is not on the PATH", "cannot", "CalculiX is not installed here",
                  conditions="CalculiX, C3D10")
        return
    scene = example("pneumatic_finger")
    path = bench.table("path.csv", ["air"], [[v] for v in RATIOS])
    report = bench.report("fk", scene, "--path", path, "--change", "materials.body.law=st-venant-kirchhoff")
    pressures = [step["actuators"]["air"]["pressure_kPa"] for step in report["steps"][1:]]
    mesh = bench.folder / "finger.msh"
    bench.run("mesh", "convert", example("pneumatic_finger", "pneumatic_finger.msh"), mesh, "--ascii", "--force-overwrite")
    tips = steps_of(report, "tip")
    print(f"  CalculiX: up to {LIMIT_S} s", flush=True)
    track = calculix.bend(mesh, bench.folder / "calculix", pressures, tips[0], 45, 0.45, LIMIT_S)
    overlay(bench, tips, track)
    done = [(ratio, math.dist(tip, other)) for i, (ratio, tip) in enumerate(zip(RATIOS, tips))
            if i > 0 and (other := track.tip_after(i))]
    if not done:
        bench.row(item, printed, f"CalculiX did not complete the first pressure: {track.failure}", "cannot",
                  "the run failed", conditions="CalculiX, C3D10")
        return
    distances = ", ".join(f"{miss:.2f} mm at a ratio of {ratio}" for ratio, miss in done)
    turn = bend(report["steps"][:len(done) + 1])
    bench.claim(item, printed,
                f"CalculiX {track.seconds:.0f} s, softkin {report['seconds']:.1f} s to {turn:.0f} degrees, "
                f"the tips apart by {distances}", all(miss < 1 for _, miss in done),
                "its controls end the iteration early",
                conditions=f"the same {elements_of(report)}, pressures, supports and material, "
                f"St. Venant-Kirchhoff; CalculiX with R_n {calculix.RESIDUAL:g} and C_n {calculix.CORRECTION:g}"
                f"{'; ' + track.failure if track.failure else ''}")


def overlay(bench: Bench, tips: list[Point], track: calculix.Track) -> None:
    """Plots the path of the tip by CalculiX, by softkin's formulations and by linear FEM."""
    curves = [in_plane("St. Venant-Kirchhoff", tips), in_plane("CalculiX", [tips[0], *track.tips], marks=True)]
    scene, commands = example("pneumatic_finger"), values(1.0, 1.4, 0.05)[:-1] + values(1.4, 2.6, 0.2)
    path = bench.table("far.csv", ["air"], [[value] for value in commands])
    for name, options in (("target shapes", SHAPES), ("neo-Hookean", ())):
        curves.append(in_plane(name, steps_of(bench.report("fk", scene, "--path", path, *options), "tip")))
    curves.append(in_plane("linear FEM", within(linear(bench, scene, "air", "tip", commands))))
    draw(bench, curves)
