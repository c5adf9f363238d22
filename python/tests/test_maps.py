"""Kinematic maps: against the solver, against differences of themselves, and what they refuse."""

from __future__ import annotations

import importlib.util
import json
import pickle
import shutil
import subprocess
import sys
import threading
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from beams import beam, block

import softkin

ROOT = Path(__file__).resolve().parents[2]
ACCURACY: dict[str, Any] = {"accuracy_mm": 0.02, "checks": 20}


@pytest.fixture(scope="module")
def robot() -> softkin.Robot:
    return beam(4, 5, actuators=chambers((1, 1.5)))


def chambers(reach: tuple[float, float]) -> list[dict[str, Any]]:
    return [{"name": f"air{i}", "kind": "pneumatic", "region": f"chamber{i}", "range": reach} for i in (1, 2, 3)]


@pytest.fixture(scope="module")
def made(robot: softkin.Robot) -> softkin.KinematicMap:
    return robot.map(**ACCURACY)


@pytest.fixture(scope="module")
def tendons() -> softkin.Robot:
    """A beam with two cables side by side: the long one, pulled, makes the short one slack."""
    vertices, _ = block((4, 2, 2), (64, 20, 20))
    held = {name: {"vertices": np.flatnonzero(vertices[:, 0] == x)} for name, x in (("base", 0), ("end", 64))}
    cables = [
        {"name": name, "kind": "cable", "points": [(0, 10, 2), (x, 10, 2)], "range": (0.8, 1)}
        for name, x in (("long", 64), ("short", 32))
    ]
    return beam(4, 2, regions=held, actuators=cables)


def inside(of: softkin.KinematicMap, many: int, seed: int = 7) -> Any:
    low, high = of.ranges.T
    return low + (high - low) * np.random.default_rng(seed).random((many, len(low)))


def test_what_it_tells(robot: softkin.Robot, made: softkin.KinematicMap) -> None:
    assert [each.name for each in made.inputs] == robot.actuators and made.markers == ["tip"]
    np.testing.assert_array_equal(made.ranges, robot.ranges)
    assert {(each.unit, each.range, each.rest) for each in made.inputs} == {("", (1, 1.5), 1)}
    columns = ["tip_x_mm", "tip_y_mm", "tip_z_mm", *(f"air{i}_pressure_kPa" for i in (1, 2, 3))]
    assert [each.column for each in made.outputs] == columns
    tip = made.outputs[0]
    assert (tip.name, tip.unit, tip.accuracy) == ("tip_x", "mm", 0.02)
    assert 0 < tip.mean_error < tip.largest_error <= 0.02
    assert made.accurate and made.equilibria > 10 and made.vertices == len(robot.rest)
    check = made.check
    assert (check.points, check.outside, check.seed, check.shape_accuracy_mm) == (20, 0, 1, 0.05)
    assert 0 < check.shape_mean_mm <= check.shape_largest_mm <= 0.05
    assert made.robot_fingerprint == robot.fingerprint and made.robot_name == "beam"
    assert f"of beam: {made.equilibria} equilibria; checked at 20 points, largest errors: markers " in repr(made)
    assert "<table>" in made._repr_html_() and "tip_x_mm" in made._repr_html_()


def test_it_answers_as_the_solver_does(robot: softkin.Robot, made: softkin.KinematicMap) -> None:
    """At commands of which it was neither made nor checked."""
    for commands in inside(made, 10):
        answer, shape = made.solve(commands), robot.solve(commands)
        np.testing.assert_allclose(answer["tip"], shape["tip"], atol=0.02)
        np.testing.assert_array_equal(answer.markers["tip"], answer["tip"])
        for name in robot.actuators:
            allowed = 2 * next(each.accuracy for each in made.outputs if each.name == f"{name}_pressure")
            pressure = shape.actuators[name].pressure_kPa
            assert answer.loads[f"{name}_pressure_kPa"] == pytest.approx(pressure, abs=allowed)
        np.testing.assert_allclose(made.shape(commands), shape.positions, atol=0.05)


