"""The study `limits`: locking of nearly incompressible elements, and the energy after a million steps."""

from __future__ import annotations

from collections.abc import Iterator

from validation.gates.closed_forms import EPS
from validation.gates.gate import Gate
from validation.studies.bands import OWN, cases
from validation.studies.declaration import Study

# Static displacement of linear over quadratic elements, less one: bands about the values of eight elements a side.
LOCKED = {0.3: (-0.012, -0.003), 0.49: (-0.15, -0.07), 0.4999: (-0.8, -0.7), 0.499999: (-0.92, -0.82)}


def name(poisson: float, degree: int) -> str:
    """Return the name of a case of the scene `locking`."""
    return f"locking[block.poisson={poisson!r},fem.degree={degree}]"


def gates() -> Iterator[Gate]:
    """Yield the gates on locking, on its cure and on the energy of long runs."""
    why = (
        "linear elements cannot bulge without changing volume: they lock as mu tends to 1/2; half the spread between "
        "meshes of 4 and 16 a side about the value of 8"
    )
    pair, metric = ("fem", "fem"), "displacement.static"
    for poisson, band in LOCKED.items():
        yield Gate(name(poisson, 1), pair, metric, *band, why, OWN, against=name(poisson, 2))
    why = (
        "quadratic elements, the cure, do not see the last 1e-4 of mu: the solution changes by the order of 1/2 - mu "
        "times its slope, 0.2 %"
    )
    yield Gate(name(0.499999, 2), pair, metric, -0.003, 0.0, why, OWN, against=name(0.4999, 2))
    why = "|lambda| = 1: the energy of each mode stays, apart from one rounding a step"
    for case in cases("long-run"):
        yield Gate(case.name, ("dda",), "energy.drift", 0.0, case.time.steps * EPS, why)


STUDY = Study(
    name="limits",
    title="Locking, and a million steps",
    purpose="What nearly incompressible material does to linear elements and not to quadratic ones, and whether the "
    "energy drifts over a million steps where the spectral radius is one.",
    scenes=("locking", "long-run"),
    measures=("history", "modes", "energy"),
    gates=lambda: tuple(gates()),
)
