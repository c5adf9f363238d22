from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beams import beam, block

import softkin

CLAMPED = {
    "materials": [{"youngs_modulus": 1, "poisson_ratio": 0.4}],
    "fixed": [{"halfspace": {"point": (0, 0, 0), "normal": (-1, 0, 0)}}],
}


def test_properties(robot: softkin.Robot) -> None:
    assert robot.name == "beam"
    assert robot.formulation == "physical"
    assert len(robot.fingerprint) == 16
    assert robot.rest.shape == (324, 3) and not robot.rest.flags.writeable
    assert robot.tetrahedra.shape[1] == 4 and robot.prisms.shape == (0, 6) and robot.edge_nodes.shape == (0, 6)
    assert robot.element_regions.shape == robot.element_materials.shape == (len(robot.tetrahedra),)
    assert robot.actuators == ["air1", "air2", "air3"]
    assert [info.kind for info in robot.actuator_infos] == ["pneumatic"] * 3
    assert robot.actuator_infos[0].control == "volume" and robot.actuator_infos[0].unit == ""
    assert robot.actuator_infos[0].column == "air1" and robot.actuator_infos[0].load_key == "pressure_kPa"
    assert robot.actuator_infos[0].command_text(1.5) == "1.5" and robot.actuator_infos[0].rest == 1
    assert robot.markers == ["tip"] and robot.supports == ["base"]
    assert robot.materials == ["all"] and "chamber1" in robot.region_names
    assert robot.rest_actuation.tolist() == [1, 1, 1]
    assert robot.ranges.tolist() == [[1, 2]] * 3
    assert robot.diagonal_mm == pytest.approx(np.sqrt(64**2 + 2 * 20**2))
    assert isinstance(robot.notes, list) and robot.warnings
    assert "324 vertices" in repr(robot) and "air1: volume 1 to 2" in repr(robot)
    assert "<table>" in robot._repr_html_()


def test_warnings_are_raised() -> None:
    with pytest.warns(softkin.SoftkinWarning, match="elements thick"):
        beam()


def test_every_key_of_a_scene_from_memory(examples: Path) -> None:
    """A scene's parts given as arrays and dicts make the robot of the scene."""
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    robot = softkin.Robot(
        vertices,
        tetrahedra,
        regions={
            "stiff": {"box": ((40, 0, 0), (60, 20, 20))},
            "all_of_it": np.ones(len(tetrahedra), bool),
            "first": [0, 1, 2],
            "corner": {"vertices": [0]},
            "face": tetrahedra[:1, :3],
        },
        materials=[
            {"youngs_modulus": 1.0, "poisson_ratio": 0.4, "density": 1000, "shape_ratio": 0.5},
            {"region": "stiff", "law": "mooney-rivlin", "c10": 0.3, "c01": 0.05, "bulk_modulus": 80},
        ],
        fixed=CLAMPED["fixed"],
        rigid=["first"],
        actuators=[
            {"name": "tendon", "kind": "cable", "points": [(0, 10, 20), (60, 10, 20)], "control": "tension", "range": (0, 2)}
        ],
        markers=[{"name": "tip", "point": (60, 10, 10)}, {"name": "c", "region": "corner"}],
        gravity=(0, 0, -9.81),
        forces=[{"name": "payload", "point": (60, 10, 10), "force": (0, 0, -0.01)}],
        formulation="physical",
        order=2,
    )
    assert robot.edge_nodes.shape == (len(tetrahedra), 6)
    shape = robot.solve(tendon="0.5 N").require()
    assert shape.actuators["tendon"].tension_N == pytest.approx(0.5)
    assert shape["tip"][2] != pytest.approx(10)


def test_curved_edges_make_a_rod_round() -> None:
    vertices, tetrahedra = block((6, 4, 4), (60, 20, 20))  # pushed onto a rod of 10 mm radius
    across = vertices[:, 1:] - 10
    length = np.maximum(np.hypot(across[:, 0], across[:, 1]), 1e-30)
    vertices[:, 1:] = 10 + across * (np.abs(across).max(axis=1) / length)[:, None]

    def radii(robot: softkin.Robot) -> np.ndarray:
        return np.hypot(robot.rest[:, 1] - 10, robot.rest[:, 2] - 10)

    with pytest.warns(softkin.SoftkinWarning, match="The edges are straight"):
        straight = softkin.Robot(vertices, tetrahedra, order=2, **CLAMPED)
    on_surface = radii(straight) > 9.7  # edges through the inside at the corners of the block are shorter

    def min_radius(robot: softkin.Robot) -> float:
        return float(radii(robot)[on_surface].min())

    assert min_radius(straight) < 9.82  # sixteen corners: 10 cos(180 / 16 degrees)
    for curve in (True, {"cylinder": {"start": (0, 10, 10), "end": (60, 10, 10), "radius": 10}}):
        robot = softkin.Robot(vertices, tetrahedra, order=2, curve=curve, **CLAMPED)
        assert any("'curve' moved" in note for note in robot.notes)
        assert min_radius(robot) > 9.86  # a few are held back where elements are flat
    with pytest.raises(softkin.InvalidInput, match="order: 2"):
        softkin.Robot(vertices, tetrahedra, curve=True, **CLAMPED)


