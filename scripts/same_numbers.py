#!/usr/bin/env python3
"""Do two installations of softkin, a wheel and a native build, find the same shapes?

    scripts/same_numbers.py PYTHON OTHER_PYTHON

Solves every scene in examples with both interpreters, each actuator a fifth of the way to the farther end of its range, to
steps of 1e-9 of the robot's size, and prints the largest difference of positions over that size. Exit codes: 0 all within
1e-9, 1 not.
"""

import subprocess
import sys
import tempfile
import warnings
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
LIMIT = 1e-9


def solve(folder: Path) -> None:
    """With the interpreter that runs this."""
    import numpy as np

    import softkin

    warnings.simplefilter("ignore")
    for scene in sorted(EXAMPLES.glob("*/*.yaml")):
        try:
            robot = softkin.load(scene)
        except softkin.InvalidInput:  # materials, hardware: no scene of its own
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
        worst = 0.0
        for file in files:
            a, b = np.load(file), np.load(Path(other) / file.name)
            difference = float(abs(a - b).max() / np.linalg.norm(np.ptp(a, axis=0)))
            worst = max(worst, difference)
            print(f"{file.stem}: {difference:.1e} of its size")
    return int(not worst <= LIMIT)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--solve"]:
        solve(Path(sys.argv[2]))
    elif len(sys.argv) == 3:
        sys.exit(main())
    else:
        sys.exit(__doc__)
