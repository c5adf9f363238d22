from __future__ import annotations

import gc
import pickle
from pathlib import Path

import numpy as np
import pytest
from beams import beam, block

import softkin


@pytest.fixture(scope="module")
def shape(robot: softkin.Robot) -> softkin.Shape:
    return robot.solve(air1=1.3)


def test_what_it_tells(shape: softkin.Shape, robot: softkin.Robot) -> None:
    assert shape.robot is robot
    assert shape.converged and shape.status == "converged" and shape.reached == 1 and shape.remark == ""
    assert shape.iterations > 0 and shape.seconds > 0 and shape.unstable_modes == 0
    assert shape.require() is shape
    assert shape.actuation.tolist() == [1.3, 1, 1]
    air = shape.actuators["air1"]
    assert air.requested == 1.3 and air.ratio == pytest.approx(1.3) and air.unit == "" and not air.slack
    assert air.volume_mm3 == air.measure == pytest.approx(1.3 * robot.actuator_infos[0].rest_measure)
    assert air.pressure_kPa == air.load > 0 and air.by_curve is None
    with pytest.raises(AttributeError, match="air1' is a pneumatic: it has no tension"):
        air.tension_N
    with pytest.raises(AttributeError, match="no length"):
        air.length_mm
    with pytest.raises(AttributeError, match="no area"):
        air.area_mm2
    assert list(shape.markers) == ["tip"] and len(shape.markers) == 1
    np.testing.assert_array_equal(shape["tip"], shape.markers["tip"])
    np.testing.assert_allclose(shape.displacements, shape.positions - robot.rest)
    with pytest.raises(softkin.InvalidInput, match="no marker 'tipp'; did you mean 'tip'"):
        shape["tipp"]


def test_turned_support() -> None:
    rest = beam()
    turning = beam(fixed=[{"region": "base", "rotation": {"axis": [0, 0, 1], "about": [0, 0, 0]}}])
    info = turning.actuator_infos[-1]
    assert (info.name, info.kind, info.unit) == ("base_turn", "turn", "deg")
    shape = turning.solve(base_turn=90)
    x, y, z = rest.rest.T
    np.testing.assert_allclose(shape.positions, np.stack([-y, x, z], axis=1), atol=1e-6)
    assert shape.actuators["base_turn"].requested == 90 and shape.actuators["base_turn"].unit == "deg"


def test_layer_under_voltage(examples: Path) -> None:
    crawler = softkin.load(examples / "dea_crawler/voltage/crawler.yaml")
    (info,) = crawler.actuator_infos
    assert (info.control, info.unit, info.column, info.load_key) == ("voltage", "kV", "skin_kV", "voltage_kV")
    shape = crawler.solve(skin=5)
    skin = shape.actuators["skin"]
    assert skin.requested == skin.voltage_kV == skin.load == 5 and skin.unit == "kV"
    assert skin.charge_nC is not None and skin.capacitance_pF is not None and skin.field_kV_mm is not None
    assert skin.charge_nC == pytest.approx(5 * skin.capacitance_pF)  # nC = pF kV
    assert 5 / 1.5 < skin.field_kV_mm * 0.5 < 5 * 1.5  # the layer is about 0.5 mm thick
    assert "5 kV" in shape._repr_html_()
    area = softkin.load(examples / "dea_crawler/dea_crawler.yaml").solve().actuators["skin"]
    assert area.charge_nC is None and area.load is None
    with pytest.raises(AttributeError, match="no voltage: its area is controlled"):
        area.voltage_kV


def test_positions_are_read_only_and_outlive_everything() -> None:
    positions = beam().solve(air1=1.2).positions
    before = positions.copy()
    gc.collect()
    assert not positions.flags.writeable
    with pytest.raises(ValueError):
        positions[0, 0] = 1
    np.testing.assert_array_equal(positions, before)


def test_deformation(shape: softkin.Shape, robot: softkin.Robot) -> None:
    deformation, elements = shape.deformation, len(robot.tetrahedra)
    assert deformation.volume_ratio.shape == deformation.von_mises_MPa.shape == (elements,)
    assert deformation.strain.shape == deformation.principal_stress_MPa.shape == (elements, 3)
    assert not deformation.inverted.any()
    np.testing.assert_allclose(deformation.stretches.prod(axis=1), deformation.volume_ratio, rtol=1e-9)
    assert (np.diff(deformation.strain) <= 0).all()
    assert deformation.von_mises_MPa.max() > 0


