"""Opening contact against 80-digit arithmetic."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles import block_in_digits

from dda import Block, Material, Scheme, Unilateral, UnilateralModel, solve_unilateral
from fem_reference.events.block_model import BlockProblem

EPS = np.finfo(float).eps


def model_of(problem):
    block = Block.rectangle(problem.width, problem.height, Material(problem.density, problem.young, problem.poisson))
    contact = Unilateral(problem.stiffness, problem.shear_stiffness, problem.gap)
    names = ("pressure", "eccentricity", "traction", "gravity", "velocity")
    return UnilateralModel(block, contact, **{name: getattr(problem, name) for name in names})


IMPACT = BlockProblem(1.7, 1.3, 2350.0, 4.3e9, 1e9, velocity=-1.0)


def histories(model, scheme, steps):
    """Return (computed, exact) of v, the normal forces and the shear forces."""
    result, exact = solve_unilateral(model, scheme, steps), block_in_digits.history(model, scheme, steps)
    assert result.outcome == "completed"
    v = (result.columns["displacement"], [row[0] for row in exact])
    N = [(mine, [row[1][i] for row in exact]) for i, mine in enumerate((result.normal[0], result.normal[1]))]
    T = [(mine, [row[2][i] for row in exact]) for i, mine in enumerate((result.shear[0], result.shear[1]))]
    return v, N, T


# Stiffness against step: soft to rigid, a contact resolved in time and one that is not.
PAIRS = [(1.0, 1e3), (1e9, 1e-6), (1e13, 1e-3), (1e17, 1e-9), (1e17, 1e3), (1e21, 1e-3), (1e24, 1e-9), (1e24, 1e-3)]


@pytest.mark.parametrize(("p", "dt", "gg"), thinned([(*pair, gg) for pair in PAIRS for gg in (0.99, 1.0)], 9))
def test_one_contact_keeps_its_digits_from_soft_to_rigid(p, dt, gg):
    (v, exact), forces, _ = histories(model_of(replace(IMPACT, stiffness=p)), Scheme(0.5, 1.0, gg, dt), 30)
    assert block_in_digits.lost(v, exact) < 1e-14
    assert max(block_in_digits.lost(*pair) for pair in forces) < 1e-14


# A corner that closes meets the rounding of a step as a relative error of its small overshoot; two corners in turn
# multiply it. The oracle, started at V (1 + 1e-12), tells by how much: `steps` times some ten roundings, each grown so.
CORNERS = [(1e3, 1e3), (1e9, 1e-9), (1e9, 1e-3), (1e13, 1e-4), (1e24, 1e-4), (1e24, 1e3)]


@pytest.mark.parametrize(
    ("p", "dt", "glued"), thinned([(*pair, glued) for pair in CORNERS for glued in (0.0, 0.4)][::-1], 12)
)
def test_two_corners_keep_their_digits_up_to_what_impacts_multiply(p, dt, glued):
    steps, grown = 16, 1e-12
    problem = replace(
        IMPACT,
        poisson=0.31,
        stiffness=p,
        shear_stiffness=glued * p,
        gap=0.37 * dt,
        pressure=3.7e6,
        eccentricity=0.13,
        gravity=3.0,
    )
    model, scheme = model_of(problem), Scheme(0.5, 1.0, 0.97, dt)
    shadow = replace(model, velocity=model.velocity * (1 + grown))
    (v, exact), normal, shear = histories(model, scheme, steps)
    moved = block_in_digits.history(shadow, scheme, steps)
    largest = max(abs(N) for _, history in normal for N in history)
    growth = max(abs(float((a - b[0]) / max(map(abs, exact)))) for a, b in zip(exact, moved, strict=True)) / grown
    for i, (_, N) in enumerate(normal):
        growth = max(growth, *(abs(float((a - b[1][i]) / largest)) / grown for a, b in zip(N, moved, strict=True)))
    bound = steps * 10 * EPS * (1 + growth)
    assert block_in_digits.lost(v, exact) < bound
    for mine, theirs in (*normal, *shear):
        assert max(abs(float(x - y)) for x, y in zip(mine, theirs, strict=True)) < bound * float(largest)
