from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import softkin
from softkin import calibrate


def reported(command: str, *arguments: object) -> Any:
    done = subprocess.run(
        [command, "calibrate", *map(str, arguments), "--json"], check=True, capture_output=True, text=True
    )
    return json.loads(done.stdout)


def test_tensile(examples: Path, command: str, tmp_path: Path) -> None:
    test = examples / "two_material_bar/tensile.csv"
    found = calibrate.tensile(test)
    assert found.report == reported(command, "material", "--tensile", test)
    assert found.failure == "" and "materials:" in found.materials and len(found.residuals) > 10
    found.save(tmp_path / "m.yaml")
    assert (tmp_path / "m.yaml").read_text() == found.materials
    found.save_plot(tmp_path / "m.svg")
    assert "law" in repr(found)
    with pytest.raises(ValueError, match="law must be linear"):
        calibrate.tensile(test, law="hookean")


def test_material(examples: Path, command: str) -> None:
    file, fractions = examples / "two_material_bar/specimens.csv", []
    found = calibrate.material(file, formulation="physical", cells=1, progress=fractions.append)
    options = ("--formulation", "physical", "--cells", 1, "--width", 20, "--grip", "clamped", "--law", "neo-hookean")
    expected = reported(command, "material", file, *options, "--poisson-ratio", 0.45)
    assert found.report == expected  # nothing is marked as a default where all is given
    assert found.failure == "" and fractions
    for keywords, message in (
        ({"grip": "glued"}, "grip must be"),
        ({"formulation": "x"}, "formulation must be"),
        ({"width_mm": 0}, "width_mm must be greater than 0 mm, not 0"),
        ({"poisson_ratio": 0.5}, "poisson_ratio must be"),
        ({"stiffer_shape_ratio": 2}, "stiffer_shape_ratio must be"),
        ({"law": "yeoh"}, "law must take E and nu"),
    ):
        with pytest.raises(ValueError, match=message):
            calibrate.material(file, **keywords)  # type: ignore[arg-type]


def test_pressure(examples: Path, command: str, tmp_path: Path) -> None:
    test = examples / "three_chamber_actuator/measured/syringe.csv"
    volumes = ["--chamber-volume", "21mL", "--syringe-volume", "60mL", "--tube-volume", "1.5mL"]
    found = calibrate.pressure(test, chamber_volume="21mL", syringe_volume=60e3, tube_volume="1.5mL")
    assert found.report == reported(command, "pressure", test, *volumes)
    loading = found.loading
    assert loading.input.shape == loading.ratio.shape and loading.ratio[0] == 1
    assert found.ratio(float(loading.input[1])) == pytest.approx(loading.ratio[1])
    assert loading.spread.size in (0, loading.ratio.size)
    assert found.unloading is None or found.unloading.input.size > 1
    assert found.samples.shape[1] == 4 and len(found.samples) > 10
    assert found.prediction is None and found.rows is not None
    subprocess.run([command, "calibrate", "pressure", test, *volumes, "--table", tmp_path / "rows.csv"], check=True)
    assert found.rows.csv() == (tmp_path / "rows.csv").read_text()
    found.save(tmp_path / "air.yaml")
    found.save_plot(tmp_path / "air.svg")
    assert "loading" in repr(found) and "made by softkin" in (tmp_path / "air.yaml").read_text()
    with pytest.raises(softkin.InvalidInput):
        found.ratio(1e6)
    with pytest.raises(ValueError, match="chamber_volume at rest is not known"):
        calibrate.pressure(test, syringe_volume="60mL")
    with pytest.raises(softkin.InvalidInput, match="syringe_volume"):
        calibrate.pressure(test, syringe_volume="60 buckets", chamber_volume=1)
    with pytest.raises(ValueError, match="scale must be"):
        calibrate.pressure(test, syringe_volume="60mL", chamber_volume=1, scale="torr")


def test_pressure_of_a_robot(robot: softkin.Robot, examples: Path) -> None:
    test = examples / "three_chamber_actuator/measured/syringe.csv"
    with pytest.raises(softkin.InvalidInput, match="several pneumatic actuators: say which one"):
        calibrate.pressure(test, syringe_volume="60mL", robot=robot)
    with pytest.raises(softkin.InvalidInput, match="there is no pneumatic actuator 'air9'"):
        calibrate.pressure(test, syringe_volume="60mL", robot=robot, actuator="air9")
    with pytest.raises(softkin.InvalidInput):  # a chamber of 0.5 mL does not hold what the syringe gave
        calibrate.pressure(test, syringe_volume="60mL", robot=robot, actuator="air1")
    with pytest.raises(ValueError, match="predict needs robot="):
        calibrate.pressure(test, syringe_volume="60mL", chamber_volume="21mL", predict=True)


