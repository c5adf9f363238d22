"""What this softkin was built as, and what of it runs here."""

from typing import NamedTuple

from . import _core


class BuildInfo(NamedTuple):
    """version: of the library; instruction_set: for which the inner loops were compiled that run, "avx2"; those that
    this processor has, the best first. The environment's SOFTKIN_TARGET names another one of them before softkin is
    imported."""

    version: str
    instruction_set: str
    instruction_sets_here: tuple[str, ...]


build_info = BuildInfo(_core.version, _core.instruction_set, _core.instruction_sets_here)
