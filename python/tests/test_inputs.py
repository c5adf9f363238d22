"""Every public function answers bad input by InvalidInput, in one sentence; a new one without an entry here fails."""

from __future__ import annotations

import dataclasses
import inspect
import types
import re
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beams import block

import softkin
from softkin import mesh
from softkin._checks import InvalidCall, Plan

MODULES = {
    "": softkin,
    "calibrate.": softkin.calibrate,
    "compare.": softkin.compare,
    "drive.": softkin.drive,
    "measure.": softkin.measure,
    "mesh.": mesh,
}
BAD: dict[str, Any] = {
    "None": None,
    "NaN": float("nan"),
    "infinite": float("inf"),
    "wrong type": object(),
    "truth": True,
    "text": "no such thing",
    "empty text": "",
    "empty list": [],
    "empty dict": {},
    "wrong shape": np.zeros((2, 7)),
    "one value": np.array([5.0]),
    "ragged": [[1.0], [1.0, 2.0]],
    "huge": 2**70,
    "huge of many digits": 10**5000,
    "huge negative": -(10**400),
    "a class": dict,
}


@dataclasses.dataclass(frozen=True)
class Call:
    """A call that is right, of which one argument is made wrong at a time."""

    function: Callable[..., Any]
    given: tuple[Any, ...]
    keywords: dict[str, Any]


def call(function: Callable[..., Any], *given: Any, **keywords: Any) -> Call:
    return Call(function, given, keywords)


def functions_of(kind: type, name: str) -> Iterator[tuple[str, Callable[..., Any]]]:
    for base in kind.__mro__:
        if not base.__module__.startswith("softkin") or base.__module__ == "softkin._core":
            continue
        for member, value in vars(base).items():
            function = value.__func__ if isinstance(value, (classmethod, staticmethod)) else value
            if member == "__init__":
                if hasattr(function, "_is_checked"):
                    yield name, function
            elif isinstance(function, types.FunctionType) and (not member.startswith("_") or member == "__getitem__"):
                yield f"{name}.{member}", function


def public_functions() -> dict[str, Callable[..., Any]]:
    found: dict[str, Callable[..., Any]] = {}
    for prefix, module in MODULES.items():
        for name in module.__all__:
            member = getattr(module, name)
            if isinstance(member, type):
                if not issubclass(member, (Exception, tuple)):
                    for path, function in functions_of(member, prefix + name):
                        found.setdefault(path, function)
            elif isinstance(member, types.FunctionType):
                found[prefix + name] = member
    return found


PUBLIC = public_functions()


def parameters_of(name: str) -> list[inspect.Parameter]:
    every = list(inspect.signature(PUBLIC[name]).parameters.values())
    is_method = bool(every) and every[0].name in ("self", "cls")
    return every[1:] if is_method else every


WITH_ARGUMENTS = [name for name in PUBLIC if parameters_of(name)]


class World:
    """What right calls are made of: a block of rubber with a chamber, its shape, its runs, files."""

    def __init__(self, folder: Path, examples: Path) -> None:
        self.folder, self.examples = folder, examples
        self.mesh = block((4, 2, 2), (40, 20, 20))
        vertices, tetrahedra = self.mesh
        self.description: dict[str, Any] = {
            "regions": {
                "base": {"vertices": np.flatnonzero(vertices[:, 0] == 0)},
                "top": {"vertices": np.flatnonzero(vertices[:, 2] == 20)},
            },
            "materials": [{"youngs_modulus": 1, "poisson_ratio": 0.4}],
            "fixed": [{"region": "base"}],
            "actuators": [
                {"name": "pull", "kind": "cable", "points": [(0, 10, 20), (40, 10, 20)], "control": "tension", "range": (0, 1)}
            ],
            "forces": [{"name": "push", "region": "top", "range": [[0, 0], [0, 0], [-0.1, 0.1]]}],
            "markers": {"tip": (40, 10, 10), "low": (40, 10, 0)},
        }
        self.robot = softkin.Robot(vertices, tetrahedra, **self.description)
        self.shape = self.robot.solve(pull=0.1)
        self.answer = self.robot.inverse(tip=self.shape["tip"])
        self.session = self.robot.session()
        self.path = self.robot.path([[0.1, 0.0]])
        self.follow = self.robot.follow([self.shape["tip"]], marker="tip")
        for each in (*self.path, *self.follow):
            assert each is not None
        self.workspace = self.robot.workspace(2)
        self.map = self.robot.map(accuracy_mm=0.5, checks=2, shape_accuracy_mm=None)
        self.estimator = self.robot.estimator("push", {"tip_z_mm": 0.1, "tip_x_mm": 0.1})
        self.estimate = self.estimator.update({"tip_z_mm": 9.9}, pull=0)
        self.table = self.follow.commands
        self.surface = mesh.Surface(*surface_of(20))
        self.volume = mesh.VolumeMesh(vertices, tetrahedra, {"body": np.arange(len(tetrahedra))}, {})
        self.stl, self.msh, self.csv = (str(folder / name) for name in ("a.stl", "a.msh", "a.csv"))
        mesh.write_stl(self.stl, self.surface)
        self.volume.write(self.msh)
        self.report = str(folder / "a.json")
        self.shape.save(self.report)

    def file(self, name: str) -> str:
        return str(self.folder / name)