def test_predicted_pressures(examples: Path, command: str) -> None:
    folder = examples / "three_chamber_actuator"
    test, scene = folder / "measured/syringe.csv", folder / "three_chamber_actuator.yaml"
    options = ["--syringe-volume", "60mL", "--tube-volume", "1.5mL", "--scene", scene, "--actuator", "air1"]
    found = calibrate.pressure(
        test, syringe_volume="60mL", tube_volume="1.5mL", robot=softkin.load(scene), actuator="air1", predict=True
    )
    assert found.report == reported(command, "pressure", test, *options, "--predict")
    prediction = found.prediction
    assert prediction is not None and prediction.complete and set(prediction.checks) == {"loading", "unloading"}
    assert prediction.ratio.shape == prediction.pressure_kPa.shape == (8,)
    check = prediction.checks["loading"]
    assert check.factor == pytest.approx(0.8, abs=0.01) and check.misfit_after < check.misfit_before
    assert "suggestion: material" in repr(found)


def test_material_goes_on_where_it_was(examples: Path, tmp_path: Path) -> None:
    file, store = examples / "two_material_bar/specimens.csv", tmp_path / "tests.run"
    whole = calibrate.material(file, formulation="physical", cells=2)

    def stop(fraction: float) -> None:
        if store.exists() and fraction > 0:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        calibrate.material(file, formulation="physical", cells=2, store=store, progress=stop)
    assert store.exists()
    again = calibrate.material(file, formulation="physical", cells=2, store=store)
    assert again.report == whole.report and not store.exists()


def test_material_warnings_and_refusals(examples: Path, tmp_path: Path) -> None:
    file = tmp_path / "forces.csv"
    file.write_text("l_mm,l1_mm,dl_mm,dl1_mm,force_n,area_mm2\n52,20,8.88,1.2,10,100\n")
    with pytest.raises(softkin.InvalidInput, match="^a modulus of B is for specimens without a force"):
        calibrate.material(file, modulus_b_MPa=1)
    with pytest.warns(softkin.SoftkinWarning, match="the area is 100 mm.2, .*; its width and height set it"):
        calibrate.material(file, formulation="physical", cells=1)


def test_dea(examples: Path, command: str) -> None:
    test = examples / "dea_crawler/measured/voltage.csv"
    assert calibrate.dea(test).report == reported(command, "dea", test)
    computed = calibrate.dea(law="neo-hookean", shear_modulus_MPa=0.07, permittivity=4.4, thickness_mm=0.5, prestretch=2)
    assert computed.ratio(0) == pytest.approx(1) and computed.samples.shape == (0, 4)
    with pytest.raises(ValueError, match="give either tests or law"):
        calibrate.dea()
    stiff = ["--law", "gent", "--shear-modulus", "0.045", "--stretch-limit", "120", "--permittivity", "4.7", "--thickness", "1"]
    kept = calibrate.dea(
        law="gent", shear_modulus_MPa=0.045, stretch_limit=120, permittivity=4.7, thickness_mm=1, prestretch=2,
        loading="constrained", prestretch_across=3,
    )  # fmt: skip
    more = ["--prestretch", "2", "--loading", "constrained", "--prestretch-across", "3"]
    assert kept.report == reported(command, "dea", *stiff, *more)
    with pytest.raises(ValueError, match="law must be"):
        calibrate.dea(law="rubber")
    with pytest.raises(ValueError, match="loading must be"):
        calibrate.dea(law="gent", loading="shear")
    with pytest.raises(ValueError, match="^prestretch_across is for loading='constrained'"):
        calibrate.dea(law="gent", prestretch_across=2)
    with pytest.raises(softkin.InvalidInput, match="^the law gent needs the elastomer's permittivity, relative to vacuum$"):
        calibrate.dea(law="gent", shear_modulus_MPa=0.07)


