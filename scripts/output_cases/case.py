"""A case, and what its steps may do to the files between two commands."""

import dataclasses
import json
import re
import shlex
import typing

THREADS = {"fk", "ik", "follow", "walk", "workspace", "material", "predict"}  # commands that take --threads


@dataclasses.dataclass
class Case:
    """Steps run in a fresh folder with these files and copies of the examples that the commands name.

    steps: the words of a command, one thread where nothing else is said, or a function of the folder.
    ends: exit code of the last command; None: any.
    clock: False where every time in the outputs is of an input, so that all of them have to be the same.
    """
    name: str
    steps: list
    files: dict = dataclasses.field(default_factory=dict)
    ends: typing.Optional[int] = 0
    clock: bool = True

    def __post_init__(self):
        self.steps = [step if callable(step) else words_of(step) for step in self.steps]

    def words(self):
        """All words of its commands, and the texts of its files: where they name examples, these are copied."""
        for step in self.steps:
            yield from () if callable(step) else step
        yield from (text for text in self.files.values() if isinstance(text, str))


def words_of(command):
    words = shlex.split(command) if isinstance(command, str) else list(command)
    first = set(words[:2]) | ({"predict"} if "--predict" in words else set())
    if first & THREADS and "--tensile" not in words and not {"--threads", "--help"} & set(words):
        words += ["--threads", "1"]
    return words


def keep_steps(file, count):
    """Cuts a report back to its first steps, as an interrupted run leaves it."""
    def edit(folder):
        report = json.loads((folder / file).read_text())
        report["steps"] = report["steps"][:count]
        (folder / file).write_text(json.dumps(report))
    return edit


def keep_lines(file, count, torn=""):
    """Cuts a table back to its first lines; torn: the beginning of one more."""
    def edit(folder):
        lines = (folder / file).read_text().splitlines(keepends=True)
        (folder / file).write_text("".join(lines[:count]) + torn)
    return edit


def keep_bytes(file, count):
    def edit(folder):
        (folder / file).write_bytes((folder / file).read_bytes()[:count])
    return edit


def change(file, pattern, by):
    """Replaces what a regular expression finds in a text; it has to find something."""
    def edit(folder):
        text, count = re.subn(pattern, by, (folder / file).read_text())
        if count == 0:
            raise ValueError(f"{file}: nothing matches {pattern}")
        (folder / file).write_text(text)
    return edit


def write(file, text):
    return lambda folder: (folder / file).write_text(text)


def remove(file):
    return lambda folder: (folder / file).unlink()


def fixed_seconds(*files):
    """Makes the times of reports the same, so that what is made of them can be compared exactly."""
    def edit(folder):
        for file in files:
            change(file, r'("seconds":\s*)[-+0-9.eE]+', r"\g<1>1.5")(folder)
    return edit


def marker_path(report, file, marker, axes):
    """A path for `follow` from the places of a marker in a report, to a micrometre, half a second apart."""
    def edit(folder):
        rows = ["t_s," + ",".join(f"{marker}_{axis}_mm" for axis in axes)]
        for i, step in enumerate(json.loads((folder / report).read_text())["steps"]):
            place = step["markers"][marker]
            rows.append(f"{i / 2}," + ",".join(f"{place['xyz'.index(axis)]:.3f}" for axis in axes))
        (folder / file).write_text("\n".join(rows) + "\n")
    return edit