def surface_of(size: float) -> tuple[Any, Any]:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * float(size)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def right_calls(w: World) -> dict[str, Call]:
    """A valid call of every public function that has arguments. Calls that would take long or need a device fail after
    the check of the arguments, for example because of a missing file."""
    robot, shape, missing = w.robot, w.shape, w.file("none.csv")
    calls: dict[str, Call] = {
        "load": call(softkin.load, w.examples / "two_material_bar/two_material_bar.yaml"),
        "load_map": call(softkin.load_map, missing),
        "example": call(softkin.example, "no such example"),
        "Robot": call(softkin.Robot, *w.mesh, **w.description),
        "Robot.from_meshio": call(softkin.Robot.from_meshio, object()),
        "Robot.from_pyvista": call(softkin.Robot.from_pyvista, object()),
        "Robot.estimator": call(robot.estimator, "push", {"tip_z_mm": 0.1}),
        "Robot.path": call(robot.path, [[0.1, 0.0]]),
        "Robot.follow": call(robot.follow, [shape["tip"]], marker="tip"),
        "Robot.walk": call(robot.walk, [[0.0, 0.0], [0.1, 0.0]]),
        "Robot.grasp": call(robot.grasp, {"pull": 0.1}),
        "Robot.workspace": call(robot.workspace, 2),
        "Robot.map": call(robot.map, accuracy_mm=0.5, checks=2, shape_accuracy_mm=None),
        "Robot.to_html": call(robot.to_html, w.file("a.html"), shape),
        "Robot.view": call(robot.view, shape),
        "Robot.solve": call(robot.solve, pull=0.1),
        "Robot.inverse": call(robot.inverse, tip=shape["tip"]),
        "Robot.jacobian": call(robot.jacobian, shape),
        "Robot.sensitivity": call(robot.sensitivity, shape, "materials.all.youngs_modulus"),
        "Robot.gradient": call(robot.gradient, shape, "materials.all.youngs_modulus", markers={"tip": (1, 0, 0)}),
        "Session": call(softkin.Session, robot),
        "Session.solve": call(w.session.solve, pull=0.1),
        "Session.inverse": call(w.session.inverse, tip=shape["tip"]),
        "Session.jacobian": call(w.session.jacobian, shape),
        "Session.sensitivity": call(w.session.sensitivity, shape, "materials.all.youngs_modulus"),
        "Session.gradient": call(w.session.gradient, shape, "materials.all.youngs_modulus"),
        "Solver": call(softkin.Solver),
        "Estimator": call(softkin.Estimator, robot, "push", {"tip_z_mm": 0.1}),
        "Estimator.update": call(w.estimator.update, {"tip_z_mm": 9.9}, pull=0),
        "Estimator.plan": call(w.estimator.plan, w.estimate, {"length_mm": 0.1}),
        "Shape.__getitem__": call(shape.__getitem__, "tip"),
        "Shape.save": call(shape.save, w.file("b.json")),
        "Shape.png": call(shape.png),
        "Answer.save": call(w.answer.save, w.file("b.json")),
        "Answer.png": call(w.answer.png),
        "Answer.save_plot": call(w.answer.save_plot, w.file("b.svg")),
        "Shape.turn": call(shape.turn, "tip"),
        "PathRun.turns": call(w.path.turns, "tip"),
        "FollowRun.turns": call(w.follow.turns, "tip"),
        "WalkRun.turns": call(w.path.turns, "tip"),
        "PathRun.save_plot": call(w.path.save_plot, w.file("b.svg")),
        "FollowRun.save_plot": call(w.follow.save_plot, w.file("b.svg")),
        "WalkRun.save_plot": call(w.path.save_plot, w.file("b.svg")),
        "Workspace.hull": call(w.workspace.hull),
        "Workspace.__getitem__": call(w.workspace.__getitem__, "tip"),
        "Workspace.summary": call(w.workspace.summary),
        "Workspace.save": call(w.workspace.save, w.file("b.vtu")),
        "Workspace.save_hull": call(w.workspace.save_hull, w.file("b.stl")),
        "Workspace.save_plot": call(w.workspace.save_plot, w.file("c.svg")),
        "Table.__getitem__": call(w.table.__getitem__, w.table.columns[0]),
        "KinematicMap.solve": call(w.map.solve, {"pull": 0.1}),
        "KinematicMap.save": call(w.map.save, w.file("a.skmap")),
    }
    return {**calls, **other_calls(w)}


