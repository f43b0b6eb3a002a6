"""The study `paper`: every figure redrawn, every statement tested."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dda.scheme.spectral import spectral_radius
from validation.engine.finished import DerivedRows
from validation.gates.gate import Gate
from validation.metrics.values import as_number, or_nan
from validation.runs.row import Metrics, Row
from validation.scenes.scene import Scene
from validation.studies.paper import open_close, register, slips
from validation.suite.bands import short
from validation.suite.claims import Register, read_claims

CLAIMS = read_claims(
    Path(__file__).with_name("claims.toml"),
    register.TESTS | open_close.TESTS | slips.TESTS,
)
CLAIMS_OF_THE_PAPER = Register(
    study="paper",
    title="The paper's statements and slips",
    page="docs/claims.md",
    introduction="Statements (C) of the paper and slips (S) of its equations. Each verdict follows from measured "
    "numbers, which `dda-validate claims --json` prints, and is a gate of the study `paper`. This page is written by "
    "`dda-validate claims --out docs/claims.md`, and a test compares it with a fresh run.",
    claims=CLAIMS,
)
COARSE = 6  # steps a period; with fewer the undamped continuum is not a curve any more
OMEGA = (0.1, 100.0)  # w dt from and to which Figure 1 is drawn
MODES = ("mode1", "contact")
SCHEMES = {  # of Figure 1: name -> alpha, delta
    "average acceleration (1/4, 1/2)": (0.25, 0.5),
    "constant acceleration (1/2, 1)": (0.5, 1.0),
    "(9/16, 1)": (0.5625, 1.0),
    "(0.3025, 0.6)": (0.3025, 0.6),
}


def data() -> Mapping[str, Any]:
    """Return the words of the claims, and Figure 1: spectral radius over w dt, and the printed root of 1 + h.

    That departs from the radius where the roots are real; only this part is kept.
    """
    omega = np.geomspace(*OMEGA, 241)
    schemes = []
    printed_curves = []
    for name, (alpha, delta) in SCHEMES.items():
        printed = np.sqrt(np.abs(1 + (0.5 - delta) * omega**2 / (1 + alpha * omega**2)))
        radius = spectral_radius(omega, alpha, delta, 1.0)
        departs = np.abs(printed - radius) > 1e-6
        schemes.append({"name": name, "omega": short(omega, 6), "radius": short(radius, 6)})
        if departs.any():
            curve = {"omega": short(omega[departs], 6), "radius": short(printed[departs], 6)}
            printed_curves.append({"name": name, "scheme": name.split(" (")[0]} | curve)
    return {"schemes": schemes, "printed": printed_curves} | CLAIMS_OF_THE_PAPER.words()


def gates() -> tuple[Gate, ...]:
    """Return the gates on the claims."""
    return CLAIMS_OF_THE_PAPER.gates()


def rows() -> DerivedRows:
    """Return the rows of the claims."""
    return CLAIMS_OF_THE_PAPER.rows()


def period(case: Scene, bar: Row) -> Metrics:
    """Return the steps in a period of the bar, and whether the continuum is a curve with so few."""
    steps = 2 * math.pi / (as_number(bar.metrics["mode1.frequency"]) * case.time.step)
    return {"steps": steps, "continuum": "curve" if steps >= COARSE else "none"}


def angles(case: Scene, dda: Row) -> Metrics:
    """Return w dt of both modes of the block within Figure 1."""
    of_modes = {mode: or_nan(dda.metrics.get(f"{mode}.frequency")) * case.time.step for mode in MODES}
    return {mode: angle for mode, angle in of_modes.items() if OMEGA[0] <= angle <= OMEGA[1]}
