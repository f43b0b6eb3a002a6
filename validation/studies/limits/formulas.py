"""The study `limits`: locking of nearly incompressible elements, and the energy after a million steps."""

from __future__ import annotations

from collections.abc import Callable

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.metrics.values import or_nan
from validation.runs.row import Metrics
from validation.scenes.scene import Scene
from validation.suite.bands import Band, cases
from validation.theory.spectra import EPS

COARSE = (0.3, 0.4999)  # Poisson's ratios at which quadratic elements are compared with a fine mesh
STATIC = "displacement.static"
FINE = 32  # elements a side


def fine() -> list[Scene]:
    """Return cases of `locking` with quadratic elements on a fine mesh."""
    cases_by_name = {case.name: case for case in cases("locking")}
    finer = []
    for poisson in COARSE:
        name = f"locking[block.poisson={poisson!r},fem.degree=2]"
        case = cases_by_name[name].with_values({"fem.elements": FINE})
        finer.append(case.model_copy(update={"name": name.replace("]", f",fem.elements={FINE}]")}))
    return finer


def a_rounding_a_step(case: Scene) -> Band:
    """Return what rounding may change of the energy."""
    return 0.0, case.time.steps * EPS


def scenes() -> tuple[str | Scene, ...]:
    """Return the scenes of locking, two on a fine mesh too, and the long run."""
    return "locking", *fine(), "long-run"


def derived() -> DerivedRows:
    """Return displacements at rest over each other: linear over quadratic elements, coarse over fine ones."""
    cases_by_data = {(case.block.poisson, case.fem.degree): case for case in cases("locking")}
    rows = []
    for (poisson, degree), case in cases_by_data.items():
        if degree == 1:
            quadratic = cases_by_data[poisson, 2]
            rows.append(_over("locked", "linear over quadratic", case, quadratic, lambda ratio: ratio))
    for case in fine():
        coarse = cases_by_data[case.block.poisson, 2]
        rows.append(_over("coarse", "stiffer", coarse, case, lambda ratio: 1 - ratio))
    return tuple(rows)


def _over(name: str, metric: str, case: Scene, other: Scene, of_ratio: Callable[[float], float]) -> Derived:
    """Return the row of a function of the displacement at rest of a case over that of another."""

    def compute(finished: Finished) -> Metrics:
        first, second = (or_nan(finished.rows[one.name, "fem"].metrics[STATIC]) for one in (case, other))
        return {metric: of_ratio(first / second)}

    return Derived(case.name, name, ((case.name, "fem"), (other.name, "fem")), compute, (STATIC,))
