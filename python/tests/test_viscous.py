"""Materials that remember."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from beams import beam

import softkin

ELASTIC = {"youngs_modulus": 1, "poisson_ratio": 0.4}
VISCOUS: dict[str, Any] = {**ELASTIC, "viscosity": [{"modulus": 0.5, "time": 2.0}, {"modulus": 0.2, "time": 20.0}]}


@pytest.fixture(scope="module")
def viscous() -> softkin.Robot:
    return beam(materials=[VISCOUS])


def pressure(shape: softkin.Shape) -> float:
    load = shape.require().actuators["air1"].load
    assert load is not None
    return load


def test_a_held_volume_relaxes(viscous: softkin.Robot) -> None:
    relaxed = pressure(viscous.solve(air1=1.3))
    assert relaxed == pytest.approx(pressure(beam(materials=[ELASTIC]).solve(air1=1.3)), rel=1e-9)
    shape = viscous.solve(air1=1.3, elapsed_s=0)
    pressures = [pressure(shape)]
    for _ in range(5):
        shape = viscous.solve(air1=1.3, start=shape, elapsed_s=1)
        pressures.append(pressure(shape))
    assert (np.diff(pressures) < 0).all()
    assert pressures[0] > 1.3 * relaxed
    assert pressure(viscous.solve(air1=1.3, start=shape, elapsed_s=1e8)) == pytest.approx(relaxed, rel=1e-6)
    # one step is near five
    at_once = viscous.solve(air1=1.3, start=viscous.solve(air1=1.3, elapsed_s=0), elapsed_s=5)
    assert pressure(at_once) == pytest.approx(pressures[-1], rel=1e-2)


def test_what_is_remembered_survives_a_pickle(viscous: softkin.Robot) -> None:
    shape = viscous.solve(air1=1.3, elapsed_s=0)
    again = pickle.loads(pickle.dumps(shape))
    for start in (shape, again):
        assert pressure(start.robot.solve(air1=1.2, start=start, elapsed_s=1)) == pytest.approx(
            pressure(viscous.solve(air1=1.2, start=shape, elapsed_s=1)), rel=1e-9
        )


def test_paths_and_sessions_agree(viscous: softkin.Robot) -> None:
    times, ratios = [0.0, 0.5, 1.0, 3.0], [1.0, 1.2, 1.3, 1.1]
    path = list(viscous.path([{"air1": ratio} for ratio in ratios], times=times))
    session = viscous.session()
    for i, (time, ratio) in enumerate(zip(times, ratios)):
        shape = session.solve(air1=ratio, elapsed_s=time - times[max(0, i - 1)])
        np.testing.assert_allclose(shape["tip"], path[i]["tip"], atol=1e-6)


def test_inverse_holds_a_tip_still(viscous: softkin.Robot) -> None:
    target = viscous.solve(air1=1.3)["tip"]
    wanted = (target[0], None, None)
    answer = viscous.inverse(tip=wanted, fix=["air2", "air3"], elapsed_s=0)
    commands = [answer.shape.actuation[0]]
    for _ in range(3):
        answer = viscous.inverse(tip=wanted, start=answer.shape, fix=["air2", "air3"], elapsed_s=2)
        assert answer.reached
        assert answer.shape["tip"][0] == pytest.approx(target[0], abs=2e-3)
        commands.append(answer.shape.actuation[0])
    assert len(set(commands)) == 4


def test_refuses_times_of_elastic_robots(robot: softkin.Robot) -> None:
    with pytest.raises(softkin.InvalidInput, match="elapsed_s is for viscous materials"):
        robot.solve(air1=1.1, elapsed_s=1)
    with pytest.raises(softkin.InvalidInput, match="0 s or more"):
        beam(materials=[VISCOUS]).solve(air1=1.1, elapsed_s=-1)
