"""Estimates of external forces from readings that the robot itself computed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import block

import softkin
from softkin import Estimate, Estimator, InvalidInput, PlannedReading, Robot, ToldNumber, ToldPlace


@pytest.fixture(scope="module")
def beam() -> Robot:
    """64 x 12 x 12 mm along x, held at x = 0, to be pushed on its top."""
    vertices, tetrahedra = block((8, 2, 2), (64, 12, 12))
    top = np.flatnonzero(vertices[:, 2] == 12)
    return Robot(
        vertices,
        tetrahedra,
        regions={"base": {"vertices": np.flatnonzero(vertices[:, 0] == 0)}, "top": {"vertices": top}},
        materials=[{"youngs_modulus": 1, "poisson_ratio": 0.4}],
        fixed=[{"region": "base"}],
        forces=[{"name": "push", "region": "top", "range": [[0, 0], [-0.1, 0.1], [-0.1, 0.1]]}],
        markers={"middle": [32, 12, 6], "end": [64, 6, 6], "side": [48, 0, 6]},
        sensors=[{"name": "strain", "kind": "length", "points": [[1, 6, 1], [60, 6, 1]]}],
        name="beam",
    )


DEVIATIONS = {f"{marker}_{axis}_mm": 0.02 for marker in ("middle", "end", "side") for axis in "xyz"}


def readings_of(shape: softkin.Shape) -> dict[str, float]:
    return {f"{name}_{axis}_mm": float(at[i]) for name, at in shape.markers.items() for i, axis in enumerate("xyz")}


def test_a_push_is_estimated_with_the_shape(beam: Robot) -> None:
    shape = beam.solve(push_fy=0.01, push_fz=-0.02)
    estimator = beam.estimator("push", DEVIATIONS)
    assert isinstance(estimator, Estimator)
    assert estimator.told_commands == ["push_fy", "push_fz"]
    reported = estimator.update(readings_of(shape))
    assert isinstance(reported, Estimate)
    assert reported.converged, reported.remark
    assert isinstance(reported.numbers["push_fz"], ToldNumber)
    assert reported.numbers["push_fy"].value == pytest.approx(0.01, abs=2e-4)
    assert reported.numbers["push_fz"].value == pytest.approx(-0.02, abs=2e-4)
    assert reported.numbers["push_fz"].unit == "N"
    assert 0 < reported.numbers["push_fz"].deviation < reported.numbers["push_fz"].known_deviation
    assert reported.covariance.shape == (2, 2)
    assert not reported.left_out
    assert reported.shape is not None
    np.testing.assert_allclose(reported.shape.positions, shape.positions, atol=0.05)
    assert reported.vertex_deviations.shape == (len(beam.rest), 3)
    assert reported.computed.shape == (9,)
    assert reported.misfit < 3
    assert reported.chi_square < 20
    assert reported.freedoms == pytest.approx(7, abs=0.5)


def test_the_place_of_a_push_is_estimated(beam: Robot) -> None:
    shape = beam.solve(push_fy=0.01, push_fz=-0.02)
    reported = beam.estimator(["push:place"], DEVIATIONS).update(readings_of(shape))
    place = reported.places["push"]
    assert isinstance(place, ToldPlace)
    assert place.at_rest.shape == (3,)
    assert np.trace(place.covariance) > 0


def test_missing_readings_increase_the_deviation(beam: Robot) -> None:
    readings = readings_of(beam.solve(push_fz=-0.02))
    estimator = beam.estimator("push", DEVIATIONS, fade_s=1)
    first = estimator.update(readings, time_s=0).numbers["push_fz"]
    second = estimator.update(readings, time_s=0.01).numbers["push_fz"]
    assert second.deviation < first.deviation
    later = estimator.update({"end_x_mm": math.nan}, time_s=50).numbers["push_fz"]
    assert later.deviation == pytest.approx(later.known_deviation)
    with pytest.raises(ValueError, match="must not go back"):
        estimator.update(readings, time_s=1)
    estimator.forget()
    assert estimator.update(readings, time_s=0).converged


def test_a_wrong_marker_is_named(beam: Robot) -> None:
    readings = readings_of(beam.solve(push_fz=-0.02))
    readings["side_z_mm"] += 4
    reported = beam.estimator("push", DEVIATIONS).update(readings)
    assert reported.left_out == ["marker side"]
    assert reported.words[-1] == "left out, as it contradicts the other readings: marker side"


def test_a_wrench_a_pressure_and_a_stiffness_are_estimated_from_directions_too() -> None:
    vertices, tetrahedra = block((8, 2, 2), (64, 12, 12))
    end = np.flatnonzero(vertices[:, 0] >= 56)

    def arm(modulus: float) -> Robot:
        return Robot(
            vertices,
            tetrahedra,
            regions={
                "base": {"vertices": np.flatnonzero(vertices[:, 0] == 0)},
                "tool": {"vertices": end},
                "top": {"vertices": np.flatnonzero(vertices[:, 2] == 12)},
            },
            materials=[{"youngs_modulus": modulus, "poisson_ratio": 0.4, "density": 1100}],
            gravity=[0, 0, -9.81],
            fixed=[{"region": "base"}],
            rigid=["tool"],
            forces=[{"name": "tool", "region": "tool", "moment_range": [[-20, 20], [-20, 20], [-20, 20]]}],
            tractions=[{"name": "hand", "region": "top", "range": [-1, 1]}],
            markers={"middle": [32, 12, 6], "end": [64, 6, 6]},
            sensors=[{"name": "imu", "kind": "direction", "region": "tool", "axis": [1, 0, 0]}],
            name="arm",
        )

    shape = arm(0.9).solve(tool_mx=6, tool_my=-4, tool_mz=8, hand=0.3)
    read = readings_of(shape)
    # any two points of a rigid part determine its direction
    front, back = (np.flatnonzero((vertices == at).all(axis=1))[0] for at in ([64, 0, 0], [56, 0, 0]))
    along = (shape.positions[front] - shape.positions[back]) / 8
    read |= {f"imu_direction_{axis}": float(along[i]) for i, axis in enumerate("xyz")}
    deviations = {name: 0.005 if name.endswith("_mm") else 2e-4 for name in read}
    estimator = arm(1).estimator(["tool", "hand", "materials.all.stiffness=1+-0.2"], deviations)
    assert estimator.told_commands == ["tool_mx", "tool_my", "tool_mz", "hand"]
    reported = estimator.update(read)
    assert reported.converged, reported.remark
    truth = {"tool_mx": 6, "tool_my": -4, "tool_mz": 8, "hand": 0.3, "materials.all.stiffness": 0.9}
    for name, value in truth.items():
        assert abs(reported.numbers[name].value - value) < reported.numbers[name].deviation, name
    assert reported.numbers["tool_mx"].unit == "N mm"
    assert reported.numbers["hand"].unit == "kPa"
    assert reported.numbers["materials.all.stiffness"].unit == ""
    assert reported.numbers["materials.all.stiffness"].deviation < 0.2


def test_refusals(beam: Robot) -> None:
    with pytest.raises(InvalidInput, match="no command of that name"):
        beam.estimator("pull", DEVIATIONS)
    with pytest.raises(InvalidInput, match="no marker"):
        beam.estimator("push", {"tip_x_mm": 1})
    with pytest.raises(InvalidInput, match="needs a deviation above 0"):
        beam.estimator("push", {"end_x_mm": 0})
    with pytest.raises(ValueError, match="no deviation is known"):
        beam.estimator("push", DEVIATIONS).update({"air": 1})
    with pytest.raises(ValueError, match="fade_s"):
        beam.estimator("push", DEVIATIONS, fade_s=-1)


def test_a_plan_says_what_to_read_further(beam: Robot) -> None:
    few = {name: value for name, value in DEVIATIONS.items() if name.startswith("middle")}
    estimator = beam.estimator("push:place", few)
    shape = beam.solve(push_fz=-0.02)
    reported = estimator.update({name: value for name, value in readings_of(shape).items() if name in few})
    assert reported.converged, reported.remark
    plan = estimator.plan(reported, {"marker_mm": 0.02, "length_mm": 0.02}, 2)
    assert len(plan) == 2
    best = plan[0]
    assert isinstance(best, PlannedReading)
    assert best.bits > plan[1].bits > 0
    assert best.vertex is None or best.at_rest is not None
    assert best.numbers["push_fz"] < reported.numbers["push_fz"].deviation
    assert plan[1].places["push"] < best.places["push"]
    strain = estimator.plan([reported], {"length_mm": 0.02})
    assert [reading.name for reading in strain] == ["strain (length)"]
    assert strain[0].vertex is None
    assert strain[0].at_rest is None
    with pytest.raises(ValueError, match="a plan is of"):
        estimator.plan(reported, {"tension_N": 1})
    with pytest.raises(ValueError, match="above 0"):
        estimator.plan(reported, {"marker_mm": 0})
    with pytest.raises(InvalidInput, match="needs the deviation"):
        estimator.plan(reported, {})
