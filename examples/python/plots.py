"""Plots with matplotlib: pressure and tip of an arm by the volume of one of its chambers."""

# %%
import matplotlib.pyplot as plt
import numpy as np
from shipped import EXAMPLES

import softkin

arm = softkin.load(EXAMPLES / "three_chamber_actuator/three_chamber_actuator.yaml")
volumes = np.linspace(1, 1.6, 7)
shapes = [shape.require() for shape in arm.path([{"air1": volume} for volume in volumes])]
tips = np.array([shape["tip"] for shape in shapes])

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
left.plot(volumes, [shape.actuators["air1"].pressure_kPa for shape in shapes], "o-")
left.set(xlabel="volume over that at rest [-]", ylabel="gauge pressure [kPa]")
right.plot(tips[:, 0], tips[:, 2], "o-")
right.set(xlabel="x [mm]", ylabel="z [mm]", title="tip", aspect="equal")
figure.savefig("plots.png", dpi=120)
print("picture: plots.png")