def other_calls(w: World) -> dict[str, Call]:
    missing = w.file("none.csv")
    calls: dict[str, Call] = {
        "calibrate.tensile": call(softkin.calibrate.tensile, missing),
        "calibrate.material": call(softkin.calibrate.material, missing),
        "calibrate.relaxation": call(softkin.calibrate.relaxation, missing),
        "calibrate.pressure": call(softkin.calibrate.pressure, missing, syringe_volume=6e4, chamber_volume=2e4),
        "calibrate.dea": call(softkin.calibrate.dea, missing),
        "calibrate.robot": call(softkin.calibrate.robot, w.file("none.yaml"), missing),
        "compare.reports": call(softkin.compare.reports, [w.report, w.report]),
        "compare.paths": call(softkin.compare.paths, [w.report, w.report]),
        "drive.plan": call(softkin.drive.plan, w.robot, [[0.1, 0.0]], hardware=w.file("none.yaml")),
        "drive.Marlin": call(softkin.drive.Marlin, w.file("none")),
        "measure.Board": call(softkin.measure.Board, "no board"),
        "measure.pictures": call(softkin.measure.pictures, [missing], dots="red", scale_board="5x4,tag=12mm,gap=3mm"),
        "measure.film": call(softkin.measure.film, missing, dots="red", scale_board="5x4,tag=12mm,gap=3mm"),
        "measure.camera": call(softkin.measure.camera, [missing], "checker,9x6,square=10mm"),
        "measure.read_camera": call(softkin.measure.read_camera, w.file("none.yaml")),
        "mesh.from_surfaces": call(mesh.from_surfaces, w.surface, edge_length=1e9),
        "mesh.mesh_geo": call(mesh.mesh_geo, w.file("none.geo"), 1.0),
        "mesh.read_msh": call(mesh.read_msh, w.msh),
        "mesh.read_surface": call(mesh.read_surface, w.stl),
        "mesh.write_stl": call(mesh.write_stl, w.file("c.stl"), w.surface),
        "mesh.scene_text": call(mesh.scene_text, w.volume, "a.msh", []),
        "mesh.stacked": call(mesh.stacked, w.surface, {"skin": 1.0}),
        "mesh.info": call(mesh.info, w.msh),
        "mesh.check": call(mesh.check, w.msh),
        "mesh.convert": call(mesh.convert, w.msh, w.file("c.vtu")),
    }
    return calls


@pytest.fixture(scope="module")
def calls(tmp_path_factory: pytest.TempPathFactory, examples: Path) -> dict[str, Call]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", softkin.SoftkinWarning)
        return right_calls(World(tmp_path_factory.mktemp("inputs"), examples))


def check_sentence(message: str) -> None:
    assert message and "\n" not in message
    for raw in ("object has no", "incompatible function", "NoneType", "positional argument", "__init__"):
        assert raw not in message, message
    assert not re.search(r"\b0x[0-9a-f]", message), message


