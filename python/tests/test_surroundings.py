"""What warms robots and what is around them."""

from __future__ import annotations

from typing import Any

import pytest
from beams import block

import softkin


def test_warm_bars_are_longer() -> None:
    warm = {
        "name": "warm",
        "kind": "growth",
        "region": "all",
        "range": (0, 100),
        "temperature": {"reference_C": 20, "expansion_per_K": 1e-3},
    }
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    robot = softkin.Robot(
        vertices,
        tetrahedra,
        materials=[{"youngs_modulus": 1, "poisson_ratio": 0}],
        fixed=[{"halfspace": {"point": (1e-6, 0, 0), "normal": (-1, 0, 0)}, "axes": "xyz"}],
        actuators=[{**warm, "direction": (1, 0, 0)}],
        markers={"tip": (60, 10, 10)},
    )
    (info,) = robot.actuator_infos
    assert (info.kind, info.control, info.unit, info.column) == ("growth", "temperature", "degC", "warm_degC")
    assert info.rest == 20
    shape = robot.solve(warm="70 degC").require()
    assert shape["tip"][0] == pytest.approx(63, abs=1e-6)
    assert shape.actuators["warm"].ratio == 70 and shape.actuators["warm"].load is None


def test_a_liquid_bears_what_is_as_heavy() -> None:
    vertices, tetrahedra = block((6, 2, 2), (60, 20, 20))
    description: dict[str, Any] = {
        "materials": [{"youngs_modulus": 0.05, "poisson_ratio": 0.5, "density": 1000}],
        "fixed": [{"halfspace": {"point": (1e-6, 0, 0), "normal": (-1, 0, 0)}}],
        "markers": {"tip": (60, 10, 10)},
        "gravity": (0, 0, -9.81),
        "order": 2,
    }
    sagging = softkin.Robot(vertices, tetrahedra, **description).solve().require()
    floating = softkin.Robot(vertices, tetrahedra, submerged={"level": 50}, **description).solve().require()
    assert sagging["tip"][2] < 9 and floating["tip"][2] == pytest.approx(10, abs=1e-4)
