"""Parameters of the model from measurements: docs/calibration.md, docs/poses.md, docs/pressure.md, docs/voltage.md."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from . import _core
from ._arrays import Floats
from .errors import SoftkinWarning
from .robot import Robot, _yaml_text, load
from .table import Table

__all__ = [
    "Branch",
    "Calibration",
    "Curve",
    "ModulusCheck",
    "Prediction",
    "RobotFit",
    "dea",
    "material",
    "pressure",
    "relaxation",
    "robot",
    "tensile",
]

PathLike = str | os.PathLike[str]


class Calibration:
    """Materials, and how they were found."""

    def __init__(self, core: _core.Calibration) -> None:
        self._core = core

    @property
    def failure(self) -> str:
        """Why no material was found; '' where it was."""
        return self._core.failure

    @property
    def report(self) -> dict[str, Any]:
        """What `softkin calibrate material --json` or `relaxation --json` prints."""
        report: dict[str, Any] = json.loads(self._core.json)
        return report

    @property
    def materials(self) -> str:
        """The materials of a scene, YAML; '' where none was found."""
        return self._core.fragment

    @property
    def residuals(self) -> Table:
        """Measured, fitted and their difference."""
        return Table(self._core.residuals)

    def save(self, path: PathLike) -> None:
        """The materials, to paste into a scene: a .yaml."""
        if self.failure:
            raise ValueError(f"there is nothing to save: {self.failure}")
        Path(path).write_text(self.materials)

    def save_plot(self, path: PathLike) -> None:
        """Measured and fitted: an .svg."""
        if self.failure:
            raise ValueError(f"there is nothing to plot: {self.failure}")
        self._core.save_plot(os.fspath(path))

    def __repr__(self) -> str:
        return self._core.text.rstrip("\n")


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
    """What measured pressures say of the moduli behind predicted ones."""

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


class Curve:
    """An actuator's ratio by gauge pressure [kPa] or voltage [kV]."""

    def __init__(self, core: _core.CurveCalibration) -> None:
        self._core = core

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
        """None: not asked for."""
        told = self._core.prediction
        if told is None:
            return None
        ratios, pressures, checks = told
        known = [np.nan if pressure is None else pressure for pressure in pressures]
        by_branch = {branch: ModulusCheck(*check) for branch, check in checks.items()}
        return Prediction(np.array(ratios), np.array(known), by_branch)

    def ratio(self, input: float, *, unloading: bool = False) -> float:
        """Volume or area over that without input [-].

        input   gauge pressure [kPa] or voltage [kV]
        raises  InvalidInput outside the curve: nothing is extrapolated
        """
        return self._core.ratio(input, unloading)

    @property
    def report(self) -> dict[str, Any]:
        """What `softkin calibrate pressure --json` prints."""
        report: dict[str, Any] = json.loads(self._core.json)
        return report

    def save(self, path: PathLike) -> None:
        """For key 'curve' of a scene's actuator: a .yaml."""
        Path(path).write_text(self._core.file)

    def save_plot(self, path: PathLike) -> None:
        """Rows and branches: an .svg."""
        self._core.save_plot(os.fspath(path))

    def __repr__(self) -> str:
        return self._core.text.rstrip("\n")


