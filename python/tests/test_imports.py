"""No module of the package imports itself through others."""

from __future__ import annotations

import ast
import graphlib
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "softkin"


def name_of(file: Path) -> str:
    parts = file.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {name_of(file): file for file in sorted(PACKAGE.rglob("*.py"))}


def imported(node: ast.Import | ast.ImportFrom, importer: str) -> Iterator[tuple[str, str]]:
    """Modules of the package, and what is taken of them."""
    for alias in node.names:
        if isinstance(node, ast.Import):
            root, _, path = alias.name.partition(".")
            if root == "softkin" and path in MODULES:
                yield path, ""
            continue
        package = importer if MODULES[importer].name == "__init__.py" else importer.rpartition(".")[0]
        above = package.split(".") if package else []
        if node.level == 0:
            root, _, path = (node.module or "").partition(".")
            if root != "softkin":
                continue
        else:
            path = ".".join([*above[: len(above) - node.level + 1], *([node.module] if node.module else [])])
        if alias.name in ("_core", "_vision"):
            continue
        inner = f"{path}.{alias.name}" if path else alias.name
        yield (inner, "") if inner in MODULES else (path, alias.name)


def is_for_types(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def edges(importer: str) -> tuple[set[str], set[tuple[str, str]]]:
    """What a module imports, in functions too; and for types alone."""
    tree = ast.parse(MODULES[importer].read_text())
    for_types = {id(inner) for node in ast.walk(tree) if is_for_types(node) for inner in ast.walk(node)}
    needed: set[str] = set()
    typed: set[tuple[str, str]] = set()
    for node in ast.walk(tree):
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            for module, name in imported(node, importer):
                if id(node) in for_types:
                    typed.add((module, name))
                else:
                    needed.add(module)
    return needed - {importer, "_core"}, typed


def test_there_is_no_circle() -> None:
    """Nor one for types, but that what is of a robot names the class Robot."""
    graph: dict[str, set[str]] = {}
    to_robot = set()
    for module in MODULES:
        needed, typed = edges(module)
        to_robot |= {module for other, name in typed if (other, name) == ("robot", "Robot")}
        graph[module] = needed | {other for other, name in typed if (other, name) != ("robot", "Robot")}
    assert sum(map(len, graph.values())) > 100  # so that they are found
    list(graphlib.TopologicalSorter(graph).static_order())  # raises CycleError, which names them
    assert to_robot == {"_of_robot", "_solving", "estimate", "session"}


def test_circles_are_found() -> None:
    node = ast.parse("from ..shape import Shape\nfrom . import files\nimport softkin.robot\n").body
    assert [list(imported(each, "mesh.files")) for each in node] == [  # type: ignore[arg-type]
        [("shape", "Shape")],
        [("mesh.files", "")],
        [("robot", "")],
    ]


def test_files_are_short() -> None:
    long = {name: lines for name, file in MODULES.items() if (lines := len(file.read_text().splitlines())) > 400}
    assert long == {}