def test_reactions_balance(shape: softkin.Shape) -> None:
    base = shape.reactions["base"]
    assert base.name == "base"
    np.testing.assert_allclose(base.force_N, 0, atol=1e-6)  # closed chambers push at nothing outside
    np.testing.assert_allclose(shape.vertex_reactions.sum(axis=0), base.force_N, atol=1e-9)
    assert base.moment_Nmm.shape == base.center_mm.shape == (3,)


def test_what_touches(shape: softkin.Shape) -> None:
    assert shape.contacts == [] and shape.contact_pressure_kPa.shape == (0,)
    floor = {"name": "floor", "halfspace": {"point": [0, 0, -0.1], "normal": [0, 0, 1]}}
    load = {"name": "load", "region": "end", "force": [0, 0, -0.5]}
    robot = beam(2, 2, actuators=[], forces=[load], obstacles=[floor])
    pressed = robot.solve()
    (contact,) = pressed.require().contacts
    assert (contact.on, contact.by) == ("robot", "floor")
    np.testing.assert_allclose(contact.force_N + pressed.reactions["base"].force_N, [0, 0, 0.5], atol=1e-6)
    assert contact.normal_N == pytest.approx(contact.force_N[2], rel=1e-9) and contact.normal_N > 0.1
    assert contact.moment_Nmm.shape == contact.center_mm.shape == (3,) and -0.1 < contact.center_mm[2] < 0.1
    assert contact.area_mm2 > 0 and 0 < contact.gap_mm < 0.1
    pressures = pressed.contact_pressure_kPa
    assert pressures.shape == (len(robot.rest),) and pressures.max() == contact.pressure_kPa
    assert pressed.report["steps"][0]["contacts"][0]["pressure_kPa"] == contact.pressure_kPa


@pytest.mark.parametrize("magnetisation", ["turns", "stretches"])
def test_magnets(magnetisation: str) -> None:
    vertices, tetrahedra = block((6, 2, 1), (24, 4, 2))
    middle = vertices[tetrahedra].mean(axis=1)
    robot = softkin.Robot(
        vertices,
        tetrahedra,
        regions={"base": {"vertices": np.flatnonzero(vertices[:, 0] == 0)}},
        materials=[
            {
                "youngs_modulus": 1,
                "poisson_ratio": 0.4,
                "remanence": {"places": middle, "samples": np.tile([100.0, 0, 0], (len(middle), 1))},
                "magnetisation": magnetisation,
            }
        ],
        fixed=[{"region": "base"}],
        actuators=[{"name": "field", "kind": "magnetic", "axes": ["y", "z"], "range": (-20, 20)}],
        markers={"tip": [24, 2, 1]},
    )
    assert [info.name for info in robot.actuator_infos] == ["field_y", "field_z"]
    assert {info.unit for info in robot.actuator_infos} == {"mT"}
    assert robot.actuator_infos[0].control == "flux density"
    shape = robot.solve(field_z=10)
    assert shape.markers["tip"][2] > 1.1
    load = shape.magnetic_load
    assert isinstance(load, softkin.MagneticLoad)
    np.testing.assert_allclose(load.force_N, 0, atol=1e-12)
    np.testing.assert_allclose(load.moment_Nmm + shape.reactions["base"].moment_Nmm, 0, atol=1e-6)
    assert 11 < load.center_mm[0] < 12.5
    assert shape.actuators["field_z"].ratio == 10
    assert "10 mT" in repr(shape)


def test_threads_and_loads_on_the_surface() -> None:
    """With nu 0 a thread along the pull adds its tension to that of the block, alone."""
    vertices, tetrahedra = block((4, 2, 2), (20, 10, 10))
    robot = softkin.Robot(
        vertices,
        tetrahedra,
        regions={
            "base": {"vertices": np.flatnonzero(vertices[:, 0] == 0)},
            "end": {"vertices": np.flatnonzero(vertices[:, 0] == 20)},
        },
        materials=[{"law": "corotational", "youngs_modulus": 1, "poisson_ratio": 0}],
        fixed=[{"region": "base"}],
        tractions=[{"name": "pull", "region": "end", "traction": [100, 0, 0]}],
        fibres=[{"name": "thread", "points": [[0, 5, 5], [20, 5, 5]], "stiffness": 1e-3}],
    )
    shape = robot.solve()
    thread = shape.fibres["thread"]
    assert isinstance(thread, softkin.Fibre)
    assert thread.stretch == pytest.approx(1.1, abs=1e-4)
    assert thread.mean_N == pytest.approx(1e-4, rel=1e-3) and thread.slack == 0
    assert thread.least_N <= thread.mean_N <= thread.largest_N
    assert pickle.loads(pickle.dumps(shape)).fibres["thread"].mean_N == pytest.approx(thread.mean_N)


