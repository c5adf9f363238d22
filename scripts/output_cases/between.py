"""By how much the numbers of two reports of one command differ, by their unit."""

import json
import re

UNITS = {"mm": "mm", "kPa": "kPa", "N": "N", "MPa": "MPa", "deg": "degrees", "kV": "kV", "mT": "mT"}
# what says how an answer was found, and how well
PASSED = {"seconds", "elapsed_s", "iterations", "residual", "residual_N", "pull_N", "step_mm", "tolerance_mm", "history",
          "estimated_error_mm", "predicted_mm", "corrected_mm", "projections", "factorisations", "factorisations_in_double",
          "shape_fingerprint", "instruction_set", "threads", "softkin", "at_mm", "where_mm", "element", "region",
          "volume_shares", "bin_edges"}  # the last two count elements on both sides of bounds
PLACES = {"markers"}  # [mm], though their keys do not say so


def unit_of(key, within):
    """The unit that a key names after its last underscore, else that of what it stands in; none: "-"."""
    if key.endswith("_N_mm"):
        return "N mm"
    end = re.search(r"_([A-Za-z]+)$", key)
    if end and end.group(1) in UNITS:
        return UNITS[end.group(1)]
    return "mm" if key in PLACES else within


def leaves(value, unit="-", path=""):
    """(path, unit, value) of every number and text of a report that is an answer: one that did not converge is none."""
    if isinstance(value, dict) and "iterations" in value and value.get("status") not in ("converged", None):
        yield f"{path}.status", unit, value["status"]
    elif isinstance(value, dict):
        for key, inner in value.items():
            if key not in PASSED:
                yield from leaves(inner, unit_of(key, unit), f"{path}.{key}")
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from leaves(inner, unit, f"{path}[{number}]")
    elif value is not None:
        yield path, unit, value


def reports_of(left):
    """The reports among what a case has left: files, and what was printed as JSON."""
    for name, content in sorted(left.items()):
        if name.endswith(".json") or name.endswith("standard output"):
            try:
                yield name, json.loads(content)
            except ValueError:
                pass


def share_of(unit, apart, value, scale):
    """What a difference is of the largest number of its unit, of numbers without one of the number itself; or of 1."""
    if unit == "-":
        return apart / max(abs(value), 1)
    return apart / max(scale[unit], 1)


def compared(first, second):
    """The largest difference by unit with what it is by the largest number of this unit in its report, and what is not a
    matter of digits: files, keys and words that are not the same."""
    largest, other = {}, []
    left, right = dict(reports_of(first)), dict(reports_of(second))
    other += [f"{name}: only of one" for name in left.keys() ^ right.keys()]
    for name in left.keys() & right.keys():
        a, b = ({path: (unit, value) for path, unit, value in leaves(report)} for report in (left[name], right[name]))
        other += [f"{name}: {path}: only of one" for path in sorted(a.keys() ^ b.keys())[:3]]
        scale = {}
        for unit, value in a.values():
            if isinstance(value, (int, float)):
                scale[unit] = max(scale.get(unit, 0), abs(value))
        for path in a.keys() & b.keys():
            (unit, x), (_, y) = a[path], b[path]
            if isinstance(x, bool) or isinstance(x, str) or isinstance(y, str):
                other += [f"{name}: {path}: {x} and {y}"] if x != y else []
            elif x != y:
                apart = abs(x - y)
                if apart > largest.get(unit, (0, 0))[0]:
                    largest[unit] = (apart, share_of(unit, apart, x, scale))
    return largest, other
