"""The study `paper`: every figure redrawn, every statement tested."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dda.scheme.spectral import spectral_radius
from validation.engine.finished import Derived
from validation.gates.gate import Gate
from validation.studies.paper import open_close, register, slips
from validation.suite.bands import short
from validation.suite.claims import Register, read_claims

CHAPTER_FIELDS = ("id", "place", "says", "why", "condition", "misprint")  # of a claim
CLAIMS = read_claims(
    Path(__file__).with_name("claims.toml"),
    register.TESTS | open_close.TESTS | slips.TESTS,
)
CLAIMS_OF_THE_PAPER = Register(
    study="paper",
    title="The paper's statements and slips",
    page="docs/claims.md",
    introduction="Every line is computed: the verdict follows from the measured numbers and is a gate of the study "
    "`paper`. This page is written by `dda-validate claims --out docs/claims.md`, and a test compares it with a fresh "
    "run. Numbers below 1e-12 are written as 0.",
    claims=CLAIMS,
)
FIGURES = ("figures-3-4", "figures-5-6", "figure-7", "figure-8", "figure-9")
SCHEMES = {  # of Figure 1: name -> alpha, delta
    "average acceleration (1/4, 1/2)": (0.25, 0.5),
    "constant acceleration (1/2, 1)": (0.5, 1.0),
    "(9/16, 1)": (0.5625, 1.0),
    "(0.3025, 0.6)": (0.3025, 0.6),
}


def data() -> Mapping[str, Any]:
    """Return the claims, and Figure 1: spectral radius over w dt, and the square root of 1 + h that the paper draws."""
    omega = np.geomspace(0.1, 100, 241)
    curves = {}
    for name, (alpha, delta) in SCHEMES.items():
        printed = np.sqrt(np.abs(1 + (0.5 - delta) * omega**2 / (1 + alpha * omega**2)))
        radius = spectral_radius(omega, alpha, delta, 1.0)
        curves[name] = {"radius": short(radius, 6), "printed": short(printed, 6)}
    return {"omega": short(omega, 6), "schemes": curves} | CLAIMS_OF_THE_PAPER.data(*CHAPTER_FIELDS)


def gates() -> tuple[Gate, ...]:
    """Return the gates on the claims."""
    return CLAIMS_OF_THE_PAPER.gates()


def rows() -> tuple[Derived, ...]:
    """Return the rows of the claims."""
    return CLAIMS_OF_THE_PAPER.rows()
