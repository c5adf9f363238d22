"""Inverse kinematics: volumes that put the tip of an arm at a place, one out of reach, and along a path."""

# %%
import numpy as np
from shipped import EXAMPLES

import softkin

arm = softkin.load(EXAMPLES / "three_chamber_actuator/three_chamber_actuator.yaml")
answer = arm.inverse(tip=(10, 4, 140))
print(answer)
print("volumes over those at rest:", {name: round(ratio, 4) for name, ratio in answer.actuation.items()})

# %%
far = arm.inverse(tip=(300, 0, 0))
print(f"300 mm away: {far.status}, {far.error_mm:.1f} mm short: {far.reason}")

# %%
turns = np.linspace(0, 2 * np.pi, 13)
circle = np.column_stack([8 * np.cos(turns), 8 * np.sin(turns), np.full(13, 140.0)])  # [mm]
run = arm.follow(circle, marker="tip")
for waypoint in run:
    print(f"waypoint {waypoint.number}: {waypoint.status}, {waypoint.error_mm:.4f} mm off")
print(run.commands)

# %%
run.commands  # in a notebook: a table
