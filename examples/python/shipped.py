"""Where the examples that come with softkin are, seen from a script and from a notebook."""

from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[1]