def material(
    specimens: PathLike,
    *,
    twist: PathLike | None = None,
    formulation: str | None = None,
    width_mm: float = 20,
    height_mm: float = 10,
    grip: str = "clamped",
    law: str = "neo-hookean",
    poisson_ratio: float = 0.45,
    stiffer_shape_ratio: float = 1,
    cells: int = 0,
    modulus_b_MPa: float | None = None,
    tried: Sequence[float] = (),
    regions: tuple[str, str] = ("A", "B"),
    store: PathLike | None = None,
    threads: int = 0,
    progress: Callable[[float], object] | None = None,
) -> Calibration:
    """R_omega and Young's moduli from stretched bars of two materials, by simulated tests (Fang et al. 2020).

    specimens            CSV: l_mm, l1_mm, dl_mm, dl1_mm; force_n and area_mm2 where measured
    twist                CSV to validate: l_mm, l1_mm, twist_deg; interface_deg where measured
    formulation          'physical': E_A / E_B; 'target-shape': R_omega; None: both
    width_mm, height_mm  of the specimens' cross-section [mm]
    grip                 'clamped' or 'sliding': the ends are free to contract
    law                  physical: 'neo-hookean', 'corotational' or 'st-venant-kirchhoff'
    stiffer_shape_ratio  R_omega of the stiffer material, 0 < R <= 1
    cells                of the simulated mesh across the height; 0: 3 physical, 4 target-shape
    modulus_b_MPa        Young's modulus of B, where no force was measured
    tried                R_omega A / R_omega B to look at too
    regions              names of A and B in the scene
    store                file of the simulated tests: a calibration that was stopped goes on where it was; it is removed
                         at the end
    progress             called with the share that is done, now and then
    """
    if formulation not in (None, "physical", "target-shape"):
        raise ValueError(f"formulation must be 'physical' or 'target-shape', not {formulation!r}")
    if grip not in ("clamped", "sliding"):
        raise ValueError(f"grip must be 'clamped' or 'sliding', not {grip!r}")
    if law not in ("neo-hookean", "corotational", "st-venant-kirchhoff"):
        raise ValueError(f"law must take E and nu: neo-hookean, corotational or st-venant-kirchhoff, not {law!r}")
    for name, value in (("width_mm", width_mm), ("height_mm", height_mm)):
        if not value > 0:
            raise ValueError(f"{name} must be greater than 0 mm, not {value}")
    if not -1 < poisson_ratio < 0.5:
        raise ValueError(f"poisson_ratio must be greater than -1 and less than 0.5, not {poisson_ratio}")
    if not 0 < stiffer_shape_ratio <= 1:
        raise ValueError(f"stiffer_shape_ratio must be greater than 0 and at most 1, not {stiffer_shape_ratio}")
    given = _core.Specimens()
    given.file = os.fspath(specimens)
    given.twist_file = "" if twist is None else os.fspath(twist)
    given.physical, given.target_shape = formulation != "target-shape", formulation != "physical"
    given.width_mm, given.height_mm, given.grip, given.law = width_mm, height_mm, grip, law
    given.poisson_ratio, given.stiffer_shape_ratio = poisson_ratio, stiffer_shape_ratio
    given.cells, given.threads, given.modulus_b_MPa = cells, threads, modulus_b_MPa
    given.tried, given.regions = list(tried), list(regions)
    given.journal = "" if store is None else os.fspath(store)
    core = _core.calibrate_specimens(given, progress)
    if core.doubt:
        warnings.warn(core.doubt, SoftkinWarning, stacklevel=2)
    return Calibration(core)


def tensile(
    test: PathLike,
    *,
    poisson_ratio: float = 0.45,
    linear_tolerance_percent: float = 5,
    up_to: float | None = None,
    law: str | None = None,
    region: str = "body",
) -> Calibration:
    """An elastic law from the tensile test of one material.

    test                      CSV: strain or strain_percent, and stress_mpa; both nominal
    linear_tolerance_percent  of the line's stress at its end: where a stress is farther off, the linear range ends
    up_to                     strain up to which laws are fitted [-]; None: all
    law                       of the scene: 'linear', 'neo-hookean', 'mooney-rivlin' or 'yeoh'; None: the one that fits
    region                    of the scene
    """
    if law not in (None, "linear", "neo-hookean", "mooney-rivlin", "yeoh"):
        raise ValueError(f"law must be linear, neo-hookean, mooney-rivlin or yeoh, not {law!r}")
    core = _core.calibrate_tensile(
        os.fspath(test), poisson_ratio, linear_tolerance_percent, up_to or 0.0, law or "", region
    )
    return Calibration(core)


def _files(tests: PathLike | Sequence[PathLike]) -> list[str]:
    if isinstance(tests, (str, os.PathLike)):
        tests = [tests]
    return [os.fspath(test) for test in tests]


