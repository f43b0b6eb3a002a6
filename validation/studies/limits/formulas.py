"""The study `limits`: locking of nearly incompressible elements, and the energy after a million steps."""

from __future__ import annotations

from validation.scenes.scene import Scene
from validation.suite.bands import Band, cases
from validation.theory.spectra import EPS

COARSE = (0.3, 0.4999)  # Poisson's ratios at which quadratic elements are compared with a fine mesh
FINE = 32  # elements a side


def fine() -> list[Scene]:
    """Return cases of the scene `locking` with quadratic elements on a fine mesh."""
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
    """Return the scenes of locking, two of them on a fine mesh too, and the long run."""
    return "locking", *fine(), "long-run"
