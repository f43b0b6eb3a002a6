"""The core study: the paper's scenes by DDA, finite elements and exact solutions, and the formulas of its gates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.engine.finished import DerivedRows
from validation.metrics.values import or_nan
from validation.runs.history import History
from validation.runs.row import Metrics, Row
from validation.scenes.scene import Scene
from validation.studies.core.damping import compared_cases as compared_cases
from validation.studies.core.damping import derived as damping_rows
from validation.studies.core.damping import ratio as ratio
from validation.studies.core.decisions import curves as curves
from validation.studies.core.decisions import derived as closed_rows
from validation.studies.core.decisions import first_peak as first_peak
from validation.studies.core.decisions import springs as springs
from validation.suite.bands import Band, Bands, about, convergence, near
from validation.theory import spectra, statics
from validation.theory.spectra import elements_per_front as elements_per_front


def static_displacement(case: Scene) -> Band:
    """Static equilibrium, to the conditioning of the system."""
    return near(statics.static_displacement(case), 1e4 * spectra.EPS)


def static_displacement_of_a_mesh(case: Scene) -> Band:
    """The same of elements, to the rounding of a sparse solution."""
    return near(statics.static_displacement(case), 1e-9)


def final_pressure(case: Scene) -> Band:
    """The load, about which damping has left a motion."""
    return near(case.load.pressure, 2 * spectra.remaining_motion(case) + 1e-9)


def frequency_of_the_block(case: Scene) -> Band:
    """First frequency of the block of one strain [rad/s]."""
    return near(spectra.dda_frequency(case), 1e-12)


def frequency_of_the_bar(case: Scene) -> Band:
    """First frequency of the bar [rad/s]."""
    return near(spectra.bar_frequency(case), 1e-12)


def frequency_error_of_the_mesh(case: Scene) -> Band:
    """Relative error of the first frequency of elements."""
    error = spectra.mesh_frequency_error(case)
    return 0.9 * error - 2e-11, 1.1 * error + 2e-11


def frequency_ratio(case: Scene) -> Band:
    """First frequency of the block over that of the bar, less one."""
    return near(spectra.dda_frequency(case) / spectra.bar_frequency(case) - 1, 1e-10)


def damping_of_the_block(case: Scene) -> Band | None:
    """Damping ratio of the first mode of the block."""
    return _damping(case, spectra.dda_frequency(case))


def damping_of_the_bar(case: Scene) -> Band | None:
    """Damping ratio of the first mode of the bar."""
    return _damping(case, spectra.bar_frequency(case))


def _damping(case: Scene, frequency: float) -> Band | None:
    """Damping ratio of one step at a frequency; a mode of real roots has none."""
    if abs(spectra.roots(case, frequency)[0].imag) < 1e-6:
        return None
    value = spectra.damping_ratio(case, frequency)
    return about(value, 1e-10 * abs(value) + 1e-12)


def damping_of_the_history(case: Scene) -> Band:
    """Damping ratio of the displacement of the block."""
    return about(spectra.damping_ratio(case, spectra.dda_frequency(case)), 1e-6)


def dispersion(case: Scene) -> Bands | None:
    """Mesh error of weakly damped waves, which is the elements' dispersion."""
    if case.time.alpha == 0.5 and case.time.step >= 1e-3:
        return None  # the figure's constant acceleration: damped within the window, judged with Figures 3 to 6
    errors = spectra.mesh_error(case)
    return {f"{quantity}.l2": (0.75 * error, 1.1 * error) for quantity, error in errors.items()}


def distance_from_the_finest_mesh(case: Scene) -> Bands:
    """Differences of meshes of 4 and 8 elements a side from one of 16, this suite's own, within half of each."""
    displacement, pressure = {4: (1.3e-4, 2.4e-5), 8: (2.2e-5, 4.4e-6)}[case.fem.per_side]
    return {
        "displacement.l2": (displacement / 1.5, displacement * 1.5),
        "pressure.l2": (pressure / 1.5, pressure * 1.5),
    }


def same_recursion(case: Scene) -> Band:
    """Distance of the printed recursion from the robust form."""
    return 0.0, spectra.rounding(case)


def apart(case: Scene, dda: Row, fem: Row) -> Metrics:
    """Return how far DDA's displacement at rest is from that of the elements, relative to it."""
    first, second = (or_nan(row.metrics.get("displacement.static")) for row in (dda, fem))
    return {"displacement": abs(first / second - 1)}


def drift(levels: Sequence[tuple[Scene, Row]]) -> Metrics:
    """Return by how much elements on corner springs settle more with every halving of the mesh [m]."""
    settled = [or_nan(fem.metrics.get("displacement.static")) for _, fem in levels]
    return {"halving": np.polyfit(np.log2([case.fem.per_side for case, _ in levels]), settled, 1)[0]}


def order(runs: Sequence[tuple[Scene, History, History]]) -> Metrics:
    """Return the power of the elements a side with which the error against the bar falls."""
    return {"power": convergence(runs, "fem.per_side")["displacement"]}


def further_rows() -> DerivedRows:
    """Return the rows of damping, and of the first pages."""
    return (*damping_rows(), *closed_rows())