def relaxation(
    tests: PathLike | Sequence[PathLike] = (),
    *,
    creep: PathLike | Sequence[PathLike] = (),
    law: str = "neo-hookean",
    constants: Mapping[str, float] | None = None,
    branches: int | None = None,
    length_mm: float | None = None,
    area_mm2: float | None = None,
    poisson_ratio: float = 0.49,
    region: str = "body",
) -> Calibration:
    """Viscosity from relaxation, creep and cycles of a strip: a law and Maxwell branches.

    tests          CSV, the stretch imposed: t_s; strain, strain_percent, stretch or length_mm; stress_mpa, stress_kpa
                   or force_n; run
    creep          CSV, the stress imposed: the same columns
    law            of what does not relax: 'neo-hookean', 'mooney-rivlin', 'yeoh' or 'gent'
    constants      of the law, by name, not to be fitted [MPa; jm: -]
    branches       so many; None: as few as the tests carry
    length_mm      of the specimen at rest, for length_mm
    area_mm2       of its cross-section at rest, for force_n
    poisson_ratio  of the scene
    region         of the scene
    """
    task = _core.RelaxationTask()
    task.tests, task.creep = _files(tests), _files(creep)
    if not task.tests and not task.creep:
        raise ValueError("give tests, creep or both")
    if law not in ("neo-hookean", "mooney-rivlin", "yeoh", "gent"):
        raise ValueError(f"law must be neo-hookean, mooney-rivlin, yeoh or gent, not {law!r}")
    if not 0 < poisson_ratio < 0.5:
        raise ValueError(f"poisson_ratio must be greater than 0 and less than 0.5, not {poisson_ratio}")
    for name, size in (("length_mm", length_mm), ("area_mm2", area_mm2)):
        if size is not None and not size > 0:
            raise ValueError(f"{name} must be greater than 0, not {size}")
    if branches is not None and not 0 <= branches <= 12:
        raise ValueError(f"branches must be from 0 to 12, not {branches}")
    task.law, task.constants, task.branches = law, dict(constants or {}), branches
    task.length_mm, task.area_mm2 = length_mm, area_mm2
    task.poisson_ratio, task.region = poisson_ratio, region
    return Calibration(_core.calibrate_relaxation(task))


def _volume(name: str, volume: float | str) -> float:
    return _core.volume_mm3(name, volume if isinstance(volume, str) else f"{float(volume)!r}mm3")