def outcome(function: Callable[..., Any], *given: Any, **keywords: Any) -> str:
    """What was refused, or 'accepted'."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            function(*given, **keywords)
    except softkin.InvalidInput as error:
        check_sentence(str(error))
        return str(error)
    except ImportError:  # of a package that is not installed
        return "accepted"
    return "accepted"


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_arguments_are_checked(name: str) -> None:
    """Whatever comes first, such as the robot, is not looked at where the arguments cannot be right."""
    function = PUBLIC[name]
    assert hasattr(inspect.unwrap(function, stop=lambda f: hasattr(f, "_is_checked")), "_is_checked"), "guard() it"
    parameters = parameters_of(name)
    every = list(inspect.signature(function).parameters)
    first = [object()] if every[:1] in (["self"], ["cls"]) else []
    takes_any = any(p.kind is p.VAR_KEYWORD for p in parameters)
    if not takes_any:
        with pytest.raises(InvalidCall, match="has no argument 'no_such'"):
            function(*first, no_such=1)
    with pytest.raises(softkin.InvalidInput, match="without a name|must"):
        function(*first, *[object()] * 40)
    if any(p.default is p.empty and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL) for p in parameters):
        with pytest.raises(InvalidCall, match="needs"):
            function(*first)


@pytest.mark.parametrize("name", WITH_ARGUMENTS)
def test_bad_input(name: str, calls: dict[str, Call], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # where files of odd names may be written
    if name not in calls:
        assert not_called(name), f"{name}: give right_calls() a call of it"
        return
    right = calls[name]
    places = [p for p in parameters_of(name) if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    for parameter in parameters_of(name):
        if parameter.kind is parameter.VAR_POSITIONAL:
            continue
        for what, value in BAD.items():
            given, keywords = list(right.given), dict(right.keywords)
            if parameter.name == "progress" and what == "a class":
                continue  # it is called, and what it raises is the user's
            if parameter.kind is parameter.VAR_KEYWORD:
                keywords[next(iter(keywords), "some_name")] = value
            elif parameter in places and places.index(parameter) < len(given):
                given[places.index(parameter)] = value
            elif parameter.kind is parameter.POSITIONAL_ONLY:
                given, keywords = [*given, value], {}
            else:
                keywords[parameter.name] = value
            try:
                reported = outcome(right.function, *given, **keywords)
            except Exception as error:
                pytest.fail(f"{name}({parameter.name}: {what}): {type(error).__name__}: {error}")
            if what in must_refuse(parameter):
                assert reported != "accepted", f"{name}({parameter.name}: {what}) was accepted"


def must_refuse(parameter: inspect.Parameter) -> list[str]:
    """By the words of the annotation alone."""
    if parameter.annotation in ("int", "float", "int | None", "float | None"):
        refused = ["NaN", "wrong type", "truth", "text", "empty list", "empty dict", "wrong shape", "one value", "a class"]
        refused += ["huge of many digits", "huge negative", "infinite"]
        return refused + ["None"] * ("None" not in parameter.annotation) + ["huge"] * ("int" in parameter.annotation)
    if parameter.annotation == "bool":
        return ["None", "NaN", "wrong type", "text", "huge"]
    if parameter.annotation in ("Command", "Target"):
        return ["None", "NaN", "wrong type", "truth", "empty list", "one value", "wrong shape", "a class", "ragged"]
    return ["wrong type"] if "Any" not in str(parameter.annotation) else []


def not_called(name: str) -> bool:
    """Functions of what only a device, a picture or a measurement gives: their arguments are checked by their types."""
    kind = name.rpartition(".")[0]
    return kind.startswith(("calibrate.", "measure.", "compare.", "drive.", "mesh.", "MapAnswer", "KinematicMap"))


@pytest.mark.parametrize("name", WITH_ARGUMENTS)
def test_every_annotation_is_understood(name: str) -> None:
    """By what is checked before a call: no argument slips through because its type is not known."""
    function = PUBLIC[name]
    first = list(inspect.signature(function).parameters)[:1]
    plan = Plan(function, first in (["self"], ["cls"]))
    for parameter in parameters_of(name):
        if parameter.kind is parameter.VAR_POSITIONAL:
            assert plan._every[0] == parameter.name
        elif parameter.annotation in ("int", "float", "bool", "str", "PathLike"):
            kinds = dict(plan._positional) | plan._by_name
            assert kinds.get(parameter.name, plan._rest) is not None, parameter


def test_what_was_accepted_without_a_word(calls: dict[str, Call]) -> None:
    robot: softkin.Robot = calls["Session"].given[0]
    for given, keywords, message in (
        (({"pull": 0.1},), {"pull": 0.2}, "pull is given twice: among the commands by name and as a keyword"),
        (([0.1, 0.0],), {"pull": 0.2}, "pull is given twice: an array of commands has one for every actuator"),
        ((), {"pull": True}, "pull must be a number, not True"),
        ((), {"pull": None}, "pull must be a number, not None"),
        ((), {"pull": np.array([0.5])}, r"pull must be a number, not an array of shape \(1,\)"),
        (([True, 0.0],), {}, "actuation must be an array of numbers.*holds True"),
        ((["0.1", 0.0],), {}, "actuation must be an array of numbers.*holds '0.1'"),
        ((np.array([True, False]),), {}, "actuation must be an array of numbers.*holds"),
        ((), {"start": np.zeros((2, 3), bool)}, "start must be an array of numbers"),
    ):
        with pytest.raises(softkin.InvalidInput, match=message):
            robot.solve(*given, **keywords)
    with pytest.raises(softkin.InvalidInput, match="'tip' is given twice"):
        robot.inverse({"tip": (1, 2, 3)}, tip=(1, 2, 3))
    with pytest.raises(softkin.InvalidInput, match="must be an array of numbers of shape .3,., but it holds True"):
        robot.inverse(tip=(True, 2, 3))
    with pytest.raises(softkin.InvalidInput, match="pull is given twice"):
        robot.path([{"pull": 0.1}], pull=0.2)


def test_threads_are_as_many_as_a_machine_may_have() -> None:
    for threads in (-1, 1025, 10**6):
        with pytest.raises(softkin.InvalidInput, match=rf"threads must be from 0 .as many as the machine has. to 1024, not {threads}"):
            softkin.Solver(threads=threads)


def test_unknown_keywords_name_the_nearest(calls: dict[str, Call]) -> None:
    robot: softkin.Robot = calls["Session"].given[0]
    with pytest.raises(softkin.InvalidInput, match="'tolerance', and the robot no marker of that name; did you mean 'tolerance_mm'"):
        robot.inverse(tip=(40, 10, 10), tolerance=0.1)  # type: ignore[arg-type]
    with pytest.raises(softkin.InvalidInput, match="no marker 'tipp'; did you mean 'tip'"):
        robot.inverse(tipp=(40, 10, 10))
    with pytest.raises(TypeError, match="Robot.workspace has no argument 'sample'"):  # as Python itself has it, too
        robot.workspace(2, sample=3)  # type: ignore[call-arg]
    with pytest.raises(softkin.InvalidInput, match="Solver has no argument 'max_iteration'; did you mean 'max_iterations'"):
        softkin.Solver(max_iteration=3)  # type: ignore[call-arg]


def test_changes_of_a_scene(examples: Path) -> None:
    scene = examples / "two_material_bar/two_material_bar.yaml"
    assert len(softkin.load(scene, changes={"mesh.order": 2}).edge_nodes) > 0
    first = softkin.load(scene, changes={"mesh": {"file": "two_material_bar.msh", "order": np.int64(2)}})
    assert len(first.edge_nodes) > 0
    for value, message in (
        (None, "changes: mesh.order must be a number, a text, or a list or dictionary of these, not None"),
        (object(), "changes: mesh.order must be a number"),
        (float("nan"), "changes: mesh.order must be a finite number, not nan"),
        (2**70, "changes: mesh.order must be a whole number of at most"),
        (1.5, "must be an integer, not '1.5'"),
        ({"a": 1}, "mesh.order"),
        ("", "the value is missing"),
        ([None], r"changes: mesh.order\[0\] must be a number"),
    ):
        with pytest.raises(softkin.InvalidInput, match=message):
            softkin.load(scene, changes={"mesh.order": value})


def test_files_of_another_kind(calls: dict[str, Call]) -> None:
    stl, msh = calls["mesh.read_surface"].given[0], calls["mesh.info"].given[0]
    with pytest.raises(softkin.InvalidInput, match="a.stl: is a surface by its name, not a scene in YAML: .*mesh generate"):
        softkin.load(stl)
    with pytest.raises(softkin.InvalidInput, match="a.msh: is a mesh by its name, not a scene in YAML: write a scene that names it"):
        softkin.load(msh)
    with pytest.raises(softkin.InvalidInput, match="chambers must be a dictionary or None, not 'cavity.stl'"):
        mesh.from_surfaces(stl, chambers="cavity.stl", edge_length=2)  # type: ignore[arg-type]


def test_a_body_that_is_fixed_whole() -> None:
    vertices, tetrahedra = block((2, 2, 2), (10, 10, 10))
    robot = softkin.Robot(
        vertices,
        tetrahedra,
        materials=[{"youngs_modulus": 1, "poisson_ratio": 0.4}],
        fixed=[{"box": ((-1, -1, -1), (11, 11, 11))}],
        actuators=[{"name": "t", "kind": "cable", "points": [(0, 5, 5), (10, 5, 5)], "control": "tension", "range": (0, 1)}],
    )
    try:
        shape = robot.solve(t=0.5)
    except softkin.InvalidInput as error:
        check_sentence(str(error))
    else:
        np.testing.assert_array_equal(shape.positions, robot.rest)