def expect_outputs_of_the_map(robot: softkin.Robot, made: softkin.KinematicMap, commands: Any) -> None:
    """Of robot.solve(map=) within what the map states, which is less than what its shape is off by."""
    answer, shape = made.solve(commands), robot.solve(commands, map=made)
    allowed = {each.name: each.largest_error + 1e-9 for each in made.outputs}
    for name in made.markers:
        for axis, value in zip("xyz", answer[name]):
            assert shape[name]["xyz".index(axis)] == pytest.approx(value, abs=allowed[f"{name}_{axis}"])
    for column, value in answer.ratios.items():
        name = column.removesuffix("_ratio")
        assert shape.actuators[name].ratio == pytest.approx(float(value), abs=allowed[column])
    for name, state in shape.actuators.items():
        for kind in ("pressure_kPa", "tension_N"):
            if f"{name}_{kind}" in answer.loads:
                load = getattr(state, kind)
                expected = float(answer.loads[f"{name}_{kind}"])
                expected = max(0, expected) if kind == "tension_N" else expected  # as cables do not push
                assert load == pytest.approx(expected, abs=allowed[f"{name}_{kind}".rsplit("_", 1)[0]])


def test_shapes_by_a_map_have_its_outputs() -> None:
    """Volumes of chambers by pressure and a cable's length, of a shape that is far less accurate than they are."""
    pressures = [{**each, "control": "pressure"} for each in chambers((0, 30))[:2]]
    pull: dict[str, Any] = {"name": "pull", "kind": "cable", "control": "tension", "range": (0, 0.5)}
    pull["points"] = [(0, 10, 18), (64, 10, 18)]
    pushed = beam(4, 5, actuators=[*pressures, pull], markers={"tip": "end", "side": (63, 12, 9), "other": (63, 11, 9)})
    made = pushed.map(accuracy_mm=0.01, shape_accuracy_mm=1, checks=5)
    for commands in inside(made, 5):
        expect_outputs_of_the_map(pushed, made, commands)
        exact = pushed.solve(commands)
        answer = pushed.solve(commands, map=made)
        for name, state in exact.actuators.items():
            assert answer.actuators[name].ratio == pytest.approx(state.ratio, abs=3e-4)
    run = pushed.path(inside(made, 3), map=made)
    for shape in run:
        ratio = float(made.solve(shape.actuation).ratios["air1_ratio"])
        assert shape.actuators["air1"].ratio == pytest.approx(ratio, abs=1e-9)


@pytest.mark.deep
@pytest.mark.parametrize(
    "scene",
    ["three_chamber_actuator", "pneumatic_finger", "three_tendon_finger", "cable_gripper", "paper_finger"],
)
def test_shapes_of_examples_by_a_map_have_its_outputs(scene: str, examples: Path) -> None:
    shown = softkin.load(examples / scene / f"{scene}.yaml")
    made = shown.map(accuracy_mm=0.05, shape_accuracy_mm=0.5, checks=5)
    for commands in inside(made, 10):
        expect_outputs_of_the_map(shown, made, commands)


def test_commands(made: softkin.KinematicMap) -> None:
    named = made.solve(air1=1.3)
    np.testing.assert_array_equal(named.commands, [1.3, 1, 1])
    for same in (made.solve({"air1": 1.3}), made.solve([1.3, 1, 1]), made.solve({"air2": 1}, air1=1.3)):
        np.testing.assert_array_equal(same.outputs, named.outputs)
    np.testing.assert_array_equal(made.shape(air1=1.3), made.shape([1.3, 1, 1]))
    assert named.outputs.shape == (6,) and named.inside and named.ratios == {} and "MapAnswer tip " in repr(named)


