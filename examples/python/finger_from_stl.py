"""From two STL files to a bending finger.

Writes skin and cavity of the shipped pneumatic finger as STL, as a CAD program would, meshes them anew, and bends both
fingers with 1.4 times the air.
"""

# %%
from pathlib import Path

import numpy as np
from shipped import EXAMPLES

import softkin
from softkin.mesh import from_surfaces, read_msh, write_stl

SHIPPED = EXAMPLES / "pneumatic_finger"
OUT = Path("out")
LENGTH = 120.0  # mm

OUT.mkdir(exist_ok=True)
shipped = read_msh(SHIPPED / "pneumatic_finger.msh")
write_stl(OUT / "skin.stl", shipped.boundary("body", "chamber"))
write_stl(OUT / "cavity.stl", shipped.boundary("chamber"))

# %%
mesh = from_surfaces(
    OUT / "skin.stl",
    {"chamber": OUT / "cavity.stl"},
    edge_length=3.5,
    regions={"base": "plane x=0", "tip": f"plane x={LENGTH}"},
)
print(mesh.summary())
mesh.write(OUT / "finger.msh")  # no two runs give the same

# %%
robot = softkin.Robot(
    mesh.vertices,
    mesh.tetrahedra,
    regions=mesh.regions,
    order=2,  # its walls are one element thick
    materials=[{"region": "body", "youngs_modulus": 45, "poisson_ratio": 0.45}],
    fixed=[{"region": "base"}],
    actuators=[{"name": "air", "kind": "pneumatic", "region": "chamber", "range": [1.0, 3.0]}],
    markers={"end": "tip"},
)
shape = robot.solve(air=1.4)
there = softkin.load(SHIPPED / "pneumatic_finger.yaml").solve(air=1.4)["end"]
apart = float(np.linalg.norm(shape["end"] - there))
print(f"end of the finger: {np.round(shape['end'], 1)} mm; of the shipped one: {np.round(there, 1)} mm")
print(f"apart: {apart:.2f} mm, {100 * apart / LENGTH:.2f} % of the length")
shape  # in a notebook: its picture
