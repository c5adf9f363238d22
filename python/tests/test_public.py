"""Every public name is documented, typed, and used by a test."""

from __future__ import annotations

import inspect
import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

import softkin

TESTS = "\n".join(file.read_text() for file in Path(__file__).parent.glob("test_*.py"))
DOCUMENT = (Path(__file__).parents[2] / "docs/python.md").read_text()


def members(kind: type) -> list[str]:
    return [name for name in vars(kind) if not name.startswith("_")]


def public() -> list[str]:
    names = []
    for name in softkin.__all__:
        names.append(name)
        value = getattr(softkin, name)
        if inspect.isclass(value) and value.__module__.startswith("softkin") and not issubclass(value, (Exception, tuple)):
            for base in value.__mro__:
                if base.__module__.startswith("softkin"):
                    names += [f"{name}.{member}" for member in members(base)]
    return sorted(set(names))


@pytest.mark.parametrize("name", public())
def test_is_tested_and_documented(name: str) -> None:
    word = name.rpartition(".")[2]
    if not inspect.isclass(getattr(softkin, name, None)):  # of a class its members
        assert word in TESTS, f"no test uses {name}"
    assert word in DOCUMENT, f"docs/python.md does not describe {name}"


def test_all_is_sorted_and_there() -> None:
    assert softkin.__all__ == sorted(softkin.__all__)
    for name in softkin.__all__:
        assert hasattr(softkin, name)


def test_build_info() -> None:
    info = softkin.build_info
    assert info.version == softkin.__version__
    assert info.instruction_set in info.instruction_sets_here
    for requested in info.instruction_sets_here:
        code = "import softkin; print(softkin.build_info.instruction_set)"
        reported = subprocess.run(
            [sys.executable, "-c", code], env={**os.environ, "SOFTKIN_TARGET": requested}, capture_output=True, text=True
        )
        assert reported.stdout == requested + "\n"


def test_instruction_set_that_is_none() -> None:
    reported = subprocess.run(
        [sys.executable, "-c", "import softkin"],
        env={**os.environ, "SOFTKIN_TARGET": "mmx"},
        capture_output=True,
        text=True,
    )
    assert reported.returncode != 0
    assert "SOFTKIN_TARGET=mmx: not an instruction set" in reported.stderr


def test_version() -> None:
    assert softkin.__version__.count(".") == 2


def test_typed() -> None:
    folder = Path(softkin.__file__).parent
    assert (folder / "py.typed").exists() and (folder / "_core.pyi").exists()
    stub = "\n".join(line for line in (folder / "_core.pyi").read_text().splitlines() if not line.startswith("from typing"))
    assert re.findall(r"\bAny\b", stub) == []
    given = re.findall(r"(?:begin|kept|progress): ([^,)]*)", stub)  # functions of the user's
    assert len(given) >= 6 and all("Callable[[" in each for each in given)


def test_the_library_names_no_options_of_the_command() -> None:
    """Users of Python read the messages of the library, too."""
    source = Path(__file__).parents[2] / "src/softkin"
    named = [
        (str(file.relative_to(source)), text)
        for file in sorted(source.rglob("*.cpp"))
        for text in re.findall(r'"(?:[^"\\\n]|\\.)*"', file.read_text())
        if re.search(r"(?<![\w-])--[a-z]", text)
    ]
    passed_on = r'"--(width|grip|cells|law|poisson-ratio|stiffer)"'  # the caller names these options
    only_the_command = r"--fps|add --resume|softkin calibrate material --tensile|softkin fk --report"
    only_the_command += r"|\(in Python stable=True\)"  # names both
    only_the_command += r"|--force-overwrite|^\"--(material|change)\"$|^\"--turn: |softkin mesh generate --body"
    assert [each for each in named if not re.fullmatch(passed_on, each[1]) and not re.search(only_the_command, each[1])] == []


def test_stable_abi() -> None:
    """From Python 3.12 the wheel is for later versions, too; before, for the version that built it alone."""
    alone = sysconfig.get_config_var("EXT_SUFFIX")
    ending = ".abi3.so" if sys.version_info >= (3, 12) else alone
    assert Path(softkin._core.__file__).name == "_core" + ending