def test_many_are_as_one_after_another(made: softkin.KinematicMap) -> None:
    commands = inside(made, 5000)  # more than one block
    many = made.solve(commands, jacobian=True)
    assert many.outputs.shape == (5000, 6) and many.jacobian().shape == (5000, 6, 3) and many["tip"].shape == (5000, 3)
    assert many.loads["air2_pressure_kPa"].shape == (5000,) and many.inside.all()
    assert "5000 of 5000" in repr(many)
    for n in (0, 1, 4095, 4096, 4999):
        one = made.solve(commands[n], jacobian=True)
        np.testing.assert_array_equal(many.outputs[n], one.outputs)
        np.testing.assert_array_equal(many.jacobians[n], one.jacobians)  # type: ignore[index]
        np.testing.assert_array_equal(many.jacobian("tip")[n], one.jacobian("tip"))
    two = made.solve(commands, jacobian=True, threads=2)
    np.testing.assert_array_equal(two.outputs, many.outputs)
    np.testing.assert_array_equal(made.solve(np.asfortranarray(commands)).outputs, many.outputs)
    assert made.solve(np.zeros((0, 3))).outputs.shape == (0, 6)


def test_jacobian(made: softkin.KinematicMap) -> None:
    h = 1e-5
    commands = 1.01 + 0.9 * (inside(made, 20) - 1)
    slopes = made.solve(commands, jacobian=True).jacobian()
    for i in range(3):
        step = h * np.eye(3)[i]
        moved = (made.solve(commands + step).outputs - made.solve(commands - step).outputs) / (2 * h)
        np.testing.assert_allclose(slopes[:, :, i], moved, rtol=1e-6, atol=1e-5)
    with pytest.raises(ValueError, match="the Jacobian was not requested: solve.*jacobian=True"):
        made.solve(commands).jacobian("tip")


def test_outside(made: softkin.KinematicMap) -> None:
    with pytest.raises(softkin.InvalidInput, match="^'air2' is 1.7, outside the map, which takes 1 to 1.5$"):
        made.solve(air2=1.7)
    with pytest.raises(softkin.InvalidInput, match="'air1' is 0.9"):
        made.shape(air1=0.9)
    rows = inside(made, 9)
    rows[4, 0], rows[7, 2] = 1.6, 0.5
    with pytest.raises(softkin.InvalidInput, match=r"^commands\[4\]: 'air1' is 1.6, .*; 2 of 9 rows are outside$"):
        made.solve(rows)
    left = made.solve(rows, jacobian=True, outside="leave out")
    assert np.flatnonzero(~left.inside).tolist() == [4, 7] and "7 of 9" in repr(left)
    np.testing.assert_array_equal(left.commands, rows[left.inside])
    again = made.solve(rows[left.inside], jacobian=True)
    np.testing.assert_array_equal(left.outputs, again.outputs)
    np.testing.assert_array_equal(left.jacobian(), again.jacobian())
    with pytest.raises(ValueError, match=r"commands\[4, 0\] is nan"):
        made.solve(np.where(rows > 1.55, np.nan, rows), outside="leave out")


@pytest.mark.parametrize(
    ("arguments", "keywords", "message"),
    [
        ((), {"ari1": 1.2}, "the map has no input 'ari1', but 'air1', 'air2', 'air3'"),
        ((), {"air1": float("nan")}, "air1 must be a finite number, not nan"),
        (([1, 1],), {}, r"commands must have shape \(3,\), not \(2,\)"),
        (([[1, 1]],), {}, r"commands must have shape \(n, 3\), not \(1, 2\)"),
        (([1, 1, 1],), {"air1": 1.2}, "commands: an array names every input"),
        (([[1, 1, 1]],), {"outside": "skip"}, "outside must be 'raise' or 'leave out', not 'skip'"),
    ],
)
def test_wrong_commands(made: softkin.KinematicMap, arguments: Any, keywords: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        made.solve(*arguments, **keywords)


def test_wrong_markers_and_shapes(made: softkin.KinematicMap) -> None:
    with pytest.raises(softkin.InvalidInput, match="the map has no marker 'tpi', but 'tip'"):
        made.solve()["tpi"]
    with pytest.raises(ValueError, match="a shape at a time"):
        made.shape([[1, 1, 1]])


def test_save_load_and_pickle(made: softkin.KinematicMap, tmp_path: Path) -> None:
    made.save(tmp_path / "beam.skmap")
    commands = inside(made, 50)
    for again in (softkin.load_map(tmp_path / "beam.skmap"), pickle.loads(pickle.dumps(made))):
        np.testing.assert_array_equal(again.solve(commands).outputs, made.solve(commands).outputs)
        np.testing.assert_array_equal(again.shape(commands[0]), made.shape(commands[0]))
        assert repr(again) == repr(made) and again.inputs == made.inputs and again.outputs == made.outputs
        assert again.check == made.check
    answer = made.solve(commands[0], jacobian=True)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(answer)).jacobian("tip"), answer.jacobian("tip"))
    with pytest.raises(ValueError, match="path must end in .skmap, not 'beam.txt'"):
        made.save(tmp_path / "beam.txt")
    (tmp_path / "cut.skmap").write_bytes((tmp_path / "beam.skmap").read_bytes()[:-9])
    with pytest.raises(softkin.InvalidInput, match="cut.skmap"):
        softkin.load_map(tmp_path / "cut.skmap")


