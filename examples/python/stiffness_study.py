"""A study on all cores: how far a beam bends under 20 kPa, by the stiffness of its material."""

# %%
from concurrent.futures import ProcessPoolExecutor

import numpy as np
from beam import three_chamber_beam

import softkin

PRESSURE_KPA = 20.0


def bend(youngs_modulus: float) -> tuple[float, float]:
    """Young's modulus [MPa]; how far the tip is moved [mm] by PRESSURE_KPA in the first chamber."""
    robot = three_chamber_beam(youngs_modulus)
    low, high = 1.0, 2.0  # of the chamber's volume: the one that takes the pressure, by bisection
    shape = robot.solve()
    rest = shape["tip"]
    while high - low > 1e-4:
        middle = (low + high) / 2
        shape = robot.solve(air1=middle, start=shape, solver=softkin.Solver(threads=1)).require()
        low, high = (middle, high) if shape.actuators["air1"].pressure_kPa < PRESSURE_KPA else (low, middle)
    return youngs_modulus, float(np.linalg.norm(shape["tip"] - rest))


# %%
if __name__ == "__main__":  # processes that are not forked (macOS, Windows) take bend from a file, not from a notebook
    with ProcessPoolExecutor() as pool:
        for youngs_modulus, moved in pool.map(bend, np.geomspace(0.2, 2, 8)):
            print(f"{youngs_modulus:5.2f} MPa: {moved:6.3f} mm")
