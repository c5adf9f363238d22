#!/usr/bin/env python3
"""Checks that two installations of softkin, such as a wheel and a native build, compute the same shapes.

    scripts/same_numbers.py PYTHON OTHER_PYTHON

The script solves every scene in examples with both interpreters, each actuator at a fifth of the distance to the
farther end of its range, with a tolerance of 1e-9 of the robot's size. It prints the largest difference of positions
over that size. Exit codes: 0 all differences are within 1e-9, 1 one is not.
"""

import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
LIMIT = 1e-9


def solve(folder: Path) -> None:
    """Solves the scenes with the interpreter that runs this script."""
    import numpy as np

    import softkin

    warnings.simplefilter("ignore")
    for scene in sorted(EXAMPLES.glob("*/*.yaml")):
        try:
            robot = softkin.load(scene)
        except softkin.InvalidInput:  # materials or hardware instead of a scene
            continue
        rest = np.array(robot.rest_actuation)
        ends = np.array(robot.ranges).reshape(-1, 2)
        far = np.where(abs(ends[:, 0] - rest) > abs(ends[:, 1] - rest), ends[:, 0], ends[:, 1])
        commands = rest + 0.2 * (far - rest)
        shape = robot.solve(commands, solver=softkin.Solver(tolerance_mm=LIMIT * robot.diagonal_mm, threads=1)).require()
        np.save(folder / f"{scene.parent.name}.{scene.stem}.npy", shape.positions)


def main() -> int:
    import numpy as np

    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        for python, folder in ((sys.argv[1], one), (sys.argv[2], other)):
            subprocess.run([python, __file__, "--solve", folder], check=True)
        files = sorted(Path(one).iterdir())
        assert files and [file.name for file in files] == [file.name for file in sorted(Path(other).iterdir())]
        largest = 0.0
        for file in files:
            a, b = np.load(file), np.load(Path(other) / file.name)
            difference = float(abs(a - b).max() / np.linalg.norm(np.ptp(a, axis=0)))
            largest = max(largest, difference)
            print(f"{file.stem}: {difference:.1e} of its size")
    return int(not largest <= LIMIT)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--solve"]:
        solve(Path(sys.argv[2]))
    elif len(sys.argv) == 3:
        sys.exit(main())
    else:
        sys.exit(__doc__)
