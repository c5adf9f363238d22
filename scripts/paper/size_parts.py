"""Parts of Sections V and VI: time and accuracy over the size of the mesh, Fig. 17."""

from __future__ import annotations

import math
import os

from forward_parts import Point
from meshes import refined
from plots import Curve, plot
from rows import AS_ABOVE, PRINTED_WEIGHTS, SHAPES, Bench, elements_of, example

EDGE_RATIOS = (None, 1.7, 1.2, 0.85)  # maximum edge over the median edge of the shipped mesh; None: this mesh
WEIGHTS = ("printed", "mesh-independent")


def iteration_times(bench: Bench) -> None:
    """Adds the rows of Fig. 17: time of an iteration over the size of the mesh."""
    text = bench.bench("bench_iteration")
    rows = [[float(word) for word in line.replace("|", " ").split()] for line in text.splitlines() if line.strip()[:1].isdigit()]
    vertices = [row[0] for row in rows]
    plot(bench.picture("time.svg"), [Curve(name, vertices, [row[i] for row in rows])
                                     for name, i in (("local step", 3), ("global step", 4), ("all threads", 6))],
         "vertices", "time of an iteration [ms]", log="xy")
    conditions = "bars of 120 x 25 x 25 mm with a chamber, linear tetrahedra; target shapes, weights 1 and 5, " \
                 "Algorithm 1 as printed"
    growth = text.strip().splitlines()[-1]
    bench.claim("Fig. 17, time", "a nearly linear relationship with the number of vertices", growth, float(growth.split()[-1]) < 1.4,
                "the fill of the factor", conditions=conditions)
    circled, fps = min(rows, key=lambda row: abs(row[0] - 25800)), [row for row in rows if row[1] <= 52000][-1]
    bench.row("Fig. 17, the circled mesh", "25.8k vertices",
              f"{circled[6]:.1f} ms an iteration at {circled[0]:,.0f} vertices", "agrees",
              conditions=conditions)
    bench.claim("V: 25 fps", "up to 50 k tetrahedra in real-time (25 fps)", f"{1000 / fps[6]:.0f} iterations a second at {fps[1]:,.0f} "
                "tetrahedra", fps[6] <= 40, "a slower machine",
                conditions=f"{conditions}; an iteration, not a shape: docs/paper.md, Errata")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    bench.row("V: their machine", "Intel E5-1653 3.5 GHz, 16 GB RAM", f"{os.cpu_count()} cores, {memory:.0f} GiB", "differs",
              "another machine", conditions="every time of this page")


def accuracy(bench: Bench) -> None:
    """Adds the rows of Fig. 17: accuracy over the size of the mesh."""
    shipped = bench.folder / "shipped.msh"
    bench.run("mesh", "convert", example("pneumatic_finger", "pneumatic_finger.msh"), shipped, "--ascii", "--force-overwrite")
    counts: list[int] = []
    tips: dict[str, list[Point]] = {weights: [] for weights in WEIGHTS}
    for edge_ratio in EDGE_RATIOS:
        mesh = shipped
        if edge_ratio is not None:
            mesh = bench.folder / f"finer_{edge_ratio}.msh"
            mesh.write_text(refined(shipped.read_text(), edge_ratio))
        for weights in WEIGHTS:
            report = bench.report("fk", example("pneumatic_finger"), *SHAPES, "--set", "air=1.4", "--change",
                                  f"mesh.file={mesh}",
                                  "--change", f"weights={weights}")
            tips[weights].append(report["steps"][0]["markers"]["tip"])
        counts.append(report["mesh"]["vertices"])
    errors_of = {weights: [math.dist(tip, found[-1]) for tip in found[:-1]] for weights, found in tips.items()}
    plot(bench.picture("accuracy.svg"), [Curve(weights, counts[:-1], errors) for weights, errors in errors_of.items()],
         "vertices",
         "off the finest mesh [mm]", log="xy")
    for weights, errors in errors_of.items():
        conditions = "target shapes, mesh-independent weights, Newton's method"
        if weights == "printed":
            conditions = PRINTED_WEIGHTS
        found = ", ".join(f"{error:.2f} mm at {count:,} vertices" for error, count in zip(errors, counts))
        bench.claim(f"Fig. 17, accuracy, {weights} weights",
                    "a finer mesh can generate more accurate results" if weights == "printed" else AS_ABOVE, f"off by {found}",
                    errors == sorted(errors, reverse=True),
                    "stiffness by the printed weights depends on the sizes of elements: docs/formulations.md",
                    conditions=f"tip of the pneumatic finger at 1.4, compared with {elements_of(report)}, "
                               f"{counts[-1]:,} vertices; {conditions}",
                    figure=errors[-1], tolerance=0.05)
