"""First bend: the pneumatic finger is blown up in steps; its tip, its pressure and a picture."""

# %%
from shipped import EXAMPLES

import softkin

robot = softkin.load(EXAMPLES / "pneumatic_finger/pneumatic_finger.yaml")
print(robot)

# %%
shape = robot.solve()
for air in (1.2, 1.4):
    shape = robot.solve(air=air, start=shape).require()  # raises where no equilibrium was found
    x, y, z = shape["tip"]
    pressure = shape.actuators["air"].pressure_kPa
    print(f"air {air:.1f} of the volume at rest: {pressure:6.1f} kPa, tip at ({x:6.2f}, {y:5.2f}, {z:6.2f}) mm")

# %%
shape.save("first_bend.png")
print("picture: first_bend.png")
shape  # in a notebook: its picture
