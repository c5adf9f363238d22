"""The robots that come with softkin."""

from __future__ import annotations

from pathlib import Path

from . import _core


def example(name: str) -> Path:
    """The scene of an example, where it is installed; name: as `softkin examples list` has it, or its short one."""
    return Path(_core.example_scene(_core.__file__, name))
