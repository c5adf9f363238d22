"""Compares the numbers of two reports of one command by unit."""

import json
import re

UNITS = {"mm": "mm", "kPa": "kPa", "N": "N", "MPa": "MPa", "deg": "degrees", "kV": "kV", "mT": "mT"}
# keys that describe the solution process, and its accuracy
IGNORED = {"seconds", "elapsed_s", "iterations", "residual", "residual_N", "pull_N", "step_mm", "tolerance_mm",
           "history",
           "estimated_error_mm", "predicted_mm", "corrected_mm", "projections", "factorisations",
           "factorisations_in_double",
           "shape_fingerprint", "instruction_set", "threads", "softkin", "at_mm", "where_mm", "element", "region",
           "volume_shares", "bin_edges"}  # the last two count elements on both sides of bounds
POSITIONS = {"markers"}  # [mm], although the keys do not contain the unit


def unit_of(key, within):
    """Returns the unit after the last underscore of a key, else that of the enclosing value; "-" for none."""
    if key.endswith("_N_mm"):
        return "N mm"
    end = re.search(r"_([A-Za-z]+)$", key)
    if end and end.group(1) in UNITS:
        return UNITS[end.group(1)]
    return "mm" if key in POSITIONS else within


def leaves(value, unit="-", path=""):
    """Yields (path, unit, value) of every result of a report, number or text; of a failed solve only its status."""
    if isinstance(value, dict) and "iterations" in value and value.get("status") not in ("converged", None):
        yield f"{path}.status", unit, value["status"]
    elif isinstance(value, dict):
        for key, inner in value.items():
            if key not in IGNORED:
                yield from leaves(inner, unit_of(key, unit), f"{path}.{key}")
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from leaves(inner, unit, f"{path}[{number}]")
    elif value is not None:
        yield path, unit, value


def reports_of(outputs):
    """Yields the reports among the outputs of a case: files, and standard output as JSON."""
    for name, content in sorted(outputs.items()):
        if name.endswith(".json") or name.endswith("standard output"):
            try:
                yield name, json.loads(content)
            except ValueError:
                pass


def relative_difference(unit, difference, value, scale):
    """Returns a difference over the largest number of its unit (without a unit, over the number itself), or over 1."""
    if unit == "-":
        return difference / max(abs(value), 1)
    return difference / max(scale[unit], 1)


def compared(first, second):
    """Returns the largest difference by unit, absolute and relative, and the files, keys and texts that differ."""
    largest, other = {}, []
    left, right = dict(reports_of(first)), dict(reports_of(second))
    other += [f"{name}: only in one" for name in left.keys() ^ right.keys()]
    for name in left.keys() & right.keys():
        a, b = ({path: (unit, value) for path, unit, value in leaves(report)} for report in (left[name], right[name]))
        other += [f"{name}: {path}: only in one" for path in sorted(a.keys() ^ b.keys())[:3]]
        scale = {}
        for unit, value in a.values():
            if isinstance(value, (int, float)):
                scale[unit] = max(scale.get(unit, 0), abs(value))
        for path in a.keys() & b.keys():
            (unit, x), (_, y) = a[path], b[path]
            if isinstance(x, bool) or isinstance(x, str) or isinstance(y, str):
                other += [f"{name}: {path}: {x} and {y}"] if x != y else []
            elif x != y:
                difference = abs(x - y)
                if difference > largest.get(unit, (0, 0))[0]:
                    largest[unit] = (difference, relative_difference(unit, difference, x, scale))
    return largest, other
