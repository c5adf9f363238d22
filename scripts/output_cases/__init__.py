"""Cases of scripts/same_outputs.py: commands whose outputs a refactoring must not change."""

from . import examples, refusals, runs


def all_cases():
    cases = [*runs.cases(), *examples.cases(), *refusals.cases()]
    names = [case.name for case in cases]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ValueError("cases of one name: " + ", ".join(twice))
    return cases
