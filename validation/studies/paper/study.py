"""The study `paper`: every figure redrawn, every statement tested."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from dda.scheme.spectral import spectral_radius
from validation.engine.finished import Derived
from validation.gates.gate import Gate
from validation.studies.bands import about
from validation.studies.declaration import Study
from validation.studies.paper.claims import REGISTER
from validation.studies.paper.friction import ON_SLOPES
from validation.studies.paper.open_close import OPEN_CLOSE
from validation.studies.paper.register import CLAIMS as STATEMENTS
from validation.studies.paper.slips import SLIPS
from validation.studies.paper.viscous import VISCOUS

CHAPTER_FIELDS = ("id", "place", "says", "why", "condition")  # of a claim
CLAIMS = (*STATEMENTS, *OPEN_CLOSE, *VISCOUS, *ON_SLOPES, *SLIPS)
FIGURES = ("figures-3-4", "figures-5-6", "figure-7", "figure-8", "figure-9")
SCHEMES = {  # of Figure 1: name -> alpha, delta
    "average acceleration (1/4, 1/2)": (0.25, 0.5),
    "constant acceleration (1/2, 1)": (0.5, 1.0),
    "(9/16, 1)": (0.5625, 1.0),
    "(0.3025, 0.6)": (0.3025, 0.6),
}
# Numbers of an independent computation outside this project: half a unit of their last digit is the band.
NUMBERS: tuple[tuple[str, str, float, float], ...] = (
    ("C2", "displacement, steps", 5, 0),
    ("C2", "contact force, steps", 7, 0),
    ("C2", "force later by at least, steps (0.2 to 8 %)", 0, 0),
    ("C3", "displacement, steps", 44, 0),
    ("C3", "contact force, steps", 45, 0),
    ("C4", "displacement, steps", 22, 0),
    ("C4", "contact force, steps", 25, 0),
    ("C6", "greatest xi", 0.373, 5e-4),
    ("C6", "at w dt", 3.27, 5e-3),
    ("C7", "|lambda| at dt = 0.01, p = 1E", 0.380, 5e-4),
    ("C7", "|lambda| at dt = 0.01, p = 10E", 0.665, 5e-4),
    ("C7", "|lambda| at dt = 0.01, p = 100E", 0.699, 5e-4),
    ("C8", "first peak at 1E", 2.03, 5e-3),
    ("C8", "last peak at 1E", 1.97, 5e-3),
    ("C8", "first peak at 10E", 2.01, 5e-3),
    ("C8", "last peak at 10E", 1.90, 5e-3),
    ("C8", "first peak at 100E", 2.00, 5e-3),
    ("C8", "last peak at 100E", 1.88, 5e-3),
    ("C8", "xi at 1E", 0.0009, 5e-5),
    ("C8", "xi at 10E", 0.0012, 5e-5),
    ("C8", "xi at 100E", 0.0013, 5e-5),
    ("C12", "xi at dt = 0.002", 0.0152, 5e-5),
    ("C12", "xi at dt = 0.001", 0.0296, 5e-5),
    ("C12", "xi at dt = 0.0001", 0.293, 5e-4),
    ("C13", "discount 4", 0.10, 1e-9),
    ("S32", "static displacement, mm", -9.850, 5e-4),
)


def gates() -> tuple[Gate, ...]:
    """Return the gates on the verdicts of all claims, and on the numbers behind them."""
    return (*(claim.gate() for claim in CLAIMS), *numbers())


def numbers() -> Iterator[Gate]:
    """Yield the gates on numbers that an independent program gives."""
    for claim, number, value, half in NUMBERS:
        why = "independent program: whole number" if half == 0 else "independent program: half a unit of its last digit"
        yield Gate(REGISTER, (claim,), number, *about(value, half), why, reference_uncertainty=half)


@functools.cache
def derived() -> tuple[Derived, ...]:
    """Return the rows of the register."""
    return tuple(claim.row() for claim in CLAIMS)


def data() -> Mapping[str, Any]:
    """Return the claims, and Figure 1: spectral radius over w dt, and the square root of 1 + h that the paper draws."""
    omega = np.geomspace(0.1, 100, 241)
    curves = {}
    for name, (alpha, delta) in SCHEMES.items():
        printed = np.sqrt(np.abs(1 + (0.5 - delta) * omega**2 / (1 + alpha * omega**2)))
        curves[name] = {"radius": _short(spectral_radius(omega, alpha, delta, 1.0)), "printed": _short(printed)}
    claims = [{name: getattr(claim, name) for name in CHAPTER_FIELDS} for claim in CLAIMS]
    return {"omega": _short(omega), "schemes": curves, "claims": claims}


def _short(values: Any) -> list[float]:
    return [float(f"{value:.6g}") for value in values]


PAPER = Study(
    name="paper",
    title="The paper, figure by figure and statement by statement",
    purpose="Every figure of the paper redrawn with the elastic block beside it, and every statement put to the test.",
    scenes=(
        *FIGURES,
        "damping-map",
        "discount-map",
        "poisson-statics",
        "open-close",
        "columns-solves-rest",
        "columns-solves-shaken",
        "viscous",
        "creep-claim",
        "slope-sliding",
    ),
    gates=gates,
    derived=derived,
    data=data,
)