def test_units() -> None:
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    in_mm = softkin.Robot(vertices, tetrahedra, **CLAMPED)
    in_m = softkin.Robot(vertices / 1000, tetrahedra, units="m", **CLAMPED)
    np.testing.assert_allclose(in_m.rest, in_mm.rest, rtol=1e-14)


def test_arrays_of_any_layout_and_type() -> None:
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    plain = softkin.Robot(vertices, tetrahedra, **CLAMPED)
    other = softkin.Robot(np.asfortranarray(vertices), tetrahedra.astype(np.uint16).tolist(), **CLAMPED)
    assert plain.fingerprint == other.fingerprint


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"vertices": np.zeros((4, 2))}, r"vertices must have shape \(n, 3\), not \(4, 2\)"),
        ({"vertices": [[0, 0, np.nan]]}, r"vertices\[0, 2\] is nan; every value must be finite"),
        ({"vertices": "no"}, r"vertices must be an array of numbers of shape \(n, 3\)"),
        ({"tetrahedra": [[0, 1, 2]]}, r"tetrahedra must have shape \(n, 4\), not \(1, 3\)"),
        ({"tetrahedra": [[0, 1, 2, 999]]}, "tetrahedra holds 999, but there are 63 vertices, numbered from 0"),
        ({"tetrahedra": [[0.5, 1, 2, 3]]}, "tetrahedra must hold whole numbers, not float64"),
        ({"regions": {"r": [-1]}}, "regions: r holds -1, but there are 144 tetrahedra"),
        ({"regions": {"r": np.ones(3, bool)}}, r"regions: r must have shape \(144,\), a truth per tetrahedron, not \(3,\)"),
        ({"regions": {"r": {"bax": 1}}}, r"regions\[0\]"),
        ({"materials": [{"youngs_modulus": -1, "poisson_ratio": 0.4}]}, r"materials\[0\]\.youngs_modulus: .*greater than 0"),
        ({"materials": [{"youngs_modulos": 1}]}, r"materials\[0\]\.youngs_modulos: unknown key .*did you mean 'youngs_modulus'"),
        ({"materials": [{"youngs_modulus": "1", "poisson_ratio": 0.4}]}, "must be a finite number, not the quoted text '1'"),
        ({"fixed": [{"region": "bsae"}]}, r"fixed\[0\]\.region: there is no region 'bsae'"),
        ({"markers": {"tip": (1, 2)}}, r"markers\[0\]\.point: .*a list of 3, not of 2"),
        ({"markers": [{"name": "a", "point": (1, 2, 3)}] * 2}, r"the name 'a' is taken; it is given in markers\[0\]\.name"),
        ({"formulation": "physics"}, "formulation.*must be one of"),
        ({"units": "feet"}, "must be one of 'mm'"),
    ],
)
def test_wrong_robots(changes: dict[str, Any], message: str) -> None:
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    given = {"vertices": vertices, "tetrahedra": tetrahedra, **CLAMPED, **changes}
    with pytest.raises(ValueError, match=message):
        softkin.Robot(given.pop("vertices"), given.pop("tetrahedra"), **given)


def test_wrong_scenes(tmp_path: Path) -> None:
    with pytest.raises(softkin.InvalidInput, match="nothing.yaml"):
        softkin.load(tmp_path / "nothing.yaml")
    scene = tmp_path / "s.yaml"
    scene.write_text("softkin: 1\nmesh: {fiel: a.msh}\n")
    with pytest.raises(softkin.InvalidInput, match=r"s\.yaml:2: unknown key 'fiel'.*did you mean 'file'"):
        softkin.load(scene)
    with pytest.raises(ValueError, match="formulation must be 'physical' or 'target-shape', not 'x'"):
        softkin.load(scene, formulation="x")


