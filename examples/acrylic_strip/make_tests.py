"""Writes cycles.csv and creep.csv beside this file: tests of a strip of VHB 4910 that nobody made.

The strip is an incompressible element with the published constants below. Its branch equations are integrated by the
classical Runge-Kutta method in small steps, which shares nothing with softkin's own integration; noise is added to what
answered. Needs Python 3 alone, and writes the same bytes every time.

    python3 examples/acrylic_strip/make_tests.py [FOLDER]
"""

from __future__ import annotations

import random
import sys
from pathlib import Path

MODULUS_KPA = 15.36  # relaxed
JM = 3 * (5.85**2 - 1)  # from the limit stretch 5.85
BRANCHES = ((26.06, 0.61), (26.53, 6.56), (10.83, 61.25))  # modulus [kPa], time [s]
NOISE_KPA = 0.4
NOISE_STRETCH = 0.003
STEP_S = 0.02


def stress_kpa(stretch: float, viscous: list[float]) -> float:
    """Nominal; viscous: the branches' viscous stretches."""
    limited = 1 / (1 - (stretch**2 + 2 / stretch - 3) / JM)
    law = MODULUS_KPA * limited * (stretch - 1 / stretch**2)
    return law + sum(g * (stretch / a**2 - a / stretch**2) for (g, _), a in zip(BRANCHES, viscous))


def flowed(viscous: list[float], begin: float, end: float, seconds: float) -> list[float]:
    """The viscous stretches after one step in which the stretch changes evenly."""

    def rate(a: float, stretch: float, time: float) -> float:
        return (stretch**2 / a - a**2 / stretch) / (3 * time)

    after = []
    middle = (begin + end) / 2
    for a, (_, time) in zip(viscous, BRANCHES):
        k1 = rate(a, begin, time)
        k2 = rate(a + seconds / 2 * k1, middle, time)
        k3 = rate(a + seconds / 2 * k2, middle, time)
        k4 = rate(a + seconds * k3, end, time)
        after.append(a + seconds / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return after


def bearing(stress: float, viscous: list[float]) -> float:
    """The stretch that bears a stress, by bisection."""
    low, high = 0.5, 5.8
    for _ in range(50):
        middle = (low + high) / 2
        if stress_kpa(middle, viscous) < stress:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def cycles(folder: Path) -> None:
    """Up to a stretch of 4.5, back to 2.2, where the strip is still taut, and once more, at three rates."""
    noise = random.Random(1)
    lines = [
        "# made up by make_tests.py: VHB 4910 as published, with noise of 0.4 kPa; stretched at 0.01, 0.05 and 0.5 1/s",
        "run,t_s,stretch,stress_kpa",
    ]
    turns, rows = (1.0, 4.5, 2.2, 4.5, 2.2), 30
    for run, rate in enumerate((0.01, 0.05, 0.5), 1):
        viscous = [1.0] * len(BRANCHES)
        now = 0.0
        lines.append(f"{run},0,1,{noise.gauss(0, NOISE_KPA):.2f}")
        for start, end in zip(turns, turns[1:]):
            seconds = abs(end - start) / rate / rows
            steps = max(4, round(seconds / STEP_S))
            for row in range(rows):
                begin, after = (start + (end - start) * (row + i) / rows for i in (0, 1))
                places = [begin + (after - begin) * i / steps for i in range(steps + 1)]
                for one, next_one in zip(places, places[1:]):
                    viscous = flowed(viscous, one, next_one, seconds / steps)
                now += seconds
                measured = stress_kpa(after, viscous) + noise.gauss(0, NOISE_KPA)
                lines.append(f"{run},{now:.6g},{after:.6g},{measured:.2f}")
    (folder / "cycles.csv").write_text("\n".join(lines) + "\n")


def creep(folder: Path) -> None:
    """A load of 40 kPa that is put on at once, and held for ten minutes."""
    noise = random.Random(2)
    lines = [
        "# made up by make_tests.py: VHB 4910 as published, with noise of 0.003 in stretch; 40 kPa put on at once",
        "t_s,stress_kpa,stretch",
    ]
    load, last, rows = 40.0, 600.0, 60
    viscous = [1.0] * len(BRANCHES)
    stretch = bearing(load, viscous)
    now = 0.0
    for row in range(rows + 1):
        then = 0.0 if row == 0 else 0.1 * (last / 0.1) ** ((row - 1) / (rows - 1))
        steps = max(1, round((then - now) / STEP_S))
        for _ in range(steps if then > now else 0):
            seconds = (then - now) / steps
            guess = bearing(load, flowed(viscous, stretch, stretch, seconds))
            viscous = flowed(viscous, stretch, guess, seconds)
            stretch = bearing(load, viscous)
        lines.append(f"{then:.6g},{load:g},{stretch + noise.gauss(0, NOISE_STRETCH):.5f}")
        now = then
    (folder / "creep.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    cycles(target)
    creep(target)
