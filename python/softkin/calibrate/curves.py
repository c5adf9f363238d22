"""Curves of chambers and dielectric elastomers: docs/pressure.md, docs/voltage.md."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import _core
from .._arrays import Floats
from .._compiled import Compiled
from .._core import InvalidInput
from .._files import PathLike, listed, write
from ..table import Table
from .fits import Fit


@dataclass(frozen=True)
class Branch:
    """Of a curve: its points."""

    input: Floats
    """(k,) gauge pressure [kPa] or voltage [kV], ascending"""
    ratio: Floats
    """(k,) volume or area over that without input [-]"""
    spread: Floats
    """(k,) standard deviation of the ratio between repeated runs [-]; empty: not known"""


@dataclass(frozen=True)
class ModulusCheck:
    """Compares measured and predicted pressures, to check the moduli of the prediction."""

    factor: float
    """least squares: measured = factor * predicted; by it all moduli would have to be multiplied [-]"""
    misfit_before: float
    """rms of measured - predicted over the rms of the measured [-]"""
    misfit_after: float
    """the same with the factor [-]"""


@dataclass(frozen=True)
class Prediction:
    """Gauge pressures that the physical formulation needs for ratios of the curve, the other chambers open."""

    ratio: Floats
    """(k,) volume over that at rest [-]"""
    pressure_kPa: Floats
    """(k,) NaN: no equilibrium was found"""
    checks: dict[str, ModulusCheck]
    """by branch, 'loading' and 'unloading'"""

    @property
    def complete(self) -> bool:
        """Is there an equilibrium at every ratio?"""
        return bool(np.isfinite(self.pressure_kPa).all())


class Curve(Fit[_core.CurveCalibration]):
    """An actuator's ratio by gauge pressure [kPa] or voltage [kV]."""

    @property
    def loading(self) -> Branch:
        return Branch(*(np.array(values) for values in self._core.loading))

    @property
    def unloading(self) -> Branch | None:
        """None: no such rows."""
        branch = self._core.unloading
        return None if branch is None else Branch(*(np.array(values) for values in branch))

    @property
    def samples(self) -> Floats:
        """(s, 4) measured: input, ratio, 1 where it falls, number of the sweep; (0, 4) of a computed curve."""
        return np.array(self._core.samples, dtype=float).reshape(-1, 4)

    @property
    def rows(self) -> Table | None:
        """Of syringe tests every row with its volume ratio; None: of a dielectric elastomer."""
        return None if self._core.rows is None else Table(self._core.rows)

    @property
    def prediction(self) -> Prediction | None:
        """None: not requested."""
        prediction = self._core.prediction
        if prediction is None:
            return None
        ratios, pressures, checks = prediction
        known = [np.nan if pressure is None else pressure for pressure in pressures]
        by_branch = {branch: ModulusCheck(*check) for branch, check in checks.items()}
        return Prediction(np.array(ratios), np.array(known), by_branch)

    def ratio(self, input: float, *, unloading: bool = False) -> float:
        """Volume or area over that without input [-].

        input   gauge pressure [kPa] or voltage [kV]
        raises  InvalidInput outside the curve: nothing is extrapolated
        """
        return self._core.ratio(input, unloading)

    def save(self, path: PathLike) -> None:
        """For key 'curve' of a scene's actuator: a .yaml."""
        write(path, self._core.file)


def _volume(name: str, volume: float | str) -> float:
    return _core.volume_mm3(name, volume if isinstance(volume, str) else f"{float(volume)!r}mm3")