def test_weights() -> None:
    vertices, tetrahedra = block((2, 2, 2), (10, 10, 10))

    def made(weights: str | None) -> softkin.Robot:
        return softkin.Robot(
            vertices, tetrahedra, materials=[{"shape_ratio": 1}], fixed=[{"box": [[-1, -1, -1], [1, 11, 11]]}], weights=weights
        )

    assert made(None).fingerprint == made("printed").fingerprint != made("mesh-independent").fingerprint
    with pytest.raises(softkin.InvalidInput, match="must be one of 'printed', 'mesh-independent', not 'even'"):
        made("even")


def test_formulation_and_forces_of_a_scene(examples: Path) -> None:
    scene = examples / "three_tendon_finger/three_tendon_finger.yaml"
    assert softkin.load(scene).formulation == "physical"
    with pytest.raises(softkin.InvalidInput, match="forces 'payload=0.0,0.0,-1.0': no force 'payload'"):
        softkin.load(scene, forces={"payload": (0, 0, -1)})


def test_other_numbers_of_a_scene(examples: Path) -> None:
    scene = examples / "three_tendon_finger/three_tendon_finger.yaml"
    first = softkin.load(scene).actuators[0]
    path = f"actuators.{first}.range"
    assert softkin.load(scene, changes={path: (0.9, 1.0)}).ranges.tolist()[0] == [0.9, 1.0]
    assert softkin.load(scene, changes={f"{path}.1": 0.95}).ranges.tolist()[0][0] == 0.95
    with pytest.raises(softkin.InvalidInput, match="changes 'materals.1.density=1': there is no 'materals'.*'materials'"):
        softkin.load(scene, changes={"materals.1.density": 1})


def test_pickle_of_a_scene_needs_no_files(examples: Path, tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    folder.mkdir()
    for file in (examples / "three_tendon_finger").glob("three_tendon_finger.*"):
        (folder / file.name).write_bytes(file.read_bytes())
    robot = softkin.load(folder / "three_tendon_finger.yaml")
    state = pickle.dumps(robot)
    for file in folder.iterdir():
        file.unlink()
    again = pickle.loads(state)
    assert again.fingerprint == robot.fingerprint and again.name == robot.name
    assert pickle.loads(state) is again


def test_pickle_of_a_measured_curve(examples: Path) -> None:
    robot = softkin.load(examples / "three_chamber_actuator/measured/actuator.yaml")
    again = pickle.loads(pickle.dumps(robot))
    shape, same = robot.solve(air1=1.1), again.solve(air1=1.1)
    assert same.fingerprint == shape.fingerprint
    assert same.actuators["air1"].by_curve == shape.actuators["air1"].by_curve is not None


def test_several_robots_are_read_from_their_scenes(examples: Path, tmp_path: Path) -> None:
    for file in (examples / "cable_gripper").glob("cable_gripper.*"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    place = "place: {rotate: {axis: [1, 0, 0], degrees: 180}, translate: [0, 0, -100]}"
    (tmp_path / "pair.yaml").write_text(
        "softkin: 1\nrobots:\n  - {name: upper, scene: cable_gripper.yaml}\n"
        f"  - {{name: lower, scene: cable_gripper.yaml, {place}}}\n"
    )
    alone = softkin.load(tmp_path / "cable_gripper.yaml", formulation="target-shape")
    pair = softkin.load(tmp_path / "pair.yaml", formulation="target-shape")
    state = pickle.dumps(pair)
    for file in tmp_path.iterdir():
        file.unlink()
    again = pickle.loads(state)
    assert again.fingerprint == pair.fingerprint
    assert pair.actuators == ["upper.cable", "lower.cable"]
    assert pair.markers == ["upper.tip", "upper.top", "lower.tip", "lower.top"]
    np.testing.assert_allclose(pair.rest[: len(alone.rest)], alone.rest)
    tip = alone.solve({"cable": 0.95}).require()["tip"]
    placed = again.solve({"lower.cable": 0.95}).require()["lower.tip"]
    np.testing.assert_allclose(placed, tip * (1, -1, -1) + (0, 0, -100), atol=1e-2)
    assert abs(tip[2]) > 1


def test_damaged_pickles_are_refused(robot: softkin.Robot) -> None:
    from softkin import _core

    state = robot._core.pickled()
    with pytest.raises(softkin.InvalidInput, match="the pickle is damaged"):
        _core.Source.unpickled(state[:-1])
    with pytest.raises(softkin.InvalidInput, match="the pickle is damaged"):
        _core.Source.unpickled(state + b"x")
