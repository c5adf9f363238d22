"""Puts the pages of the documentation site together, for mkdocs (make docs): README, docs and examples with links that
hold there, what the commands and the Python package say of themselves, the C++ headers, pages of robots to bend.

  scripts/site.py FOLDER [--program build/softkin] [--without-robots]

Exit codes: 0 done, 1 a link of a document leads nowhere or a command failed."""

from __future__ import annotations

import argparse
import importlib
import inspect
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from cpp_reference import cpp_reference
from latex2mathml.converter import convert

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"(!?\[[^\]]*\]\()([^)\s]+)(\))")
FENCED = re.compile(r"(^```.*?^```)", re.M | re.S)
CODE = re.compile(r"(^```.*?^```|`[^`\n]+`)", re.M | re.S)
ROBOTS = {"pneumatic_finger": "path.csv", "three_chamber_actuator": "path.csv"}


class Lost(Exception):
    """A link that leads nowhere."""


def pages() -> dict[Path, str]:
    """Documents of the repository, and what they are called on the site."""
    named = {ROOT / "README.md": "index.md", ROOT / "examples/README.md": "examples.md"}
    named |= {ROOT / "CHANGELOG.md": "changes.md", ROOT / "CONTRIBUTING.md": "contributing.md"}
    named |= {file: file.name for file in sorted((ROOT / "docs").glob("*.md"))}
    for pattern in ("*/README.md", "paper/*/README.md", "real/*/README.md"):
        named |= {file: f"examples/{file.parent.name}.md" for file in sorted((ROOT / "examples").glob(pattern))}
    return named


class Site:
    """What is put together in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.named = pages()

    def write(self, name: str, text: str) -> None:
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def name_of(self, target: Path) -> str:
        """On the site, of a file or folder of the repository, which is copied there where it is no page."""
        if target in self.named:
            return self.named[target]
        if target.is_dir():
            if target / "README.md" in self.named:
                return self.named[target / "README.md"]
            name = f"files/{target.relative_to(ROOT)}.md"
            files = sorted(file for file in target.iterdir() if file.is_file() and file.suffix != ".ipynb")
            lines = [f"- [{file.name}]({os.path.relpath(self.name_of(file), Path(name).parent)})" for file in files]
            self.write(name, f"# {target.relative_to(ROOT)}\n\n" + "\n".join(lines) + "\n")
            return name
        inside = target.relative_to(ROOT / "docs") if target.is_relative_to(ROOT / "docs") else None
        name = str(inside) if inside else f"files/{target.relative_to(ROOT)}"
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(target, self.folder / name)
        return name

    def linked(self, file: Path, name: str, text: str) -> str:
        """Links of a document as they are on the site."""

        def moved(found: re.Match[str]) -> str:
            address, _, anchor = found[2].partition("#")
            if not address or re.match(r"[a-z]+:", address):
                return found[0]
            target = Path(os.path.normpath(file.parent / address))
            if not target.exists() or not target.is_relative_to(ROOT):
                raise Lost(f"{file.relative_to(ROOT)}: {found[2]} leads nowhere")
            place = os.path.relpath(self.name_of(target), Path(name).parent)
            return found[1] + place + (f"#{anchor}" if anchor else "") + found[3]

        parts = FENCED.split(text)  # code stands at odd places
        return "".join(part if i % 2 else LINK.sub(moved, part) for i, part in enumerate(parts))

    def take(self, file: Path, name: str) -> None:
        text = self.linked(file, name, file.read_text(encoding="utf-8"))
        if "$$" in text or name == "theory.md":
            text = with_equations(text)
        depth = "../" * name.count("/")
        frame = rf'<iframe src="{depth}robots/\1.html" width="100%" height="620" style="border:0" title="\1"></iframe>'
        self.write(name, re.sub(r"<!-- robot: (\w+) -->", frame, text))


def with_equations(text: str) -> str:
    """LaTeX as MathML, which browsers draw without a script."""
    parts = CODE.split(text)
    for i in range(0, len(parts), 2):
        parts[i] = re.sub(r"\$\$(.+?)\$\$", lambda m: convert(m[1].strip(), display="block"), parts[i], flags=re.S)
        parts[i] = re.sub(r"\$([^$\n]+)\$", lambda m: convert(m[1]), parts[i])
    return "".join(parts)


def told(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode != 0:
        raise Lost(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def commands(program: str) -> str:
    """Every command's own help."""
    text = "# Commands\n\nWhat every command says with `--help`.\n"

    def of(words: list[str]) -> str:
        help_text = told([program, *words, "--help"])
        section = f"\n## softkin {' '.join(words)}\n\n```text\n{help_text.rstrip()}\n```\n"
        listed = re.search(r"^Subcommands:\n(.*?)(?:\n\S|\Z)", help_text, re.M | re.S)
        names = re.findall(r"^  (\w[\w-]*)", listed[1], re.M) if listed and words != ["measure"] else []
        return section + "".join(of([*words, name]) for name in names)

    top = told([program, "--help"])
    names = re.findall(r"^  (\w[\w-]*)", top[top.index("Subcommands:") :], re.M)
    return text + "".join(of([name]) for name in names)


