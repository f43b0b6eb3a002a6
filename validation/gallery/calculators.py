"""The calculators: what can be set on their pages, and within which limits.

The formulas are those of `static/formulas.js`, the arithmetic of the pages that of `static/calculators.js`.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Control:
    """A number that can be set, by a slider or exactly."""

    id: str
    label: str
    unit: str
    value: float
    low: float
    high: float
    logarithmic: bool = False  # whether the slider runs over the logarithm


@dataclass(frozen=True)
class Choice:
    """One of several words."""

    id: str
    label: str
    options: tuple[tuple[str, str], ...]  # value and text


@dataclass(frozen=True)
class Calculator:
    """A page with controls, numbers and charts."""

    id: str
    title: str
    question: str
    says: str
    controls: tuple[Control | Choice, ...]
    block: tuple[Control, ...]  # folded away: the paper's block is what most will ask about
    charts: tuple[tuple[str, str], ...]  # id and what a chart shows


STIFFNESS = Control("stiffness_ratio", "Spring stiffness p/E", "N/m per Pa", 1.0, 1e-3, 1e6, True)
STEP = Control("step", "Time step dt", "s", 0.002, 1e-6, 1.0, True)
GG = Control("gg", "Discount gg, per step", "", 1.0, 0.8, 1.0)
SCHEME = Choice(
    "scheme",
    "Scheme",
    (
        ("0.5,1", "constant acceleration, (α, δ) = (1/2, 1)"),
        ("0.25,0.5", "average acceleration, (1/4, 1/2)"),
        ("0.5625,1", "(9/16, 1)"),
        ("custom", "as below"),
    ),
)
ALPHA = Control("alpha", "α", "", 0.5, 0.0, 1.5)
DELTA = Control("delta", "δ", "", 1.0, 0.5, 1.5)
STEPPING = (STEP, GG, SCHEME, ALPHA, DELTA)
SIDE = Control("side", "Side of the block a", "m", 2.0, 0.01, 100.0, True)
DENSITY = Control("density", "Density ρ", "kg/m³", 2700.0, 100.0, 20000.0, True)
YOUNG = Control("young", "Young's modulus E", "Pa", 1.0e9, 1e5, 1e12, True)
BLOCK = (SIDE, DENSITY, YOUNG)

CALCULATORS = (
    Calculator(
        "damping",
        "Damping budget",
        "How much of critical damping does a time step hide, and which part of it?",
        "Total damping ratio ξ of the first axial mode of the block and of its contact mode, from trace and "
        "determinant of one step; the algorithmic part is that of the same scheme at gg = 1, the kinetic the rest.",
        (STIFFNESS, *STEPPING),
        BLOCK,
        (("budget", "Damping ratio of the two modes over the time step"),),
    ),
    Calculator(
        "adviser",
        "Adviser",
        "Which time step, discount or scheme gives the damping that I want?",
        "All values of one parameter with which the first axial mode has the wanted damping ratio, the others held "
        "fixed. No value is offered with which the highest mode grows.",
        (
            Control("target", "Wanted damping ratio ξ", "", 0.05, 1e-4, 2.0, True),
            Choice("solve_for", "Solve for", (("dt", "time step dt"), ("gg", "discount gg"), ("scheme", "scheme δ"))),
            STIFFNESS,
            *STEPPING,
        ),
        BLOCK,
        (("search", "Damping ratio over what is varied"),),
    ),
    Calculator(
        "rebound",
        "Rebound",
        "Which share of its speed does a contact return?",
        "Restitution e of a rigid mass without load on a no-tension spring under the scheme, over the phase θ: where "
        "in a step it lands, 0 to 1. For one contact of the base of a block much softer than its springs (p ≥ 100E), a "
        "quarter of the mass, w_c = √(8 p/m); the whole block lands otherwise: dda-validate contact.",
        (
            STIFFNESS,
            Control("step", "Time step dt", "s", 0.0005, 1e-5, 1.0, True),
            *STEPPING[1:],
        ),
        BLOCK,
        (("phase", "Restitution over the phase of the landing"), ("steps", "Mean, least and greatest over the step")),
    ),
    Calculator(
        "wave",
        "Wave loss",
        "How much of a wave arrives through a column of blocks, and when?",
        "A plane wave through welded blocks of one strain, its wavenumber from cos(kh) = (6 − 2L)/(6 + L) with the "
        "squared frequency that the scheme makes of ω.",
        (
            Control("frequency", "Frequency F", "Hz", 20.0, 0.01, 10000.0, True),
            Control("side", "Height of a block h", "m", 2.0, 0.001, 100.0, True),
            Control("wavelengths", "The wave's path", "wavelengths", 10.0, 0.1, 1000.0, True),
            *STEPPING,
        ),
        (DENSITY, YOUNG),
        (
            ("arrives", "Share of the amplitude that arrives, over frequency"),
            ("speed", "Error of the phase speed, over frequency"),
        ),
    ),
)
