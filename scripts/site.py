"""Collects the pages of the documentation site for mkdocs (make docs): README, docs and examples with adapted links,
the help of the commands, the docstrings of the Python package, the C++ headers, and interactive pages of robots.

  scripts/site.py FOLDER [--program build/softkin] [--without-robots]

Exit codes: 0 done, 1 a link of a document has no target or a command failed."""

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


class SiteError(Exception):
    """A link has no target, or a command failed."""


def pages() -> dict[Path, str]:
    """Returns the documents of the repository, with their names on the site."""
    named = {ROOT / "README.md": "index.md", ROOT / "examples/README.md": "examples.md"}
    named |= {ROOT / "CHANGELOG.md": "changes.md", ROOT / "CONTRIBUTING.md": "contributing.md"}
    named |= {file: file.name for file in sorted((ROOT / "docs").glob("*.md"))}
    for pattern in ("*/README.md", "paper/*/README.md", "real/*/README.md"):
        named |= {file: f"examples/{file.parent.name}.md" for file in sorted((ROOT / "examples").glob(pattern))}
    return named


class Site:
    """The pages of the site in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.named = pages()

    def write(self, name: str, text: str) -> None:
        """Writes a file of the site."""
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def name_of(self, target: Path) -> str:
        """Returns the name on the site of a file or folder of the repository; copies it there if it is not a page."""
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

    def adapt_links(self, file: Path, name: str, text: str) -> str:
        """Returns the text of a document with links that are valid on the site."""

        def adapted(found: re.Match[str]) -> str:
            address, _, anchor = found[2].partition("#")
            if not address or re.match(r"[a-z]+:", address):
                return found[0]
            target = Path(os.path.normpath(file.parent / address))
            if not target.exists() or not target.is_relative_to(ROOT):
                raise SiteError(f"{file.relative_to(ROOT)}: the link {found[2]} has no target")
            place = os.path.relpath(self.name_of(target), Path(name).parent)
            return found[1] + place + (f"#{anchor}" if anchor else "") + found[3]

        parts = FENCED.split(text)  # odd parts are code
        return "".join(part if i % 2 else LINK.sub(adapted, part) for i, part in enumerate(parts))

    def add_page(self, file: Path, name: str) -> None:
        """Writes a document of the repository as a page."""
        text = self.adapt_links(file, name, file.read_text(encoding="utf-8"))
        if "$$" in text or name == "theory.md":
            text = with_equations(text)
        depth = "../" * name.count("/")
        frame = rf'<iframe src="{depth}robots/\1.html" width="100%" height="620" style="border:0" title="\1"></iframe>'
        self.write(name, re.sub(r"<!-- robot: (\w+) -->", frame, text))


def with_equations(text: str) -> str:
    """Replaces LaTeX by MathML, which browsers draw without a script."""
    parts = CODE.split(text)
    for i in range(0, len(parts), 2):
        parts[i] = re.sub(r"\$\$(.+?)\$\$", lambda m: convert(m[1].strip(), display="block"), parts[i], flags=re.S)
        parts[i] = re.sub(r"\$([^$\n]+)\$", lambda m: convert(m[1]), parts[i])
    return "".join(parts)


def output_of(command: list[str]) -> str:
    """Runs a command; returns its standard output."""
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode != 0:
        raise SiteError(f"{' '.join(command)}: {done.stderr.strip()}")
    return done.stdout


def commands(program: str) -> str:
    """Returns the page of the help of every command."""
    text = "# Commands\n\nThe output of `--help` of every command.\n"

    def section_of(words: list[str]) -> str:
        help_text = output_of([program, *words, "--help"])
        section = f"\n## softkin {' '.join(words)}\n\n```text\n{help_text.rstrip()}\n```\n"
        listed = re.search(r"^Subcommands:\n(.*?)(?:\n\S|\Z)", help_text, re.M | re.S)
        names = re.findall(r"^  (\w[\w-]*)", listed[1], re.M) if listed and words != ["measure"] else []
        return section + "".join(section_of([*words, name]) for name in names)

    top = output_of([program, "--help"])
    names = re.findall(r"^  (\w[\w-]*)", top[top.index("Subcommands:") :], re.M)
    return text + "".join(section_of([name]) for name in names)


def docstring(value: Any) -> str:
    """Returns the docstring of a value as Markdown."""
    text = inspect.getdoc(value) or ""
    return f"\n```text\n{text}\n```\n" if "\n" in text else f"\n{text}\n"


def member_section(owner: type, name: str) -> str:
    """Returns the section of a property or method of a class; an empty text for other members."""
    value = inspect.getattr_static(owner, name)
    if isinstance(value, property):
        return f"\n#### {name}\n{docstring(value.fget)}"
    member = getattr(owner, name)
    if not callable(member):
        return ""
    try:
        signature = str(inspect.signature(member))
    except (TypeError, ValueError):
        signature = "(...)"
    return f"\n#### {name}\n\n```python\n{name}{signature}\n```\n{docstring(member)}"


def python_reference(package: ModuleType) -> str:
    """Returns the page of the classes and functions of the package with their docstrings."""
    text = "# Python docstrings\n\nThe docstring of each name of the package, as `help()` prints it.\n"
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
                    text += member_section(value, member)
    return text


def write_robots(program: str, folder: Path) -> None:
    """Writes the interactive pages of robots with their maps."""
    maps = ROOT / "build-docs/maps"
    for name, path in ROBOTS.items():
        scene, example = f"examples/{name}/{name}.yaml", f"examples/{name}/{path}"
        map_file = maps / f"{name}.skmap"
        maps.mkdir(parents=True, exist_ok=True)
        (folder / "robots").mkdir(parents=True, exist_ok=True)
        print(f"site: {name}: its map and its page", flush=True)
        output_of([program, "map", scene, "-o", str(map_file), "--check", "20"])
        page = str(folder / "robots" / f"{name}.html")
        output_of([program, "fk", scene, "--path", example, "--map", str(map_file), "--html", page])


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--program", default=str(ROOT / "build/softkin"))
    parser.add_argument("--without-robots", action="store_true", help="omit the pages of robots, which take a minute")
    options = parser.parse_args()
    shutil.rmtree(options.folder, ignore_errors=True)
    site = Site(options.folder)
    try:
        for file, name in site.named.items():
            site.add_page(file, name)
        site.write("reference/commands.md", commands(options.program))
        site.write("reference/cpp.md", cpp_reference())
        site.write("reference/python.md", python_reference(importlib.import_module("softkin")))
        if not options.without_robots:
            write_robots(options.program, options.folder)
    except SiteError as error:
        print(f"site: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