def test_relaxation(examples: Path, command: str, tmp_path: Path) -> None:
    cycles, creep = examples / "acrylic_strip/cycles.csv", examples / "acrylic_strip/creep.csv"
    found = calibrate.relaxation(cycles, law="gent")
    assert found.report == reported(command, "relaxation", cycles, "--law", "gent")
    times = [branch["time_s"] for branch in found.report["branches"]]
    assert len(times) == 3
    for time, made in zip(times, (0.61, 6.56, 61.25)):
        assert abs(time["value"] - made) < 3.5 * time["deviation"]
    assert "viscosity: [{modulus: " in found.materials and len(found.residuals) == 3 * 121
    found.save(tmp_path / "m.yaml")
    found.save_plot(tmp_path / "p.svg")
    assert (tmp_path / "m.yaml").read_text() == found.materials and "gent with 3 branches" in repr(found)
    held = calibrate.relaxation(creep=[creep], law="gent", constants={"jm": 99.67}, branches=2)
    options = ("--law", "gent", "--constants", "jm=99.67", "--branches", 2)
    assert held.report == reported(command, "relaxation", "--creep", creep, *options)
    for keywords, message in (
        ({}, "give tests, creep or both"),
        ({"tests": cycles, "law": "hookean"}, "law must be"),
        ({"tests": cycles, "poisson_ratio": 0.5}, "poisson_ratio must be"),
        ({"tests": cycles, "area_mm2": 0}, "area_mm2 must be greater than 0"),
        ({"tests": cycles, "branches": -1}, "branches must be from 0 to 12"),
    ):
        with pytest.raises(ValueError, match=message):
            calibrate.relaxation(**keywords)  # type: ignore[arg-type]
    with pytest.raises(softkin.InvalidInput, match="no constant 'c10' of gent"):
        calibrate.relaxation(cycles, law="gent", constants={"c10": 1})


def test_shipped_relaxation_tests_are_those_that_their_script_makes(examples: Path, tmp_path: Path) -> None:
    folder = examples / "acrylic_strip"
    subprocess.run([sys.executable, folder / "make_tests.py", tmp_path], check=True)
    for name in ("cycles.csv", "creep.csv"):
        assert (tmp_path / name).read_text() == (folder / name).read_text()


def test_the_shipped_syringe_reads_what_the_chamber_did(examples: Path, tmp_path: Path) -> None:
    """Of a cycle to 40 kPa and back: the branches of the calibration are those of the report."""
    up = [(0.0, 1.0), (20.0, 1.4), (40.0, 1.9)]
    down = [(20.0, 1.5), (0.0, 1.06)]
    steps = [
        {"time_s": float(time), "actuators": {"air": {"pressure_kPa": p, "achieved": ratio}}}
        for time, (p, ratio) in enumerate(up + down)
    ]
    report, test = tmp_path / "fast.json", tmp_path / "syringe.csv"
    report.write_text(json.dumps({"steps": steps}))
    script = examples / "pneumatic_finger" / "cycles" / "syringe.py"
    subprocess.run([sys.executable, script, test, report], check=True)
    found = calibrate.pressure(test, chamber_volume="22518mm3", syringe_volume="60mL")
    for p, ratio in up:
        assert found.ratio(p) == pytest.approx(ratio, abs=1e-5)
    assert found.unloading is not None
    for p, ratio in down:
        nearest = int(abs(found.unloading.input - p).argmin())
        assert found.unloading.input[nearest] == pytest.approx(p, abs=1e-4)
        assert found.unloading.ratio[nearest] == pytest.approx(ratio, abs=1e-5)


def test_a_robot_from_its_poses(examples: Path, command: str, tmp_path: Path) -> None:
    scenes = examples.parent / "docs" / "scenes"
    scene, poses = scenes / "finger_order_1.yaml", scenes / "finger_poses.csv"
    reported: list[tuple[int, float]] = []
    found = calibrate.robot(
        scene,
        poses,
        fit={"materials.body.youngs_modulus": (45, 10, 100), "base.ry": None, "base.z": 0.0},
        keep=2,
        progress=lambda iteration, rms_mm: reported.append((iteration, rms_mm)),
    )
    assert found.converged and reported
    assert found.values["materials.body.youngs_modulus"] == pytest.approx(38, abs=0.1)
    assert found.values["base.z"] == pytest.approx(1.5, abs=3 * found.deviations["base.z"])
    options = ["--fit", "materials.body.youngs_modulus=45,10,100", "--fit", "base.ry", "--fit", "base.z", "--keep", "2", "--json"]
    printed = json.loads(subprocess.run([command, "calibrate", "robot", scene, poses, *options], capture_output=True, check=True).stdout)
    for report in (printed, found.report):
        report.pop("seconds")
    assert printed["numbers"] == found.report["numbers"]
    assert len(found.readings) == 7 * 5 - 2  # two were not read
    bent = found.robot().solve({"air": 1.5})
    assert bent.actuators["air"].pressure_kPa == pytest.approx(965, abs=4)
    found.save_plot(tmp_path / "fit.svg")
    assert "measured" in (tmp_path / "fit.svg").read_text()