def pressure(
    tests: PathLike | Sequence[PathLike],
    *,
    syringe_volume: float | str,
    chamber_volume: float | str | None = None,
    tube_volume: float | str = 0,
    robot: Robot | None = None,
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
        raise ValueError(f"scale must be 'absolute' or 'gauge', not {scale!r}")
    if robot is None:
        for name, wants in (("predict", predict), ("actuator", actuator is not None)):
            if wants:
                raise ValueError(f"{name} needs robot=, whose chamber it is")
        if chamber_volume is None:
            raise ValueError("chamber_volume at rest is not known: give it, or robot=, whose mesh has it")
    given = _core.SyringeTests()
    given.files, given.scale, given.actuator = _files(tests), scale or "", actuator or ""
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
    loading            what pulls at its edges by constant forces: 'equal-biaxial' (both directions alike, default),
                       'uniaxial' (one alone), 'constrained' (one; stiff fibres keep the stretch across)
    permittivity       relative to vacuum
    thickness_mm       before any stretch [mm]
    prestretch         length along the force without voltage over that without forces [-]
    prestretch_across  constrained: the stretch that the fibres keep [-]
    stretch_limit      gent: J_lim
    breakdown_kV_mm    true field at which the curve ends at the latest
    """
    files = _files(tests)
    if bool(files) == (law is not None):
        raise ValueError("give either tests or law")
    if law not in (None, "neo-hookean", "gent"):
        raise ValueError(f"law must be 'neo-hookean' or 'gent', not {law!r}")
    if loading not in (None, "equal-biaxial", "uniaxial", "constrained"):
        raise ValueError(f"loading must be 'equal-biaxial', 'uniaxial' or 'constrained', not {loading!r}")
    if prestretch_across is not None and loading != "constrained":
        raise ValueError("prestretch_across is for loading='constrained'")
    properties = (shear_modulus_MPa, permittivity, thickness_mm, prestretch, prestretch_across, stretch_limit, breakdown_kV_mm)
    return Curve(_core.calibrate_dea(files, law or "", loading or "", *properties))


class RobotFit:
    """Numbers of a robot, and how they were found from its poses."""

    def __init__(self, core: _core.RobotCalibration, scene: str, changes: Mapping[str, object]) -> None:
        self._core = core
        self._scene = scene
        self._changes = dict(changes)

    @property
    def report(self) -> dict[str, Any]:
        """What `softkin calibrate robot --json` prints."""
        report: dict[str, Any] = json.loads(self._core.json)
        return report

    @property
    def converged(self) -> bool:
        """Was a minimum found, with an equilibrium in every pose?"""
        return bool(self.report["status"] == "converged")

    @property
    def values(self) -> dict[str, float]:
        """By name, in the scene's units; of base and camera [mm, degrees]."""
        return {number["name"]: number["value"] for number in self.report["numbers"]}

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviation by name; NaN: the poses do not tell it."""
        known = {number["name"]: number["deviation"] for number in self.report["numbers"]}
        return {name: np.nan if deviation is None else deviation for name, deviation in known.items()}

    @property
    def readings(self) -> Table:
        """Measured, computed and their difference, a row each."""
        return Table(self._core.readings)

    def robot(self) -> Robot:
        """The scene's robot with the fitted numbers; base and camera are of the measurements, not of it."""
        own = {name: value for name, value in self.values.items() if name.split(".")[0] not in ("base", "camera")}
        return load(self._scene, changes={**self._changes, **own})

    def save_plot(self, path: PathLike) -> None:
        """Measured and computed markers: an .svg."""
        self._core.save_plot(os.fspath(path))

    def __repr__(self) -> str:
        return self._core.text.rstrip("\n")


def _fitted_number(name: str, value: float | Sequence[float] | str | None) -> str:
    if value is None:
        return name
    if isinstance(value, str):
        return f"{name}={value}"
    values = value if isinstance(value, Sequence) else [value]
    return f"{name}=" + ",".join(repr(float(each)) for each in values)


def robot(
    scene: PathLike,
    poses: PathLike,
    *,
    fit: Mapping[str, float | Sequence[float] | str | None] | Sequence[str] = (),
    changes: Mapping[str, object] | None = None,
    loss: str = "squares",
    deviation_mm: float | None = None,
    deviation_kPa: float | None = None,
    deviation_N: float | None = None,
    deviation_length_mm: float | None = None,
    deviation_volume_mm3: float | None = None,
    deviation_force_N: float | None = None,
    keep: int = 0,
    ordered: bool = False,
    threads: int = 0,
    progress: Callable[[int, float], object] | None = None,
) -> RobotFit:
    """Numbers of a robot from its measured poses, by Levenberg's and Marquardt's method through equilibria.

    scene      YAML, physical formulation
    poses      CSV: commands as in a path, then tip_x_mm, ... of markers, air_pressure_kPa, tendon_tension_N, or
               air_volume_mm3, tendon_length_mm where loads are commanded, base_force_x_N, ... of supports on the robot;
               empty cells were not read
    fit        by path: a start, (start, low, high), "mean+-deviation" (known before) or None, the scene's; or texts as
               of --fit; base.x, base.rx, ...: where the robot stands in the measuring frame [mm, degrees]; camera.x, ...:
               the same, gravity turns along. Empty: the poses are foretold as the scene is
    changes    of the scene, by path
    loss       'squares', 'huber' or 'cauchy', which wrong readings hardly move
    deviation  of a coordinate [mm], pressure [kPa], tension [N], length [mm], volume [mm^3], force [N] as read; None:
               by what is left
    keep       poses that are not fitted to but foretold, spread evenly
    ordered    where something rubs: each pose goes on from the one before, the first from rest; else each from rest
    threads    poses side by side; 0: as many as the machine has
    progress   called with the iteration and the root mean square of the markers [mm], now and then
    raises     InvalidInput naming the file, line and column, or the number
    """
    if loss not in ("squares", "huber", "cauchy"):
        raise ValueError(f"loss must be 'squares', 'huber' or 'cauchy', not {loss!r}")
    deviations = {
        "deviation_mm": deviation_mm,
        "deviation_kPa": deviation_kPa,
        "deviation_N": deviation_N,
        "deviation_length_mm": deviation_length_mm,
        "deviation_volume_mm3": deviation_volume_mm3,
        "deviation_force_N": deviation_force_N,
    }
    for name, given in deviations.items():
        if given is not None and not given > 0:
            raise ValueError(f"{name} must be greater than 0, not {given}")
    if keep < 0:
        raise ValueError(f"keep must be at least 0, not {keep}")
    task = _core.PosesTask()
    task.scene, task.poses, task.loss = os.fspath(scene), os.fspath(poses), loss
    if isinstance(fit, Mapping):
        task.numbers = [_fitted_number(name, value) for name, value in fit.items()]
    else:
        task.numbers = list(fit)
    task.changes = [f"{path}={_yaml_text(value)}" for path, value in (changes or {}).items()]
    task.deviations = [given or 0 for given in deviations.values()]
    task.keep, task.threads, task.ordered = keep, threads, ordered
    return RobotFit(_core.calibrate_robot(task, progress), task.scene, changes or {})
