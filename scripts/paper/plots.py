"""Plots lines and bars as SVG, each with its data as CSV."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 400, 70, 170, 30, 50
COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf", "#7f7f7f", "#8c564b")


@dataclass
class Curve:
    """One line or set of points of a plot."""

    name: str  # if empty, the curve is thin and grey, and not in the legend
    x: Sequence[float]
    y: Sequence[float]
    points: bool = False  # draw points instead of a line
    filled: bool = False  # fill the area down to the axis


def ticks(low: float, high: float) -> list[float]:
    """Returns round values from low to high, at most seven."""
    step = 10 ** math.floor(math.log10((high - low) / 4))
    step *= next(m for m in (1, 2, 5, 10) if (high - low) / (m * step) <= 6)
    return [step * i for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


class Axis:
    """Maps values to the coordinates of a picture."""

    def __init__(self, values: list[float], log: bool, begin: float, end: float) -> None:
        self.log, self.begin, self.end = log, begin, end
        values = [math.log10(v) for v in values] if log else values
        self.low, self.high = min(values), max(values)
        if self.low == self.high:
            self.low, self.high = self.low - 0.5, self.high + 0.5
        if log:
            self.low, self.high = math.floor(self.low), math.ceil(self.high)

    def coordinate(self, value: float) -> float:
        value = math.log10(value) if self.log else value
        return self.begin + (value - self.low) / (self.high - self.low) * (self.end - self.begin)

    def marks(self) -> list[float]:
        if self.log:
            return [10.0**i for i in range(int(self.low), int(self.high) + 1)]
        return ticks(self.low, self.high)


def plot(file: Path, curves: list[Curve], x: str, y: str, *, log: str = "", even: bool = False) -> None:
    """Writes the plot to file, and its data next to it as .csv.

    log   logarithmic axes: "", "x", "y" or "xy"
    even  whether both axes have the same scale
    """
    across = Axis([v for c in curves for v in c.x], "x" in log, LEFT, WIDTH - RIGHT)
    up = Axis([v for c in curves for v in c.y], "y" in log, HEIGHT - BOTTOM, TOP)
    if even:
        scale = max((across.high - across.low) / (across.end - across.begin), (up.high - up.low) / (up.begin - up.end))
        across.high, up.high = across.low + scale * (across.end - across.begin), up.low + scale * (up.begin - up.end)
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">']
    svg.append(f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>')
    for value in across.marks():
        x_at = across.coordinate(value)
        svg.append(f'<path d="M{x_at:.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>')
        svg.append(f'<text x="{x_at:.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{value:g}</text>')
    for value in up.marks():
        y_at = up.coordinate(value)
        svg.append(f'<path d="M{LEFT} {y_at:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>')
        svg.append(f'<text x="{LEFT - 6}" y="{y_at + 4:.1f}" text-anchor="end">{value:g}</text>')
    svg.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 12}" text-anchor="middle">{x}</text>')
    middle = (TOP + HEIGHT - BOTTOM) / 2
    svg.append(f'<text transform="translate(16 {middle}) rotate(-90)" text-anchor="middle">{y}</text>')
    for i, curve in enumerate(sorted(curves, key=lambda c: c.name == "")):
        colour = COLOURS[i % len(COLOURS)] if curve.name else "#999"
        places = [f"{across.coordinate(a):.1f} {up.coordinate(b):.1f}" for a, b in zip(curve.x, curve.y)]
        if curve.points:
            svg += [f'<circle cx="{p.split()[0]}" cy="{p.split()[1]}" r="2.5" fill="{colour}"/>' for p in places]
        else:
            if curve.filled:
                ends = [f"{across.coordinate(curve.x[end]):.1f} {HEIGHT - BOTTOM}" for end in (-1, 0)]
                svg.append(f'<path d="M{"L".join([*places, *ends])}Z" fill="{colour}" fill-opacity="0.25"/>')
            svg.append(f'<path d="M{"L".join(places)}" fill="none" stroke="{colour}" stroke-width="{1.5 if curve.name else 0.7}"/>')
        if not curve.name:
            continue
        svg.append(f'<path d="M{WIDTH - RIGHT + 10} {TOP + 18 * i}h18" stroke="{colour}" stroke-width="2"/>')
        svg.append(f'<text x="{WIDTH - RIGHT + 34}" y="{TOP + 4 + 18 * i}">{curve.name}</text>')
    file.write_text("\n".join([*svg, "</svg>\n"]))
    rows = [f"{curve.name},{a!r},{b!r}" for curve in curves for a, b in zip(curve.x, curve.y)]
    file.with_suffix(".csv").write_text("\n".join([f"curve,{x},{y}", *rows]) + "\n")