def pressure(
    tests: PathLike | Sequence[PathLike],
    *,
    syringe_volume: float | str,
    chamber_volume: float | str | None = None,
    tube_volume: float | str = 0,
    robot: Compiled | None = None,
    actuator: str | None = None,
    atmosphere_kPa: float = 100,
    scale: str | None = None,
    predict: bool = False,
    threads: int = 0,
) -> Curve:
    """Volume ratio of a chamber by its pressure, from syringe tests (Fang et al. 2020, Eq. (19)).

    tests            CSV: p_abs_kpa or p_gauge_kpa (p_kpa with scale), dv_sy_mm3 or dv_sy_ml; run, t_s
    syringe_volume   air in the syringe at the start: [mm^3], or a text: "60mL"
    chamber_volume   at rest; None: that of the robot's mesh
    tube_volume      air in tubes and sensor
    robot, actuator  whose chamber it is
    atmosphere_kPa   absolute; 100 as in the paper
    scale            of column p_kpa: 'absolute' or 'gauge'
    predict          with robot: the pressures of the physical formulation beside the measured ones, and the factor of
                     Young's modulus between them
    threads          of predict's solves; 0: as many as the machine has
    """
    if scale not in (None, "absolute", "gauge"):
        raise InvalidInput(f"scale must be 'absolute' or 'gauge', not {scale!r}")
    if robot is None:
        for name, wants in (("predict", predict), ("actuator", actuator is not None)):
            if wants:
                raise InvalidInput(f"{name} needs robot=, whose chamber it is")
        if chamber_volume is None:
            raise InvalidInput("chamber_volume at rest is not known: give it, or robot=, whose mesh has it")
    given = _core.SyringeTests()
    given.files, given.scale, given.actuator = listed(tests), scale or "", actuator or ""
    if robot is not None:
        given.robot = robot._core
    if chamber_volume is not None:
        given.chamber_mm3 = _volume("chamber_volume", chamber_volume)
    given.tube_mm3 = 0.0 if tube_volume == 0 else _volume("tube_volume", tube_volume)
    given.syringe_mm3 = _volume("syringe_volume", syringe_volume)
    given.atmosphere_kPa, given.predict, given.threads = atmosphere_kPa, predict, threads
    return Curve(_core.calibrate_pressure(given))


def dea(
    tests: PathLike | Sequence[PathLike] = (),
    *,
    law: str | None = None,
    loading: str | None = None,
    shear_modulus_MPa: float | None = None,
    permittivity: float | None = None,
    thickness_mm: float | None = None,
    prestretch: float | None = None,
    prestretch_across: float | None = None,
    stretch_limit: float | None = None,
    breakdown_kV_mm: float | None = None,
) -> Curve:
    """Area ratio of a dielectric elastomer by its voltage, measured or computed.

    tests            CSV: voltage_kv or voltage_v; area_ratio or stretch; run, t_s
    law                in place of tests: 'neo-hookean' or 'gent', from the equations of state
    loading            constant forces on its edges: 'equal-biaxial' (equal in both directions, default),
                       'uniaxial' (one alone), 'constrained' (one; stiff fibres keep the stretch across)
    permittivity       relative to vacuum
    thickness_mm       before any stretch [mm]
    prestretch         length along the force without voltage over that without forces [-]
    prestretch_across  constrained: the stretch that the fibres keep [-]
    stretch_limit      gent: J_lim
    breakdown_kV_mm    true field at which the curve ends at the latest
    """
    files = listed(tests)
    if bool(files) == (law is not None):
        raise InvalidInput("give either tests or law")
    if law not in (None, "neo-hookean", "gent"):
        raise InvalidInput(f"law must be 'neo-hookean' or 'gent', not {law!r}")
    if loading not in (None, "equal-biaxial", "uniaxial", "constrained"):
        raise InvalidInput(f"loading must be 'equal-biaxial', 'uniaxial' or 'constrained', not {loading!r}")
    if prestretch_across is not None and loading != "constrained":
        raise InvalidInput("prestretch_across is for loading='constrained'")
    properties = (
        shear_modulus_MPa,
        permittivity,
        thickness_mm,
        prestretch,
        prestretch_across,
        stretch_limit,
        breakdown_kV_mm,
    )
    return Curve(_core.calibrate_dea(files, law or "", loading or "", *properties))
