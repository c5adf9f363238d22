"""Calibration from CSV files: the elastic law of a rubber from a tensile test, and the Young's moduli of two printed
materials from stretched bars of both; how well each fits what was measured.
"""

# %%
from shipped import EXAMPLES

import softkin
from softkin import calibrate
from softkin.mesh import read_msh

rubber = calibrate.tensile(EXAMPLES / "two_material_bar/tensile.csv")
linear, chosen = rubber.report["linear"], rubber.report["chosen"]
fit = rubber.report["laws"][chosen]
print(f"{linear['youngs_modulus_MPa']:.2f} MPa up to a strain of {100 * linear['end_strain']:.1f} %")
print(f"{chosen} to {len(rubber.residuals)} points: R^2 {fit['quality']['r_squared']:.4f}", end=", ")
print(f"off by {fit['quality']['rms_MPa']:.3f} MPa rms, {fit['quality']['largest_MPa']:.3f} MPa at most")
rubber.save_plot("rubber.svg")

# %%
bars = calibrate.material(EXAMPLES / "two_material_bar/specimens.csv", formulation="physical", cells=2)
moduli = bars.report["physical"]["moduli"]
spread = 100 * moduli["relative_spread"]
print(f"moduli of the two materials: {moduli['a_MPa']:.2f} and {moduli['b_MPa']:.2f} MPa, spread {spread:.2f} %")
print("their interface, measured and as the calibrated bar moves it:")
print(bars.residuals)

# %%
bars.residuals  # in a notebook: a table

# %%
# what goes into a scene, or materials= of a Robot; here into a bar of both that is pulled by 2 mm
bars.save("materials.yaml")
print(bars.materials)
bar = read_msh(EXAMPLES / "two_material_bar/two_material_bar.msh")
robot = softkin.Robot(
    bar.vertices,
    bar.tetrahedra,
    regions=bar.regions,
    order=2,
    materials=[
        {"region": "A", "youngs_modulus": moduli["a_MPa"], "poisson_ratio": 0.45},
        {"region": "B", "youngs_modulus": moduli["b_MPa"], "poisson_ratio": 0.45},
    ],
    fixed=[{"region": "base"}, {"region": "free_end", "displacement": (2, 0, 0)}],
    markers={"interface": "interface"},
)
moved = robot.solve()["interface"][0] - 50
print(f"interface at 50 mm moved by {moved:.3f} mm; measured: {bars.residuals['dl1_mm'][2]} mm")
