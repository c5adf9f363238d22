#!/usr/bin/env python3
"""Writes flower.csv: five petals, 121 points, 63 mm across along x and 70 mm along z, closed."""

import math
import pathlib

PETALS, DEPTH, POINTS, WIDTH, HEIGHT = 5, 0.25, 121, 63.0, 70.0


def outline(angle):
    radius = 1 + DEPTH * math.cos(PETALS * angle)
    return radius * math.sin(angle), radius * math.cos(angle)


def points():
    flower = [outline(2 * math.pi * i / (POINTS - 1)) for i in range(POINTS)]
    sizes = [max(values) - min(values) for values in zip(*flower)]
    return [(x * WIDTH / sizes[0], z * HEIGHT / sizes[1]) for x, z in flower]


if __name__ == "__main__":
    rows = [f"{0.1 * i:.1f},{x:.4f},{z:.4f}" for i, (x, z) in enumerate(points())]
    pathlib.Path(__file__).with_name("flower.csv").write_text("\n".join(["t_s,x_mm,z_mm", *rows, ""]))
