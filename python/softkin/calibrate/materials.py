"""Laws, moduli and viscosity from specimens: docs/calibration.md."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence

from .. import _core
from .._core import InvalidInput
from .._files import PathLike, listed, optional, write
from .._warning import warn
from ..table import Table
from .fits import Fit


class Calibration(Fit[_core.Calibration]):
    """Materials, and how they were found."""

    @property
    def failure(self) -> str:
        """Why no material was found; '' where it was."""
        return self._core.failure

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
            raise InvalidInput(f"there is nothing to save: {self.failure}")
        write(path, self.materials)

    def save_plot(self, path: PathLike) -> None:
        """Measured and fitted: an .svg."""
        if self.failure:
            raise InvalidInput(f"there is nothing to plot: {self.failure}")
        super().save_plot(path)


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
    progress             called now and then with the completed fraction
    """
    if formulation not in (None, "physical", "target-shape"):
        raise InvalidInput(f"formulation must be 'physical' or 'target-shape', not {formulation!r}")
    if grip not in ("clamped", "sliding"):
        raise InvalidInput(f"grip must be 'clamped' or 'sliding', not {grip!r}")
    if law not in ("neo-hookean", "corotational", "st-venant-kirchhoff"):
        raise InvalidInput(f"law must take E and nu: neo-hookean, corotational or st-venant-kirchhoff, not {law!r}")
    for name, value in (("width_mm", width_mm), ("height_mm", height_mm)):
        if not value > 0:
            raise InvalidInput(f"{name} must be greater than 0 mm, not {value}")
    if not -1 < poisson_ratio < 0.5:
        raise InvalidInput(f"poisson_ratio must be greater than -1 and less than 0.5, not {poisson_ratio}")
    if not 0 < stiffer_shape_ratio <= 1:
        raise InvalidInput(f"stiffer_shape_ratio must be greater than 0 and at most 1, not {stiffer_shape_ratio}")
    given = _core.Specimens()
    given.file = os.fspath(specimens)
    given.twist_file = optional(twist)
    given.physical, given.target_shape = formulation != "target-shape", formulation != "physical"
    given.width_mm, given.height_mm, given.grip, given.law = width_mm, height_mm, grip, law
    given.poisson_ratio, given.stiffer_shape_ratio = poisson_ratio, stiffer_shape_ratio
    given.cells, given.threads, given.modulus_b_MPa = cells, threads, modulus_b_MPa
    given.tried, given.regions = list(tried), list(regions)
    given.journal = optional(store)
    core = _core.calibrate_specimens(given, progress)
    if core.doubt:
        warn(core.doubt)
    return Calibration(core)


_TENSILE_LAWS = ("linear", "neo-hookean", "mooney-rivlin", "yeoh", "gent", "ogden-1", "ogden-2", "ogden-3", "ogden")
_BRANCHES = ("envelope", "first", "last")
_ZEROS = ("file", "first", "toe")


def _layout(
    columns: tuple[str | None, str | None],
    units: tuple[str | None, str | None],
    true_measures: bool,
    length_mm: float | None,
    area_mm2: float | None,
    branch: str,
    zero: str,
) -> _core.TensileLayout | None:
    """How the file is read; None: as its header states."""
    if branch not in _BRANCHES:
        raise InvalidInput(f"branch must be one of {', '.join(_BRANCHES)}, not {branch!r}")
    if zero not in _ZEROS:
        raise InvalidInput(f"zero must be one of {', '.join(_ZEROS)}, not {zero!r}")
    for name, size in (("length_mm", length_mm), ("area_mm2", area_mm2)):
        if size is not None and not size > 0:
            raise InvalidInput(f"{name} must be greater than 0, not {size}")
    if not any((*columns, *units, length_mm, area_mm2)) and branch == "envelope" and zero == "file":
        return None
    layout = _core.TensileLayout()
    layout.strain_column, layout.stress_column = columns[0] or "", columns[1] or ""
    layout.strain_unit, layout.stress_unit = units[0] or "", units[1] or ""
    layout.true_strain = layout.true_stress = true_measures
    layout.length_mm, layout.area_mm2 = length_mm or 0.0, area_mm2 or 0.0
    layout.set_branch(_BRANCHES.index(branch))
    layout.set_zero(_ZEROS.index(zero))
    return layout


def tensile(
    test: PathLike,
    *,
    poisson_ratio: float = 0.45,
    linear_tolerance_percent: float = 5,
    up_to: float | None = None,
    law: str | None = None,
    region: str = "body",
    allow_unstable: bool = False,
    strain_column: str | None = None,
    stress_column: str | None = None,
    strain_unit: str | None = None,
    stress_unit: str | None = None,
    true_measures: bool = False,
    length_mm: float | None = None,
    area_mm2: float | None = None,
    branch: str = "envelope",
    zero: str = "file",
) -> Calibration:
    """An elastic law from the tensile test of one material.

    test                      CSV: strain or strain_percent, and stress_mpa, both nominal; or the file of a testing
                              machine
    linear_tolerance_percent  of the line's stress at its end: where a stress is farther off, the linear range ends
    up_to                     strain up to which laws are fitted [-]; None: all
    law                       of the scene: 'linear', 'neo-hookean', 'mooney-rivlin', 'yeoh', 'gent', 'ogden-1' to
                              'ogden-3', or 'ogden', the first of these that fits; None: the first law that fits
    region                    of the scene
    allow_unstable            mooney-rivlin and yeoh need not be stable up to the largest strain that is fitted
    strain_column, stress_column  of the file, where their names do not show it
    strain_unit, stress_unit  of these, such as '%' and 'kPa'
    true_measures             the columns that are named hold true strain and true stress
    length_mm, area_mm2       of the specimen at rest, for elongations and forces
    branch                    of a cyclic test: 'envelope', 'first' or 'last' loading
    zero                      where the strain is 0: as in the 'file', at the 'first' row, or at the 'toe' of the curve
    """
    if law is not None and law not in _TENSILE_LAWS:
        raise InvalidInput(f"law must be {', '.join(_TENSILE_LAWS)}, not {law!r}")
    layout = _layout(
        (strain_column, stress_column), (strain_unit, stress_unit), true_measures, length_mm, area_mm2, branch, zero
    )
    core = _core.calibrate_tensile(
        os.fspath(test),
        poisson_ratio,
        linear_tolerance_percent,
        up_to or 0.0,
        law or "",
        region,
        not allow_unstable,
        layout,
    )
    return Calibration(core)


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
    task.tests, task.creep = listed(tests), listed(creep)
    if not task.tests and not task.creep:
        raise InvalidInput("give tests, creep or both")
    if law not in ("neo-hookean", "mooney-rivlin", "yeoh", "gent"):
        raise InvalidInput(f"law must be neo-hookean, mooney-rivlin, yeoh or gent, not {law!r}")
    if not 0 < poisson_ratio < 0.5:
        raise InvalidInput(f"poisson_ratio must be greater than 0 and less than 0.5, not {poisson_ratio}")
    for name, size in (("length_mm", length_mm), ("area_mm2", area_mm2)):
        if size is not None and not size > 0:
            raise InvalidInput(f"{name} must be greater than 0, not {size}")
    if branches is not None and not 0 <= branches <= 12:
        raise InvalidInput(f"branches must be from 0 to 12, not {branches}")
    task.law, task.constants, task.branches = law, dict(constants or {}), branches
    task.length_mm, task.area_mm2 = length_mm, area_mm2
    task.poisson_ratio, task.region = poisson_ratio, region
    return Calibration(_core.calibrate_relaxation(task))