def test_sealed_chambers_on_one_pipe() -> None:
    """Boyle's law: pressure times volume of all that is sealed, the syringe with it, is that at rest."""
    air = {
        "name": "air",
        "kind": "pneumatic",
        "connected": ["chamber1", "chamber2"],
        "control": "gas",
        "range": (-1, 3),
        "source": {"syringe_mL": 5, "dead_mL": 1},
    }
    robot = beam(actuators=[air])
    (info,) = robot.actuator_infos
    assert info.connected == ["chamber1", "chamber2"] and info.unit == "mL"
    shape = robot.solve(air=2)
    state = shape.actuators["air"]
    assert state.volumes_mL is not None and state.amount_mL is not None
    assert list(state.volumes_mL) == info.connected
    volume = sum(state.volumes_mL.values())
    assert volume == pytest.approx(state.volume_mm3 / 1000)
    rest = info.rest_measure / 1000
    assert state.amount_mL == pytest.approx(rest + 6)
    assert (101.325 + state.pressure_kPa) * (volume + 1 + 5 - 2) == pytest.approx(101.325 * state.amount_mL, rel=1e-9)


def test_no_magnets(shape: softkin.Shape) -> None:
    assert shape.magnetic_load is None


def test_overlap(shape: softkin.Shape) -> None:
    assert shape.self_overlap.points == 0 and shape.self_overlap.deepest_mm == 0
    assert shape.self_overlap.at_mm.shape == (3,)


def test_report(shape: softkin.Shape) -> None:
    step = shape.report["steps"][0]
    assert step["markers"]["tip"] == shape["tip"].tolist()
    assert step["actuators"]["air1"]["pressure_kPa"] == shape.actuators["air1"].pressure_kPa


def test_files_and_notebooks(shape: softkin.Shape, tmp_path: Path) -> None:
    for name in ("s.vtu", "s.png", "s.json"):
        shape.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
    shape.save(tmp_path / "above.png", view=(0, 0, 1))
    assert (tmp_path / "above.png").read_bytes() != (tmp_path / "s.png").read_bytes()
    assert shape._repr_png_() == shape.png() == (tmp_path / "s.png").read_bytes()
    assert shape.png().startswith(b"\x89PNG")
    assert "kPa" in shape._repr_html_()
    assert "air1=1.3" in repr(shape) and "tip at" in repr(shape)
    with pytest.raises(ValueError, match="path must end in .vtu, .png or .json, not 's.stl'"):
        shape.save(tmp_path / "s.stl")
    with pytest.raises(ValueError, match="view must be a direction"):
        shape.png((0, 0, 0))


def test_pickle(shape: softkin.Shape) -> None:
    again = pickle.loads(pickle.dumps(shape))
    assert again.fingerprint == shape.fingerprint and again.report == shape.report
    other = pickle.loads(pickle.dumps([shape, shape.robot]))
    assert other[0].robot is other[1]


def test_a_pickle_keeps_the_branch_of_a_limit() -> None:
    """The branch contains the points along the chamber's volume, with the limit point of its pressure."""
    air = {"name": "air", "kind": "pneumatic", "region": "chamber1", "control": "pressure", "range": (0, 5000)}
    shape = beam(4, 5, actuators=[air]).solve(air=5000)
    assert shape.status == "limit" and len(shape.report["steps"][0]["branch"]["ratio"]) > 2
    assert pickle.loads(pickle.dumps(shape)).report == shape.report