def docstring(value: Any) -> str:
    text = inspect.getdoc(value) or ""
    return f"\n```text\n{text}\n```\n" if "\n" in text else f"\n{text}\n"


def of_member(owner: type, name: str) -> str:
    value = inspect.getattr_static(owner, name)
    if isinstance(value, property):
        return f"\n#### {name}\n{docstring(value.fget)}"
    called = getattr(owner, name)
    if not callable(called):
        return ""
    try:
        given = str(inspect.signature(called))
    except (TypeError, ValueError):
        given = "(...)"
    return f"\n#### {name}\n\n```python\n{name}{given}\n```\n{docstring(called)}"


def python_reference(package: ModuleType) -> str:
    """Classes and functions with their docstrings."""
    text = "# Python docstrings\n\nWhat `help()` says of each name of the package.\n"
    for name in package.__all__:
        value = getattr(package, name)
        if isinstance(value, str):
            continue
        text += f"\n## {name}\n{docstring(value)}"
        if inspect.ismodule(value):
            for inner in getattr(value, "__all__", []):
                each = getattr(value, inner)
                if inspect.isfunction(each):
                    text += f"\n### {name}.{inner}\n\n```python\n{inner}{inspect.signature(each)}\n```\n{docstring(each)}"
        elif inspect.isclass(value):
            members = {member: base for base in reversed(value.__mro__) for member in vars(base) if base is not object}
            for member in sorted(members):
                if not member.startswith("_"):
                    text += of_member(value, member)
    return text


def bend_robots(program: str, folder: Path) -> None:
    """Pages of robots with their maps."""
    made = ROOT / "build-docs/maps"
    for name, path in ROBOTS.items():
        scene, example = f"examples/{name}/{name}.yaml", f"examples/{name}/{path}"
        kept = made / f"{name}.skmap"
        made.mkdir(parents=True, exist_ok=True)
        (folder / "robots").mkdir(parents=True, exist_ok=True)
        print(f"site: {name}: a map, and its page", flush=True)
        told([program, "map", scene, "-o", str(kept), "--check", "20"])
        page = str(folder / "robots" / f"{name}.html")
        told([program, "fk", scene, "--path", example, "--map", str(kept), "--html", page])


def main() -> int:
    asked = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    asked.add_argument("folder", type=Path)
    asked.add_argument("--program", default=str(ROOT / "build/softkin"))
    asked.add_argument("--without-robots", action="store_true", help="no pages of robots: they take a minute")
    options = asked.parse_args()
    shutil.rmtree(options.folder, ignore_errors=True)
    site = Site(options.folder)
    try:
        for file, name in site.named.items():
            site.take(file, name)
        site.write("reference/commands.md", commands(options.program))
        site.write("reference/cpp.md", cpp_reference())
        site.write("reference/python.md", python_reference(importlib.import_module("softkin")))
        if not options.without_robots:
            bend_robots(options.program, options.folder)
    except Lost as error:
        print(f"site: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
