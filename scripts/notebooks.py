#!/usr/bin/env python3
"""Makes the notebooks of examples/python from its scripts: a cell begins at each line `# %%`; the docstring before the
first one becomes text. Scripts without such a line are modules of the others."""

from __future__ import annotations

import ast
import json
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[1] / "examples" / "python"
MARK = "# %%\n"


def notebook(script: Path) -> str | None:
    """Returns the notebook of a script, without outputs, in JSON; None if the script has no cells."""
    head, *bodies = script.read_text().split(MARK)
    if not bodies:
        return None
    docstring = ast.get_docstring(ast.parse(head))
    title = script.stem.replace("_", " ").capitalize()
    cells: list[dict[str, object]] = [
        {"cell_type": "markdown", "id": "about", "metadata": {}, "source": lines(f"# {title}\n\n{docstring}")}
    ]
    for number, body in enumerate(bodies, start=1):
        cell: dict[str, object] = {"cell_type": "code", "execution_count": None, "id": f"cell-{number}", "metadata": {}, "outputs": []}
        cells.append({**cell, "source": lines(body.strip())})
    metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    return json.dumps({"cells": cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}, indent=1) + "\n"


def lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


if __name__ == "__main__":
    for script in sorted(SCRIPTS.glob("*.py")):
        if (made := notebook(script)) is not None:
            script.with_suffix(".ipynb").write_text(made)
            print(script.with_suffix(".ipynb"))
