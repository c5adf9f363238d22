"""Parts of Sections II and III: elements, their target shapes and the iteration; Table I, Figs. 1 to 5."""

from __future__ import annotations

from plots import Curve, plot
from rows import AS_ABOVE, PRINTED_WEIGHTS, SHAPES, Bench, elements_of, example

NO_COMPUTATION = "no computation"


def notation(bench: Bench) -> None:
    """Adds the rows of Table I and of the constants of Section III."""
    bench.row("Table I", "symbols of the method", "each has its name in the code: docs/paper.md, Notation", "agrees",
              conditions=NO_COMPUTATION)
    scene, options = example("pneumatic_finger"), (*SHAPES, "--set", "air=1.2")
    report = bench.report("fk", scene, *options)
    step = report["steps"][0]
    mesh = f"pneumatic finger, {elements_of(report)}; {PRINTED_WEIGHTS}"
    tolerance = step["tolerance_mm"]
    bench.row("Algorithm 1: its end", "a change of position of less than 10^-5 on all vertices", f"{tolerance:.2g} mm by default, 8e-8 of "
              "the robot's diagonal", "agrees", conditions=mesh, figure=tolerance, tolerance=1e-6)
    weighted = bench.report("fk", scene, *options, "--change", "materials.body.weight=1", "--change",
                            "actuators.air.weight=5")
    apart = max(abs(a - b) for a, b in zip(step["markers"]["tip"], weighted["steps"][0]["markers"]["tip"]))
    bench.claim("III-A: weights", "w_i = 5.0 for the actuation elements, w_i = 1.0 for all others", "the same by default: the tip is where "
                f"these weights, given in the scene, bring it, {apart:.0g} mm apart", apart < 1e-9,
                "the defaults are others", conditions=mesh, figure=step["markers"]["tip"][0], tolerance=1e-4)
    bench.row("III-B: line search", "a first step of 1.0, shrunk by tau = 0.1",
              "the same in --method gradient, on fractions of the ranges",
              "agrees", conditions=f"{NO_COMPUTATION}; src/softkin/kinematics/inverse_search.cpp")
    report = bench.report("ik", example("three_tendon_finger"), *SHAPES, "--method", "gradient", "--target",
                          "tip=125,,", "--descents", "1",
                          codes=(0, 1))
    bench.row("V-B: end of Algorithm 2", "lambda = 0.2 mm and i_max = 30",
              f"--method gradient ends at {report['ik']['tolerance_mm']} mm or "
              "after 30 iterations by default", "agrees", conditions="three-tendon finger, 6,096 tetrahedra; Algorithm 2",
              figure=report["ik"]["tolerance_mm"], tolerance=1e-9)


def robots(bench: Bench) -> None:
    """Adds the rows of Figs. 1 to 4."""
    meshes = []
    for name, command in (("three_tendon_finger", "tendon2=0.7"), ("dea_crawler", "skin=0.85"), ("pneumatic_finger", "air=1.4")):
        report = bench.report("fk", example(name), *SHAPES, "--set", command, "--image", bench.picture(f"{name}.png"))
        meshes.append(f"{report['mesh']['tetrahedra'] or report['mesh']['prisms']:,}")
    bench.row("Fig. 1", "a finger by cable, a crawler by a dielectric elastomer, an actuator by air",
              "three robots of the examples, of the same kinds", "differs", "their meshes are not published",
              conditions=f"ours: {meshes[0]} and {meshes[2]} tetrahedra, {meshes[1]} prisms; {PRINTED_WEIGHTS}")
    bench.row("Figs. 2 to 4", "elements of actuation and their target shapes, drawn",
              "the same targets; tests compare each with its formula (docs/paper.md, Figures)", "agrees", conditions=NO_COMPUTATION)


def iteration(bench: Bench) -> None:
    """Adds the rows of Fig. 5: a small model after some iterations of Algorithm 1, without acceleration."""
    scene, options = example("pneumatic_finger"), (*SHAPES, "--solver", "local-global", "--anderson", "0", "--set",
                                                   "air=1.4")
    reached = []
    for max_iterations in (1, 10, 100, 1000):
        step = bench.report("fk", scene, *options, "--max-iterations", max_iterations, "--image",
                            bench.picture(f"iteration_{max_iterations}.png"), codes=(1,))["steps"][0]
        reached.append((max_iterations, step["markers"]["tip"]))
    report = bench.report("fk", scene, *options, "--image", bench.picture("converged.png"))
    converged = report["steps"][0]
    energy, steps, end = converged["history"]["energy"], converged["history"]["iteration"], converged["markers"]["tip"]
    rises = sum(b > a * (1 + 1e-9) for a, b in zip(energy, energy[1:]))
    plot(bench.picture("energy.svg"), [Curve("Algorithm 1", steps, energy)], "iteration", "energy [mm^5]", log="xy")
    newton = bench.report("fk", scene, *SHAPES, "--set", "air=1.4")["steps"][0]
    conditions = f"the pneumatic finger at a ratio of 1.4 instead of their block: {elements_of(report)}; " \
                 "target shapes, weights 1 and 5, Algorithm 1 as printed"
    bench.row("Fig. 5", "the local-global iteration moves a mesh to its shape, drawn at some iterations",
              f"{converged['iterations']} iterations to the end, the energy rises in {rises} of them; "
              f"Newton's method: {newton['iterations']}", "agrees", conditions=conditions,
              figure=converged["energy"], tolerance=1e-3)
    distances = [f"{sum((a - b) ** 2 for a, b in zip(tip, end)) ** 0.5:.1f} mm after {count}" for count,
                 tip in reached]
    bench.row("Fig. 5: its shapes", AS_ABOVE, "the tip is still away from its end by " + ", ".join(distances),
              "agrees", conditions=conditions,
              figure=reached[2][1][2], tolerance=1e-3)
