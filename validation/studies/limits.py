"""The study `limits`: locking of nearly incompressible elements, and the energy after a million steps."""

from __future__ import annotations

from collections.abc import Iterator

from validation.gates.gate import Gate
from validation.scenes.scene import Scene
from validation.studies.bands import OWN, cases, gate
from validation.studies.declaration import Study
from validation.theory.spectra import EPS

# Static displacement of linear over quadratic elements, less one: bands about the values of eight elements a side.
LOCKED = {0.3: (-0.012, -0.003), 0.49: (-0.15, -0.07), 0.4999: (-0.8, -0.7), 0.499999: (-0.92, -0.82)}


# Quadratic elements, eight a side, against 32 a side, less one: they do not lock, but the corners of a held base keep
# them from the value of a fine mesh, the more the less the material changes its volume.
COARSE = {0.3: (-0.0012, -0.0007), 0.4999: (-0.036, -0.022)}
FINE = 32  # elements a side


def name(poisson: float, degree: int) -> str:
    """Return the name of a case of the scene `locking`."""
    return f"locking[block.poisson={poisson!r},fem.degree={degree}]"


def fine() -> list[Scene]:
    """Return cases of the scene `locking` with quadratic elements on a fine mesh."""
    cases_by_name = {case.name: case for case in cases("locking")}
    finer = []
    for poisson in COARSE:
        label = name(poisson, 2).replace("]", f",fem.elements={FINE}]")
        case = cases_by_name[name(poisson, 2)].with_values({"fem.elements": FINE})
        finer.append(case.model_copy(update={"name": label}))
    return finer


def gates() -> Iterator[Gate]:
    """Yield the gates on locking, on elements that do not lock and on the energy of long runs."""
    why = (
        "linear elements cannot bulge without changing volume: they lock as mu tends to 1/2; half the spread between "
        "meshes of 4 and 16 a side about the value of 8"
    )
    pair = ("fem", "fem")
    metric = "displacement.static"
    for poisson, band in LOCKED.items():
        yield gate(name(poisson, 1), pair, metric, band, why, OWN, against=name(poisson, 2))
    why = (
        "quadratic elements do not lock, but at eight a side are not converged: a quarter about the difference from 32 "
        "a side, whose own from 64 a side is a tenth of it"
    )
    for (poisson, band), scene in zip(COARSE.items(), fine(), strict=True):
        yield gate(name(poisson, 2), pair, metric, band, why, OWN, against=scene.name)
    why = (
        "quadratic elements do not see the last 1e-4 of mu: the solution changes by the order of 1/2 - mu "
        "times its slope, 0.2 %"
    )
    yield gate(name(0.499999, 2), pair, metric, (-0.003, 0.0), why, OWN, against=name(0.4999, 2))
    why = "|lambda| = 1: the energy of each mode stays, apart from one rounding a step"
    for case in cases("long-run"):
        yield gate(case, "dda", "energy.drift", (0.0, case.time.steps * EPS), why)


STUDY = Study(
    name="limits",
    title="Locking, and a million steps",
    purpose="What nearly incompressible material does to linear elements and not to quadratic ones, and whether the "
    "energy drifts over a million steps where the spectral radius is one.",
    scenes=("locking", *fine(), "long-run"),
    measures=("history", "modes", "energy"),
    gates=lambda: tuple(gates()),
)