def test_the_map_of_the_command(made: softkin.KinematicMap, command: str, tmp_path: Path) -> None:
    """Its bytes are read, and read back alike."""
    scene = ROOT / "examples/cable_gripper/cable_gripper.yaml"
    options = ["--formulation", "target-shape", "--accuracy", "0.5", "--shape-accuracy", "0", "--check", "2"]
    words = [command, "map", str(scene), "-o", "a.skmap", *options]
    subprocess.run(words, cwd=tmp_path, check=True, capture_output=True)
    softkin.load_map(tmp_path / "a.skmap").save(tmp_path / "b.skmap")
    assert (tmp_path / "a.skmap").read_bytes() == (tmp_path / "b.skmap").read_bytes()
    gripper = softkin.load(scene, formulation="target-shape")
    gripper.map(accuracy_mm=0.5, shape_accuracy_mm=None, checks=2, store=tmp_path / "c.skmap")
    assert (tmp_path / "a.skmap").read_bytes() == (tmp_path / "c.skmap").read_bytes()


def test_progress_and_going_on(robot: softkin.Robot, made: softkin.KinematicMap, tmp_path: Path) -> None:
    reported: list[softkin.MapProgress] = []

    def enough(at: softkin.MapProgress) -> None:
        reported.append(at)
        if at.equilibria >= 5:
            raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        robot.map(**ACCURACY, store=tmp_path / "beam.skmap", progress=enough, solver=softkin.Solver(threads=1))
    assert reported[-1].equilibria >= 5 and reported[-1].error >= 0 and reported[-1].doing and reported[-1].checks >= 0
    journal = tmp_path / "beam.skmap.run"
    assert journal.exists() and not (tmp_path / "beam.skmap").exists()
    with pytest.raises(softkin.InvalidInput, match="cannot be gone on with"):
        robot.map(checks=20, store=tmp_path / "beam.skmap")  # another accuracy
    journal.write_bytes(journal.read_bytes()[: journal.stat().st_size * 2 // 3])  # killed in the midst of a record
    with pytest.warns(DeprecationWarning, match=r"threads= of map .* write solver=softkin.Solver\(threads=2\)"):
        again = robot.map(**ACCURACY, store=tmp_path / "beam.skmap", threads=2)
    assert not journal.exists()
    made.save(tmp_path / "whole.skmap")
    assert (tmp_path / "whole.skmap").read_bytes() == (tmp_path / "beam.skmap").read_bytes()
    np.testing.assert_array_equal(again.solve().outputs, made.solve().outputs)


def test_a_map_less_accurate_than_requested_warns(robot: softkin.Robot) -> None:
    with pytest.warns(softkin.SoftkinWarning, match="not as accurate as requested: .*it ended after"):
        poor = robot.map(accuracy_mm=1e-5, shape_accuracy_mm=None, most=5, checks=3, load_accuracy=0.5)
    assert not poor.accurate and poor.check.points == 0 and poor.check.outside == 3 and poor.outputs[3].accuracy == 0.5
    with pytest.raises(softkin.InvalidInput, match="outside the map"):
        poor.solve()


def test_without_shape(robot: softkin.Robot) -> None:
    plain = robot.map(accuracy_mm=0.05, shape_accuracy_mm=None, checks=3)
    assert plain.vertices == 0 and plain.check.shape_accuracy_mm == 0
    with pytest.raises(softkin.InvalidInput, match="without the robot's shape"):
        plain.shape()
    with pytest.raises(softkin.InvalidInput, match="without the robot's shape"):
        robot.solve(map=plain)


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"accuracy_mm": 0}, "a map's accuracies are positive"),
        ({"shape_accuracy_mm": 0}, "shape_accuracy_mm must be a number > 0, or None, not 0"),
        ({"load_accuracy": -1}, "load_accuracy must be a number > 0, or None, not -1"),
        ({"checks": 0}, "checks and threads 1 or more"),
        ({"store": "beam.map"}, "store must end in .skmap, not 'beam.map'"),
    ],
)
def test_wrong_options(robot: softkin.Robot, keywords: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        robot.map(**keywords)


def test_no_map(robot: softkin.Robot) -> None:
    with pytest.raises(softkin.InvalidInput, match="the robot has no marker"):
        beam(4, 5, markers={}).map()


def test_in_the_solvers_place(robot: softkin.Robot, made: softkin.KinematicMap) -> None:
    commands = inside(made, 1)[0]
    solved = robot.solve(commands)
    by_map = robot.solve(commands, map=made)
    assert by_map.converged and by_map.iterations == 0
    np.testing.assert_allclose(by_map["tip"], made.solve(commands)["tip"], atol=1e-9)
    np.testing.assert_allclose(by_map.positions, solved.positions, atol=0.05)
    assert by_map.actuators["air1"].pressure_kPa == made.solve(commands).loads["air1_pressure_kPa"]
    polished = robot.solve(commands, map=made, polish=True)
    np.testing.assert_allclose(polished.positions, solved.positions, atol=1e-4)
    assert polished.iterations < solved.iterations
    assert polished.fingerprint == robot.solve(commands, map=made, polish=True).fingerprint  # nothing is kept
    session = robot.session()
    assert session.solve(commands, map=made).fingerprint == by_map.fingerprint


def test_inverse_and_paths_by_a_map(robot: softkin.Robot, made: softkin.KinematicMap) -> None:
    goal = made.solve(air1=1.4, air2=1.3, air3=1.2)["tip"]
    answer = robot.inverse(tip=goal, map=made)
    assert answer.reached and answer.actuation == pytest.approx({"air1": 1.4, "air2": 1.3, "air3": 1.2}, abs=2e-3)
    polished = robot.inverse(tip=goal, map=made, polish=True)
    assert polished.reached and robot.solve(polished.actuation)["tip"] == pytest.approx(goal, abs=2e-3)
    assert robot.session().inverse(tip=goal, map=made).actuation == answer.actuation
    path = np.linspace(made.solve()["tip"], goal, 5)
    for polish in (False, True):
        waypoints = list(robot.follow(path, map=made, polish=polish))
        assert len(waypoints) == 5 and all(each.reached for each in waypoints)
    assert waypoints[-1].shape["tip"] == pytest.approx(goal, abs=2e-3)
    steps = np.linspace([1, 1, 1], [1.4, 1.3, 1.2], 4)
    shapes = list(robot.path(steps, map=made))
    np.testing.assert_allclose(shapes[-1]["tip"], goal, atol=1e-9)
    assert robot.path(steps, map=made, polish=True).__next__().converged


def test_a_map_of_another_robot(robot: softkin.Robot, made: softkin.KinematicMap, tmp_path: Path) -> None:
    other = beam(4, 5, actuators=chambers((1, 1.4)))
    with pytest.raises(softkin.InvalidInput, match="not of this robot: the range of 'air1' was 1 to 1.5, and is"):
        other.solve(map=made)
    softer = beam(4, 5, actuators=chambers((1, 1.5)), materials=[{"youngs_modulus": 2, "poisson_ratio": 0.4}])
    made.save(tmp_path / "beam.skmap")
    again = softkin.load_map(tmp_path / "beam.skmap")
    for use in (
        lambda: softer.inverse(tip=(70, 10, 10), map=again),
        lambda: softer.follow([(70, 10, 10)], map=again),
        lambda: softer.path([(1, 1, 1)], map=again, polish=True),
    ):
        with pytest.raises(softkin.InvalidInput, match="beam.skmap: is not of this robot: .* have changed; make"):
            use()


def test_what_needs_a_map_or_the_solver(robot: softkin.Robot, made: softkin.KinematicMap) -> None:
    with pytest.raises(ValueError, match="polish goes on from the answers of a map: it needs map"):
        robot.solve(polish=True)
    with pytest.raises(ValueError, match="a map answers without the solver: the solver's options need polish=True"):
        robot.inverse(tip=(70, 10, 10), map=made, solver=softkin.Solver(max_iterations=5))
    with pytest.raises(ValueError, match="need polish=True"):
        robot.follow([(70, 10, 10)], map=made, solver=softkin.Solver(tolerance_mm=1))
    assert robot.solve(map=made, polish=True, solver=softkin.Solver(tolerance_mm=1e-7)).converged


def test_slack_cables(tendons: softkin.Robot) -> None:
    made = tendons.map(accuracy_mm=0.05, checks=20, shape_accuracy_mm=None)
    loads = ["long_tension_N", "long_ratio", "short_tension_N", "short_ratio"]
    assert [each.column for each in made.outputs[3:]] == loads
    for commands in ({"long": 0.85}, {"short": 0.85, "long": 0.95}):
        answer, shape = made.solve(commands), tendons.solve(commands)
        assert shape.actuators["short"].slack == ("short" not in commands)
        for name in ("long", "short"):
            assert answer.ratios[f"{name}_ratio"] == pytest.approx(shape.actuators[name].ratio, abs=1e-3)
            allowed = 2 * next(each.accuracy for each in made.outputs if each.name == f"{name}_tension")
            assert answer.loads[f"{name}_tension_N"] == pytest.approx(shape.actuators[name].tension_N, abs=allowed)
        np.testing.assert_allclose(answer["tip"], shape["tip"], atol=0.05)


@pytest.fixture(scope="module")
def reader() -> ModuleType:
    spec = importlib.util.spec_from_file_location("map_numpy", ROOT / "examples/python/map_numpy.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_exported_for_numpy(made: softkin.KinematicMap, reader: ModuleType, tmp_path: Path) -> None:
    made.export_numpy(tmp_path / "beam.npz")
    arrays = reader.NumpyMap(tmp_path / "beam.npz")
    commands = inside(made, 300)
    outputs, cells = arrays.fk(commands)
    answer = made.solve(commands)
    np.testing.assert_allclose(outputs, answer.outputs, rtol=1e-12, atol=1e-12)
    shape = arrays.shape(commands[:1], cells[:1])[0].reshape(-1, 3)
    np.testing.assert_allclose(shape, made.shape(commands[0]), atol=1e-4)


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler is installed")
def test_exported_for_c(made: softkin.KinematicMap, tmp_path: Path) -> None:
    made.export_c(tmp_path / "beam.h")
    made.export_c(tmp_path / "small.h", floats=True)
    assert "double" in (tmp_path / "beam.h").read_text()
    for header, real in (("beam.h", "double"), ("small.h", "float")):
        program = (
            f'#include <stdio.h>\n#include "{header}"\nint main(void) {{ {real} c[3] = {{1.3, 1.2, 1.1}}, o[6]; '
            'beam_fk(c, o, 0); printf("%.9g %.9g %.9g\\n", (double)o[0], (double)o[1], (double)o[2]); return 0; }\n'
        )
        (tmp_path / "main.c").write_text(program)
        subprocess.run(["cc", "main.c", "-o", "main"], cwd=tmp_path, check=True)
        reported = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout.split()
        np.testing.assert_allclose(np.array(reported, float), made.solve([1.3, 1.2, 1.1])["tip"], rtol=1e-5)


def test_exported_for_javascript(made: softkin.KinematicMap, tmp_path: Path) -> None:
    try:
        made.export_js(tmp_path / "beam.mjs")
    except softkin.InvalidInput as error:
        assert "built without its page" in str(error) and not (tmp_path / "beam.mjs").exists()
        pytest.skip("built without the page")
    assert (tmp_path / "beam.d.mts").read_text().startswith("/")


def test_exports_have_their_endings(made: softkin.KinematicMap, tmp_path: Path) -> None:
    for export, ending in ((made.export_c, ".h"), (made.export_js, ".mjs"), (made.export_numpy, ".npz")):
        with pytest.raises(ValueError, match=f"path must end in {ending}"):
            export(tmp_path / "beam.txt")


def test_threads_with_one_map_give_the_serial_results(robot: softkin.Robot, made: softkin.KinematicMap) -> None:
    commands = inside(made, 20000)
    serial = made.solve(commands).outputs
    shape = robot.solve(commands[0], map=made).fingerprint
    same: list[bool] = []

    def work() -> None:
        outputs = made.solve(commands).outputs
        same.append(bool((outputs == serial).all()) and robot.solve(commands[0], map=made).fingerprint == shape)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert same == [True] * 4


def test_runs_tell_of_their_map(robot: softkin.Robot, made: softkin.KinematicMap, tmp_path: Path) -> None:
    """A report says which map answered; a run is not continued by another solver than it was begun with."""
    steps = [[1 + 0.05 * i, 1.1, 1] for i in range(1, 7)]
    list(robot.path(steps, map=made, store=tmp_path / "by_map"))
    solver = json.loads((tmp_path / "by_map/report.json").read_text())["solver"]
    assert solver["name"] == "map" and solver["map"]["equilibria"] == made.equilibria
    with pytest.raises(softkin.InvalidInput, match="cannot go on from this report"):
        robot.path([*steps, [1.4, 1.1, 1]], store=tmp_path / "by_map")
    list(robot.path(steps[:1], map=made, polish=True, store=tmp_path / "polished"))
    solver = json.loads((tmp_path / "polished/report.json").read_text())["solver"]
    assert solver["name"] == "newton" and solver["begun_from_map"]["equilibria"] == made.equilibria
    targets = np.array([robot.solve(step, map=made)["tip"] for step in steps[:2]])
    list(robot.follow(targets, map=made, store=tmp_path / "followed"))
    assert json.loads((tmp_path / "followed/report.json").read_text())["solver"]["name"] == "map"
    with pytest.raises(softkin.InvalidInput, match="cannot go on from"):
        robot.follow(targets, store=tmp_path / "followed")


def test_estimate_tells_commands_from_outputs(made: softkin.KinematicMap) -> None:
    rng = np.random.default_rng(3)
    columns = [each.column for each in made.outputs if each.unit == "mm"]
    held = 0
    for commands in inside(made, 200):
        answer = made.solve(commands)
        read = {name: answer.outputs[q] for q, name in enumerate(columns)}
        read = {name: value + 0.05 * rng.standard_normal() for name, value in read.items()}
        reported = made.estimate(read, 0.05, {"air2": (commands[1], 0.1), "air3": (1.25, 10)}, commands)
        assert reported.converged and list(reported.values) == ["air2", "air3"]
        assert reported.answer.commands[0] == commands[0]
        low, high = made.ranges[2]
        assert low <= reported.values["air3"] <= high
        held += abs(reported.values["air3"] - commands[2]) <= 1.645 * reported.deviations["air3"]
    assert 170 <= held <= 195
    assert reported.covariance.shape == (2, 2) and reported.deviations["air2"] < 0.1
    wrong = made.estimate({**read, "tip_y_mm": read["tip_y_mm"] + 100}, 0.05, {"air3": (1.25, 1)}, commands)
    assert wrong.misfit > 5


def test_estimate_refuses(made: softkin.KinematicMap) -> None:
    with pytest.raises(softkin.InvalidInput, match="no output 'top_x_mm'"):
        made.estimate({"top_x_mm": 1}, 0.1, {"air1": (1, 1)})
    with pytest.raises(softkin.InvalidInput, match="no input 'air9'"):
        made.estimate({"tip_x_mm": 1}, 0.1, {"air9": (1, 1)})
    with pytest.raises(softkin.InvalidInput, match="'tip_x_mm' needs a deviation"):
        made.estimate({"tip_x_mm": 1}, {}, {"air1": (1, 1)})
    with pytest.raises(softkin.InvalidInput, match="outside the map"):
        made.estimate({"tip_x_mm": 1}, 0.1, {"air1": (1.2, 1)}, air2=9)
