"""Plots with matplotlib: pressure and tip of the pneumatic finger by its volume, and its workspace's trace."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # no window
import matplotlib.pyplot as plt
import numpy as np

import softkin

SCENE = Path(__file__).parents[1] / "pneumatic_finger" / "pneumatic_finger.yaml"


def main() -> None:
    robot = softkin.load(SCENE)
    volumes = np.linspace(1, 1.5, 6)
    shapes = [shape.require() for shape in robot.path(volumes[:, None])]
    tips = np.array([shape["tip"] for shape in shapes])
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    left.plot(volumes, [shape.actuators["air"].pressure_kPa for shape in shapes], "o-")
    left.set(xlabel="volume over that at rest [-]", ylabel="gauge pressure [kPa]")
    right.plot(tips[:, 0], tips[:, 2], "o-")
    right.set(xlabel="x [mm]", ylabel="z [mm]", title="tip", aspect="equal")
    figure.savefig("plots.png", dpi=120)
    print("picture: plots.png")


if __name__ == "__main__":
    main()
