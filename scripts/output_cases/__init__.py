"""Cases of scripts/same_outputs.py: commands whose outputs a refactoring must not change."""

from . import examples, refusals, runs, table_refusals, table_runs


def all_cases():
    """Returns all cases, whose names must be unique."""
    cases = [case for part in (runs, table_runs, examples, refusals, table_refusals) for case in part.cases()]
    names = [case.name for case in cases]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError("several cases have the same name: " + ", ".join(twice))
    return cases
