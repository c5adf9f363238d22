"""Plots with matplotlib: pressure and tip of the pneumatic finger by its volume."""

# %%
import matplotlib.pyplot as plt
import numpy as np
from shipped import EXAMPLES

import softkin

robot = softkin.load(EXAMPLES / "pneumatic_finger/pneumatic_finger.yaml")
volumes = np.linspace(1, 1.5, 6)
shapes = [shape.require() for shape in robot.path(volumes[:, None])]
tips = np.array([shape["tip"] for shape in shapes])

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
left.plot(volumes, [shape.actuators["air"].pressure_kPa for shape in shapes], "o-")
left.set(xlabel="volume over that at rest [-]", ylabel="gauge pressure [kPa]")
right.plot(tips[:, 0], tips[:, 2], "o-")
right.set(xlabel="x [mm]", ylabel="z [mm]", title="tip", aspect="equal")
figure.savefig("plots.png", dpi=120)
print("picture: plots.png")