def test_dots_without_names(examples: Path, command: str, tmp_path: Path) -> None:
    scenes = examples.parent / "docs" / "scenes"
    scene, poses = scenes / "finger_order_1.yaml", scenes / "finger_dots.csv"
    fit = {"materials.body.youngs_modulus": (45, 10, 100), "base.ry": None, "base.z": None}
    found = calibrate.robot(scene, poses, fit=fit, match_within_mm=5)
    assert found.converged
    assert found.values["materials.body.youngs_modulus"] == pytest.approx(38, abs=0.1)
    assert found.report["dots"] == {"within_mm": 5.0, "seen": 14, "matched": 13, "doubtful": 0}
    assert found.report["poses"][0]["dots"]["dot1"]["marker"] == "end"
    assert found.report["poses"][3]["dots"]["dot1"]["marker"] is None
    options = ["--fit", "materials.body.youngs_modulus=45,10,100", "--fit", "base.ry", "--fit", "base.z", "--match-within", "5", "--json"]
    printed = json.loads(subprocess.run([command, "calibrate", "robot", scene, poses, *options], capture_output=True, check=True).stdout)
    assert printed["numbers"] == found.report["numbers"]
    found.save_plot(tmp_path / "dots.svg")
    assert "no marker" in (tmp_path / "dots.svg").read_text()
    with pytest.raises(softkin.InvalidInput, match="dots without names"):
        calibrate.robot(scene, poses, fit=["base.z"])
    with pytest.raises(ValueError, match="match_within_mm"):
        calibrate.robot(scene, poses, match_within_mm=0)


def test_outlines_in_pictures(examples: Path, tmp_path: Path) -> None:
    scenes = examples.parent / "docs" / "scenes"
    scene, poses, table = scenes / "finger_pressure.yaml", scenes / "finger_pictures.csv", tmp_path / "outlines.csv"
    given = {"camera.rx": -90}
    known = {"materials.body.youngs_modulus": 38}
    bent = softkin.load(scene, changes=known)
    # along the lower side, which is flat at rest, and back from tooth to tooth; then what is nearest of the outline
    low, high = bent.rest[:, 2] < 1e-6, bent.rest[:, 2] > bent.rest[:, 2].max() - 1e-6
    places = []
    for pressure in (0, 700, 1200):
        shape = bent.solve({"air": pressure}).positions
        forth, back = bent.rest[low, 0].argsort(), (-bent.rest[high, 0]).argsort()
        places.append(np.vstack([shape[low][forth], shape[high][back]])[:, [0, 2]])
    write_outlines(table, places)
    rough = calibrate.robot(scene, poses, changes=known, outlines=table, outline_points=60, given=given)
    nearest = rough.readings["computed"].reshape(-1, 2)
    write_outlines(table, np.split(nearest, np.flatnonzero(np.diff(rough.readings["pose"][::2])) + 1))

    fit = {"materials.body.youngs_modulus": (45, 10, 100), "base.z": None}
    found = calibrate.robot(scene, poses, fit=fit, outlines=table, outline_points=50, outline_within_mm=3, given=given)
    assert found.converged
    assert found.values["materials.body.youngs_modulus"] == pytest.approx(38, rel=0.01)
    assert found.report["given"] == given and found.report["outlines"]["within_mm"] == 3
    assert found.report["poses"][1]["outline"]["picture"] == 2
    found.save_plot(tmp_path / "fit.svg")
    assert "computed outline" in (tmp_path / "fit.svg").read_text()
    (tmp_path / "poses.csv").write_text("air_kPa,tip_x_mm\n0,120\n")
    with pytest.raises(softkin.InvalidInput, match="no column 'picture'"):
        calibrate.robot(scene, tmp_path / "poses.csv", outlines=table)
    with pytest.raises(ValueError, match="outline_points"):
        calibrate.robot(scene, poses, outlines=table, outline_points=0)
    with pytest.raises(ValueError, match="outline_within_mm"):
        calibrate.robot(scene, poses, outlines=table, outline_within_mm=0)


def write_outlines(file: Path, places: list[NDArray[np.float64]]) -> None:
    rows = [f"{number},{x!r},{y!r}" for number, some in enumerate(places, 1) for x, y in some.tolist()]
    file.write_text("\n".join(["picture,x_mm,y_mm", *rows]) + "\n")


def test_a_robot_from_its_poses_refuses(examples: Path, tmp_path: Path) -> None:
    scenes = examples.parent / "docs" / "scenes"
    scene, poses = scenes / "finger_order_1.yaml", scenes / "finger_poses.csv"
    with pytest.raises(softkin.InvalidInput, match="youngs"):
        calibrate.robot(scene, poses, fit={"materials.body.youngs": None})
    with pytest.raises(ValueError, match="loss"):
        calibrate.robot(scene, poses, loss="least")
    with pytest.raises(softkin.InvalidInput, match="7 poses"):
        calibrate.robot(scene, poses, fit=["base.z"], keep=7)
    (tmp_path / "poses.csv").write_text("air,top_x_mm\n1,120\n")
    with pytest.raises(softkin.InvalidInput, match="no marker 'top'"):
        calibrate.robot(scene, tmp_path / "poses.csv")
