"""Makes a page of the documentation site from the public C++ headers: their declarations with docstrings, without
private members, bodies of functions and declarations that only the compiler needs. scripts/site.py writes the page."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MODULES = {
    "": "Facade",
    "core": "Basis of all other modules",
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
    """Returns the headers of cmake/public_headers.cmake."""
    text = (ROOT / "cmake/public_headers.cmake").read_text(encoding="utf-8")
    found = re.search(r"set\(softkin_public_headers\s+([^)]*)\)", text)
    assert found
    return found[1].split()


def header_descriptions() -> dict[str, str]:
    """Returns the description of each header in docs/cpp.md."""
    text = (ROOT / "docs/cpp.md").read_text(encoding="utf-8")
    return dict(re.findall(r"^\| `([\w/]+\.hpp)` \| (.*) \|$", text, re.M))


class Declarations:
    """Extracts the declarations of a header that are for programs."""

    def __init__(self, text: str) -> None:
        text = re.sub(r"^#(?:.*\\\n)*.*\n", "", text, flags=re.M)
        self.text = text
        self.position = 0
        self.namespaces: list[str] = []
        body = self.read_scope(True)
        self.body = re.sub(r"\n{3,}", "\n\n", body).strip()

    def skip_literal(self, at: int) -> int:
        """Returns the position behind a comment or a literal that begins at a position, else the position itself."""
        found = SKIPPED.match(self.text, at)
        # in a number such as 1'000 the quote begins no literal
        if not found or (self.text[at] == "'" and self.text[at - 1].isdigit()):
            return at
        return found.end()

    def skip_brackets(self, at: int) -> int:
        """Returns the position behind the bracket that closes the one at a position."""
        depth = 0
        while True:
            behind = self.skip_literal(at)
            if behind > at:
                at = behind
                continue
            depth += (self.text[at] in "({[") - (self.text[at] in ")}]")
            at += 1
            if depth == 0:
                return at

    def line_end(self, at: int) -> int:
        """Returns the position behind a comment on the rest of the line and on the lines that continue it."""
        found = re.compile(r"[ ]*(//[^\n]*)?").match(self.text, at)
        assert found
        if not found[1]:
            return at
        column = found.start(1) - self.text.rfind("\n", 0, at) - 1
        more = re.compile(r"\n {%d}//[^\n]*" % column)
        end = found.end()
        while continued := more.match(self.text, end):
            end = continued.end()
        return end

    def read_head(self) -> tuple[str, str, str]:
        """Reads up to the `;` or `{` that ends a declaration or begins its body.

        Returns this text; the text without initialisers of members; and the name if it is a function.
        """
        begin, cut, name = self.position, None, ""
        angles, called, assigned, before = 0, False, False, ""
        kind = re.match(r"(?:template\s*<[^{};]*>\s*)?(?:class|struct|union|enum|namespace)\b", self.text[begin:])
        while self.position < len(self.text):
            behind = self.skip_literal(self.position)
            if behind > self.position:
                self.position = behind
                continue
            sign = self.text[self.position]
            if sign == ";":
                break
            if sign == "{":
                value = assigned or not called or (cut is not None and before not in ")}")
                if kind or not value:
                    break
            if sign in "({[":
                if sign == "(" and angles == 0 and not assigned and not called:
                    called = True
                    name = re.split(r"[\s*&]", self.text[begin : self.position])[-1]
                self.position = self.skip_brackets(self.position)
                before = self.text[self.position - 1]
                continue
            if sign == ":" and called and cut is None and self.text[self.position - 1 : self.position + 2] == " : ":
                cut = self.position
            assigned = assigned or (sign == "=" and "operator" not in self.text[begin : self.position])
            angles += (sign == "<") - (sign == ">" and before != "-") if not assigned else 0
            before = sign if not sign.isspace() else before
            self.position += 1
        return self.text[begin : self.position], self.text[begin : cut or self.position].rstrip(), name

    def read_scope(self, is_public: bool) -> str:
        """Reads up to the end of a namespace or a class; returns its public declarations."""
        public = ""
        while self.position < len(self.text):
            found = re.compile(r"(?:\s|//[^\n]*)*").match(self.text, self.position)
            assert found
            self.position = found.end()
            before = found[0]
            if self.text[self.position : self.position + 1] == "}":
                break
            label = re.compile(r"(public|private|protected):(?!:)").match(self.text, self.position)
            if label:
                self.position = label.end()
                is_public = label[1] == "public"
                public += before + label[0] if is_public else ""
                continue
            if self.position < len(self.text):
                item = self.read_item()
                public += before + item if item and is_public else ""
        self.position += 1
        return public

    def read_item(self) -> str:
        """Reads a declaration; returns an empty text if it is not for programs."""
        whole, head, name = self.read_head()
        if self.position >= len(self.text):
            return ""
        if whole.startswith("namespace") and self.text[self.position] == "{":
            self.position += 1
            self.namespaces.append(whole.split()[1])
            return self.read_scope(True)
        kind = re.match(r"(?:template\s*<[^{};]*>\s*)?(class|struct|union|enum)\b", head)
        body = self.text[self.position] == "{"
        if body and kind and kind[1] != "enum":
            self.position += 1
            opened = self.line_end(self.position)
            comment = self.text[self.position : opened]
            self.position = opened
            inside = self.read_scope(kind[1] != "class")
            end = self.text.index(";", self.position) + 1
            rest = self.text[self.position : end]
            self.position = end
            indent = " " * (len(inside) and self.indent(self.text.rfind("}", 0, end)))
            members = f"{inside.rstrip()}\n{indent}" if inside.strip() else ""
            return f"{head} {{{comment}{members}}}{rest}" + self.read_comment()
        if body:
            begin = self.position
            self.position = self.skip_brackets(self.position)
            if kind:  # an enumeration
                self.position = self.text.index(";", self.position) + 1
                return whole + self.text[begin : self.position] + self.read_comment()
            comment = self.read_comment()
            return "" if "::" in name else head + ";" + comment  # a member of a class above, which has the docstring
        self.position += 1
        comment = self.read_comment()
        if re.match(r"(friend|static_assert)\b", head) or (kind and "(" not in head):
            return ""
        return whole + ";" + comment

    def read_comment(self) -> str:
        """Reads the comment behind a declaration."""
        end = self.line_end(self.position)
        comment = self.text[self.position : end]
        self.position = end
        return comment

    def indent(self, at: int) -> int:
        """Returns the indentation of the line at a position."""
        begin = self.text.rfind("\n", 0, at) + 1
        return len(self.text[begin:at]) - len(self.text[begin:at].lstrip())


def cpp_reference() -> str:
    """Returns the page: a list of the headers by module, then a section for each module and header."""
    headers, descriptions = public_headers(), header_descriptions()
    text = (
        "# C++ headers\n\nThe headers that programs include, with the docstrings of all that they declare: purpose, shapes, "
        "units, source, errors. [C++](../cpp.md) describes how to build with them. The page omits private members and "
        "bodies of functions.\n"
    )
    sections = ""
    for module, title in MODULES.items():
        own = [header for header in headers if header.rpartition("/")[0].split("/")[0] == module]
        text += f"\n**{title}**\n\n"
        sections += f"\n## {title}\n"
        for header in own:
            anchor = header.removesuffix(".hpp").replace("/", "-").replace("_", "-")
            text += f"- [softkin/{header}](#{anchor}): {descriptions[header]}\n"
            found = Declarations((ROOT / "src/softkin" / header).read_text(encoding="utf-8"))
            space = f"In namespace `{found.namespaces[-1]}`: " if found.namespaces else ""
            sections += f"\n### softkin/{header} {{ #{anchor} }}\n\n{space}{descriptions[header]}\n"
            sections += f"\n```cpp\n{found.body or includes_of(header)}\n```\n"
    return text + sections


def includes_of(header: str) -> str:
    """Returns the include lines of a header, for one that declares nothing."""
    text = (ROOT / "src/softkin" / header).read_text(encoding="utf-8")
    return "\n".join(re.findall(r"^#include .*$", text, re.M))