def test_solver_options(robot: softkin.Robot, shape: softkin.Shape) -> None:
    np.testing.assert_array_equal(robot.solve([1.3, 1, 1]).positions, shape.positions)
    np.testing.assert_array_equal(robot.solve({"air1": 1.3}).positions, shape.positions)
    np.testing.assert_array_equal(robot.solve(air1=1.3, solver=softkin.Solver(threads=2)).positions, shape.positions)
    warm = robot.solve(air1=1.3, start=shape)
    assert warm.iterations < shape.iterations
    placed = robot.solve(air1=1.3, start=shape.positions)
    assert placed.converged
    coarse = robot.solve(air1=1.3, solver=softkin.Solver(tolerance_mm=0.1))
    assert coarse.iterations <= shape.iterations


@pytest.mark.parametrize(
    ("arguments", "keywords", "message"),
    [
        ((), {"ari1": 1.2}, "no actuator 'ari1'; did you mean 'air1'"),
        ((), {"air1": 5}, "'air1': the ratio 5 is outside its range 1 to 2"),
        ((), {"air1": "five"}, "must be a finite number without unit"),
        ((), {"air1": float("nan")}, "air1 must be a finite number, not nan"),
        (([1, 1],), {}, r"actuation must have shape \(3,\), not \(2,\)"),
        (([1, 1, np.inf],), {}, r"actuation\[2\] is inf"),
        ((), {"start": np.zeros((3, 3))}, r"start must have shape \(324, 3\), not \(3, 3\)"),
        ((), {"tolerance_mm": -1}, "the tolerance must be a length > 0 in mm, not -1"),
        ((), {"max_iterations": 0}, "max_iterations must be at least 1, not 0"),
        ((), {"solver": "local-global"}, "is for the target-shape formulation"),
        ((), {"solver": "magic"}, "solver must be 'newton' or 'local-global', not 'magic'"),
    ],
)
def test_wrong_solves(robot: softkin.Robot, arguments: tuple[object, ...], keywords: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        robot.solve(*arguments, **keywords)  # type: ignore[arg-type]


def test_shape_of_another_robot(shape: softkin.Shape) -> None:
    other = beam(across=5, along=9)
    with pytest.raises(ValueError, match="start is a shape of another robot"):
        other.solve(start=shape)
    with pytest.raises(ValueError, match="shape is one of another robot"):
        other.jacobian(shape)


def test_target_shapes() -> None:
    vertices, tetrahedra = block((8, 2, 2), (80, 20, 20))
    robot = softkin.Robot(
        vertices,
        tetrahedra,
        materials=[{"shape_ratio": 0.5}],
        fixed=[{"halfspace": {"point": (0, 0, 0), "normal": (-1, 0, 0)}}],
        actuators=[{"name": "t", "kind": "cable", "points": [(0, 10, 20), (80, 10, 20)], "range": (0.5, 1)}],
        markers={"tip": (80, 10, 10)},
    )
    shape = robot.solve(t=0.9)
    assert robot.formulation == "target-shape" and shape.converged
    assert shape.actuators["t"].length_mm == pytest.approx(80 * shape.actuators["t"].ratio)
    with pytest.raises(AttributeError, match="only the physical formulation"):
        shape.actuators["t"].tension_N
    algorithm = robot.solve(t=0.9, solver="local-global")
    np.testing.assert_allclose(algorithm.positions, shape.positions, atol=0.01)
    lazy = robot.solve(t=0.9, solver=softkin.Solver("local-global", max_iterations=1, anderson=0))
    assert lazy.status == "not converged" and lazy.iterations == 1
    published = softkin.Solver("local-global", as_published=True)
    stopped = robot.solve(t=0.9, solver=published)
    assert stopped.converged and stopped.iterations >= 10
    assert np.abs(stopped.markers["tip"] - shape.markers["tip"]).max() > np.abs(
        algorithm.markers["tip"] - shape.markers["tip"]
    ).max()
    (one, two) = robot.path([[0.9], [0.8]], solver=published)
    np.testing.assert_array_equal(one.positions, stopped.positions)
    again = robot.solve(t=0.8, start=one, solver=published)
    np.testing.assert_array_equal(two.positions, again.positions)
    with pytest.raises(softkin.InvalidInput, match="to stop as published is for solver local-global"):
        robot.solve(t=0.9, solver=softkin.Solver(as_published=True))
    with pytest.raises(softkin.NotConverged, match="not converged at") as caught:
        lazy.require()
    assert caught.value.shape is lazy


def test_progress(robot: softkin.Robot) -> None:
    reported: list[softkin.Progress] = []
    big = beam(46, 13)
    stopped = big.solve(air1=1.5, air2=1.2, progress=lambda p: reported.append(p) or False)
    assert stopped.status == "interrupted" and len(reported) == 1
    assert reported[0].tolerance_mm > 0 and reported[0].iteration >= 0 and -1 <= reported[0].share <= 1 and reported[0].step_mm >= 0

    def fails(_: softkin.Progress) -> None:
        raise RuntimeError("from within")

    with pytest.raises(RuntimeError, match="from within"):
        big.solve(air1=1.5, air2=1.2, progress=fails)
    assert big.solve(air1=1.01).converged


def test_budget_and_start_from_a_file(robot: softkin.Robot, shape: softkin.Shape, tmp_path: Path) -> None:
    late = robot.solve(air1=1.3, budget_s=1e-9)
    assert late.status == "not converged" and late.remark == "the budget of 1e-09 s was spent"
    np.testing.assert_array_equal(late.positions, robot.rest)
    late.save(tmp_path / "late.vtu")
    on = robot.solve(air1=1.3, start=tmp_path / "late.vtu", budget_s=1000)
    assert on.converged and on.fingerprint == shape.fingerprint
    shape.save(tmp_path / "shape.vtu")
    there = robot.solve(air1=1.31, start=str(tmp_path / "shape.vtu"))
    assert there.fingerprint == robot.solve(air1=1.31, start=shape).fingerprint
    answer = robot.inverse(tip=shape["tip"], budget_s=1e-9)
    assert answer.status == "not converged" and answer.reason == "the budget of 1e-09 s was spent"
    for wrong in (0, -1, float("nan")):
        with pytest.raises(softkin.InvalidInput, match="a budget must be more than 0 s|budget_s must be a finite number"):
            robot.solve(budget_s=wrong)
    with pytest.raises(softkin.InvalidInput, match="no such file"):
        robot.solve(start=str(tmp_path / "none.vtu"))


def test_a_tendon_with_friction_keeps_its_history(robot: softkin.Robot) -> None:
    points = [[0, 4, 4], [8, 4, 7], [16, 4, 4], [24, 4, 7], [32, 4, 4]]
    tendon = {"name": "pull", "kind": "cable", "control": "tension", "range": [0, 2], "points": points, "friction": 0.3}
    robot_with_friction = beam(8, 2, actuators=[tendon])
    pulled = robot_with_friction.solve(pull=0.4).require()
    state = pulled.actuators["pull"]
    assert state.end_tension_N is not None and 0.4 * 0.3 < state.end_tension_N < 0.4 * 0.8 and state.sticking == 0
    let_go = robot_with_friction.solve(pull=0.36, start=pulled).require()
    assert let_go.actuators["pull"].sticking == 1
    other, state_there = pickle.loads(pickle.dumps((robot_with_friction, pulled)))
    again = other.solve(pull=0.36, start=state_there).require()
    np.testing.assert_allclose(again.positions, let_go.positions, atol=1e-9)
    first = next(iter(robot.solve().actuators.values()))
    assert first.end_tension_N is None and first.sticking is None


def test_bodies_and_motions() -> None:
    floor = {"name": "floor", "halfspace": {"point": [0, 0, -20.06], "normal": [0, 0, 1]}, "motion": ["z"]}
    cube = {"name": "cube", "box": [[0, 40, -20], [20, 60, 0]], "density": 1000}
    contact = {"distance": 0.05, "friction": 0.4}
    robot = beam(2, 2, actuators=[], gravity=[0, 0, -9.81], contact=contact, obstacles=[floor], bodies=[cube])
    assert [(a.name, a.kind) for a in robot.actuator_infos] == [
        ("cube_hold", "hold"),
        ("cube_fx", "force"),
        ("cube_fy", "force"),
        ("cube_fz", "force"),
        ("floor_z", "motion"),
    ]
    freed = robot.solve({"cube_hold": 0})
    (contacts,) = freed.require().contacts
    assert (contacts.on, contacts.by) == ("cube", "floor")
    np.testing.assert_allclose(contacts.force_N, [0, 0, 8e-3 * 9.81], atol=1e-8)
    lifted = robot.solve({"cube_hold": 0, "floor_z": 1.5}, start=freed).require()
    rise = lifted.markers["cube"] - freed.markers["cube"]
    np.testing.assert_allclose(rise, [0, 0, 1.5], atol=1e-6)
