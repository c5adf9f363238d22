"""The public C++ headers as a page of the documentation site: their declarations with docstrings, without private
members, bodies of functions and what is there for the compiler alone. scripts/site.py writes it."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ROOMS = {
    "": "The door",
    "core": "What all others build on",
    "model": "Robots, described and compiled",
    "io": "Files",
    "statics": "Equilibria",
    "kinematics": "Kinematics",
    "drive": "Hardware",
    "calibration": "Calibration",
    "runs": "Runs, records and reports",
}
SKIPPED = re.compile(r"//[^\n]*|\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])'", re.S)


def public_headers() -> list[str]:
    """Of cmake/public_headers.cmake."""
    text = (ROOT / "cmake/public_headers.cmake").read_text(encoding="utf-8")
    found = re.search(r"set\(softkin_public_headers\s+([^)]*)\)", text)
    assert found
    return found[1].split()


def told_headers() -> dict[str, str]:
    """What docs/cpp.md says of each."""
    text = (ROOT / "docs/cpp.md").read_text(encoding="utf-8")
    return dict(re.findall(r"^\| `([\w/]+\.hpp)` \| (.*) \|$", text, re.M))


class Declarations:
    """The declarations of a header that a program sees."""

    def __init__(self, text: str) -> None:
        text = re.sub(r"^#(?:.*\\\n)*.*\n", "", text, flags=re.M)
        self.text = text
        self.at = 0
        self.namespaces: list[str] = []
        body = self.scope(True)
        self.body = re.sub(r"\n{3,}", "\n\n", body).strip()

    def skipped(self, at: int) -> int:
        """Behind a comment or a literal that begins here."""
        found = SKIPPED.match(self.text, at)
        # in a number such as 1'000 the sign begins nothing
        if not found or (self.text[at] == "'" and self.text[at - 1].isdigit()):
            return at
        return found.end()

    def closed(self, at: int) -> int:
        """Behind the sign that closes the one here."""
        depth = 0
        while True:
            behind = self.skipped(at)
            if behind > at:
                at = behind
                continue
            depth += (self.text[at] in "({[") - (self.text[at] in ")}]")
            at += 1
            if depth == 0:
                return at

    def line_end(self, at: int) -> int:
        """Behind a comment on the rest of the line, and the lines that go on with it."""
        found = re.compile(r"[ ]*(//[^\n]*)?").match(self.text, at)
        assert found
        if not found[1]:
            return at
        column = found.start(1) - self.text.rfind("\n", 0, at) - 1
        more = re.compile(r"\n {%d}//[^\n]*" % column)
        end = found.end()
        while going_on := more.match(self.text, end):
            end = going_on.end()
        return end

    def head(self) -> tuple[str, str, str]:
        """Up to the `;` or `{` that ends a declaration or begins its body; the same without what initialises members; and
        of a function its name."""
        begin, cut, name = self.at, None, ""
        angles, called, assigned, before = 0, False, False, ""
        kind = re.match(r"(?:template\s*<[^{};]*>\s*)?(?:class|struct|union|enum|namespace)\b", self.text[begin:])
        while self.at < len(self.text):
            behind = self.skipped(self.at)
            if behind > self.at:
                self.at = behind
                continue
            sign = self.text[self.at]
            if sign == ";":
                break
            if sign == "{":
                value = assigned or not called or (cut is not None and before not in ")}")
                if kind or not value:
                    break
            if sign in "({[":
                if sign == "(" and angles == 0 and not assigned and not called:
                    called = True
                    name = re.split(r"[\s*&]", self.text[begin : self.at])[-1]
                self.at = self.closed(self.at)
                before = self.text[self.at - 1]
                continue
            if sign == ":" and called and cut is None and self.text[self.at - 1 : self.at + 2] == " : ":
                cut = self.at
            assigned = assigned or (sign == "=" and "operator" not in self.text[begin : self.at])
            angles += (sign == "<") - (sign == ">" and before != "-") if not assigned else 0
            before = sign if not sign.isspace() else before
            self.at += 1
        return self.text[begin : self.at], self.text[begin : cut or self.at].rstrip(), name

    def scope(self, seen: bool) -> str:
        """What stands to the end of a namespace or a class."""
        shown = ""
        while self.at < len(self.text):
            found = re.compile(r"(?:\s|//[^\n]*)*").match(self.text, self.at)
            assert found
            self.at = found.end()
            before = found[0]
            if self.text[self.at : self.at + 1] == "}":
                break
            label = re.compile(r"(public|private|protected):(?!:)").match(self.text, self.at)
            if label:
                self.at = label.end()
                seen = label[1] == "public"
                shown += before + label[0] if seen else ""
                continue
            if self.at < len(self.text):
                item = self.item(seen)
                shown += before + item if item and seen else ""
        self.at += 1
        return shown

    def item(self, seen: bool) -> str:
        """One declaration; empty where it is not for programs."""
        whole, head, name = self.head()
        if self.at >= len(self.text):
            return ""
        if whole.startswith("namespace") and self.text[self.at] == "{":
            self.at += 1
            self.namespaces.append(whole.split()[1])
            return self.scope(True)
        kind = re.match(r"(?:template\s*<[^{};]*>\s*)?(class|struct|union|enum)\b", head)
        body = self.text[self.at] == "{"
        if body and kind and kind[1] != "enum":
            self.at += 1
            opened = self.line_end(self.at)
            comment = self.text[self.at : opened]
            self.at = opened
            inside = self.scope(kind[1] != "class")
            end = self.text.index(";", self.at) + 1
            rest = self.text[self.at : end]
            self.at = end
            indent = " " * (len(inside) and self.indent(self.text.rfind("}", 0, end)))
            members = f"{inside.rstrip()}\n{indent}" if inside.strip() else ""
            return f"{head} {{{comment}{members}}}{rest}" + self.behind()
        if body:
            begin = self.at
            self.at = self.closed(self.at)
            if kind:  # an enumeration
                self.at = self.text.index(";", self.at) + 1
                return whole + self.text[begin : self.at] + self.behind()
            comment = self.behind()
            return "" if "::" in name else head + ";" + comment  # of a class above: told there
        self.at += 1
        comment = self.behind()
        if re.match(r"(friend|static_assert)\b", head) or (kind and "(" not in head):
            return ""
        return whole + ";" + comment

    def behind(self) -> str:
        end = self.line_end(self.at)
        comment = self.text[self.at : end]
        self.at = end
        return comment

    def indent(self, at: int) -> int:
        begin = self.text.rfind("\n", 0, at) + 1
        return len(self.text[begin:at]) - len(self.text[begin:at].lstrip())


def cpp_reference() -> str:
    """A section for each room and header, with a table of them above."""
    headers, told = public_headers(), told_headers()
    text = (
        "# C++ headers\n\nThe headers that programs include, with the docstrings of all that they declare: purpose, shapes, "
        "units, source, errors. [C++](../cpp.md) says how to build with them. Private members and bodies of functions are "
        "left out.\n"
    )
    sections = ""
    for room, title in ROOMS.items():
        own = [header for header in headers if header.rpartition("/")[0].split("/")[0] == room]
        text += f"\n**{title}**\n\n"
        sections += f"\n## {title}\n"
        for header in own:
            anchor = header.removesuffix(".hpp").replace("/", "-").replace("_", "-")
            text += f"- [softkin/{header}](#{anchor}): {told[header]}\n"
            found = Declarations((ROOT / "src/softkin" / header).read_text(encoding="utf-8"))
            space = f"In namespace `{found.namespaces[-1]}`: " if found.namespaces else ""
            sections += f"\n### softkin/{header} {{ #{anchor} }}\n\n{space}{told[header]}\n"
            sections += f"\n```cpp\n{found.body or door(header)}\n```\n"
    return text + sections


def door(header: str) -> str:
    """What a header that declares nothing includes."""
    text = (ROOT / "src/softkin" / header).read_text(encoding="utf-8")
    return "\n".join(re.findall(r"^#include .*$", text, re.M))
