"""A case, and the changes of files that its steps make between two commands."""

import dataclasses
import json
import re
import shlex
import typing

THREADS = {"fk", "ik", "follow", "walk", "workspace", "material", "predict"}  # commands that take --threads


@dataclasses.dataclass
class Case:
    """Steps that run in a new folder with these files and copies of the examples that the commands name.

    steps: the words of a command, by default with one thread, or a function of the folder.
    ends: exit code of the last command; None for any.
    clock: False if every time in the outputs comes from an input, so that all of them must be the same.
    """
    name: str
    steps: list
    files: dict = dataclasses.field(default_factory=dict)
    ends: typing.Optional[int] = 0
    clock: bool = True

    def __post_init__(self):
        self.steps = [step if callable(step) else words_of(step) for step in self.steps]

    def words(self):
        """Yields all words of the commands, and the texts of the files, which may name examples to be copied."""
        for step in self.steps:
            yield from () if callable(step) else step
        yield from (text for text in self.files.values() if isinstance(text, str))


def words_of(command):
    """Returns the words of a command, with one thread by default."""
    words = shlex.split(command) if isinstance(command, str) else list(command)
    first = set(words[:2]) | ({"predict"} if "--predict" in words else set())
    if first & THREADS and "--tensile" not in words and not {"--threads", "--help"} & set(words):
        words += ["--threads", "1"]
    return words


def keep_steps(file, count):
    """Truncates a report to its first steps, as an interrupted run writes it."""
    def edit(folder):
        report = json.loads((folder / file).read_text())
        report["steps"] = report["steps"][:count]
        (folder / file).write_text(json.dumps(report))
    return edit


def keep_lines(file, count, torn=""):
    """Truncates a table to its first lines. torn: the beginning of an incomplete next line."""
    def edit(folder):
        lines = (folder / file).read_text().splitlines(keepends=True)
        (folder / file).write_text("".join(lines[:count]) + torn)
    return edit


def keep_bytes(file, count):
    def edit(folder):
        (folder / file).write_bytes((folder / file).read_bytes()[:count])
    return edit


def change(file, pattern, by):
    """Replaces the matches of a regular expression in a text, of which there must be at least one."""
    def edit(folder):
        text, count = re.subn(pattern, by, (folder / file).read_text())
        if count == 0:
            raise ValueError(f"{file}: no match of {pattern}")
        (folder / file).write_text(text)
    return edit


def write(file, text):
    return lambda folder: (folder / file).write_text(text)


def remove(file):
    return lambda folder: (folder / file).unlink()


def fixed_seconds(*files):
    """Sets the times of reports to one value, so that outputs from the reports can be compared exactly."""
    def edit(folder):
        for file in files:
            change(file, r'("seconds":\s*)[-+0-9.eE]+', r"\g<1>1.5")(folder)
    return edit


def marker_path(report, file, marker, axes):
    """Writes a path for `follow` from the positions of a marker in a report, rounded to 1 um, every half second."""
    def edit(folder):
        rows = ["t_s," + ",".join(f"{marker}_{axis}_mm" for axis in axes)]
        for i, step in enumerate(json.loads((folder / report).read_text())["steps"]):
            place = step["markers"][marker]
            rows.append(f"{i / 2}," + ",".join(f"{place['xyz'.index(axis)]:.3f}" for axis in axes))
        (folder / file).write_text("\n".join(rows) + "\n")
    return edit
