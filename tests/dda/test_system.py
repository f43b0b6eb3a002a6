"""Systems of glued blocks: the two-block model as the smallest, linear elements as the limit of stiff glue."""

from dataclasses import replace

import numpy as np
import pytest

import dda
import fem_reference

COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement", "rotation")
TRAPEZIUM = ((0.3, 0.1), (2.3, 0.4), (1.9, 1.6), (0.5, 1.4))
RECORD = dda.BaseMotion([0.0, 0.011, 0.02, 0.05], [[1e-4, 0.0], [3e-3, 1e-3], [-1e-3, 2e-3], [0.0, 5e-4]])
LOADS = {"traction": 2e5, "gravity": 9.81, "eccentricity": 0.2, "motion": RECORD}
SCHEME = dda.Scheme(0.5, 1.0, 1.0, 1e-3)


def two_block(vertices=((0, 0), (2, 0), (2, 2), (0, 2)), mu=0.0, p=1e9, q=5e6, **loads):
    return dda.TwoBlockModel(dda.Block(vertices, dda.Material(2700.0, 1e9, mu)), dda.Contact(p, 0.8 * p), q, **loads)


def largest_error(a, b, columns=COLUMNS):
    """Return the greatest error over the columns, each over its maximum."""
    return max(np.abs(a.columns[c] - b.columns[c]).max() / np.abs(b.columns[c]).max() for c in columns)


def test_a_base_that_never_opens_is_the_locked_one(held):
    scheme, columns = replace(SCHEME, gg=0.98, step=1e-2), COLUMNS[:2] + COLUMNS[3:]
    locked = two_block(mu=0.2, q=3.1e6, eccentricity=0.2)
    law = dda.Unilateral(1e9, 0.8e9)
    opens = dda.UnilateralModel(locked.block, law, 3.1e6, eccentricity=0.2)
    one = dda.solve_system(dda.subdivided(locked, 3, 2, 1e12, "triangles"), scheme, 20, columns)
    other = dda.solve_unilateral(dda.opening_subdivided(opens, 3, 2, 1e12, "triangles"), scheme, 20, columns)
    assert np.all(other.closed) and np.all(other.step_solves == 1)
    assert largest_error(other, one, columns) <= 1e-10
    held("sub-blocks on a base that never opens", other)


DAMPED = replace(SCHEME, mass_damping=30.0, stiffness_damping=2e-4, alpha=0.3025, delta=0.6)


@pytest.mark.parametrize(
    ("scheme", "p", "moved", "bits"),
    # Two orders of operations: a rounding a step. With stiff springs the moving base itself is rounded, and the
    # ringing contact mode keeps what it is given.
    [
        (dda.Scheme(0.25, 0.5, 0.99, 2e-3, "consistent"), 1e9, True, 51),
        (SCHEME, 1e15, True, 44),
        (DAMPED, 1e9, False, 48),
    ],
)
def test_one_sub_block_is_the_two_block_model_to_the_last_bits(scheme, p, moved, bits):
    start = dda.BaseMotion([0.0, 0.02, 0.05], [[0.0, 0.0], [3e-3, 2e-3], [0.0, 5e-4]])
    loads = LOADS | {"motion": start if moved else None}
    model = two_block((TRAPEZIUM[3], *TRAPEZIUM[:3]), 0.3, p, base=1, top=3, **loads)
    one = dda.solve_system(dda.subdivided(model, 1, 1, 1e9), scheme, 60, COLUMNS)
    assert largest_error(one, dda.solve(model, scheme, 60, COLUMNS)) < 60 * 2.0**-bits
    static, expected = dda.static(dda.subdivided(model, 1, 1, 1e9)), dda.static(model)
    for name in COLUMNS:
        assert static[name] == pytest.approx(expected[name], rel=1e-12)
    modes = dda.modes(dda.subdivided(model, 1, 1, 1e9), scheme)
    # the dense eigenvalue solver keeps the digits of the largest flexibility
    for mode, same in zip(modes[:2], dda.modes(model, scheme)[:2], strict=True):
        assert mode.frequency == pytest.approx(same.frequency, rel=1e-9)
        assert mode.share == pytest.approx(same.share, rel=1e-8)
        assert mode.contact_share == pytest.approx(same.contact_share, rel=1e-7)


STILL = {"traction": 2e5, "gravity": 9.81}


@pytest.mark.parametrize(
    ("n", "mu", "p", "loads", "scheme", "corrections"),
    [
        (3, 0.25, 2e9, LOADS, SCHEME, None),
        # without corrections a step of 10 s loses to 1e-5; the elements' own double arithmetic leaves some 1e-11
        pytest.param(3, 0.3, 1e12, STILL, dda.Scheme(0.25, 0.5, 1.0, 10.0), 2, marks=pytest.mark.long),
    ],
)
def test_stiffly_glued_triangles_are_linear_finite_elements(n, mu, p, loads, scheme, corrections):
    result = dda.solve_system(
        dda.subdivided(two_block(TRAPEZIUM, mu, p, **loads), n, n, 1e21, "triangles"), scheme, 12, COLUMNS
    )
    moved = fem_reference.Motion(*map(tuple, (RECORD.time, *np.transpose(RECORD.displacement))))
    others = loads | ({"motion": moved} if "motion" in loads else {})
    data = (2700.0, 1e9, mu, "plane stress", p, 0.8 * p, 5e6, n, 1)
    problem = fem_reference.Problem(TRAPEZIUM, 0, 2, *data, foundation="nodes", cells="triangles", **others)
    elements = fem_reference.Scheme(scheme.alpha, scheme.delta, 1.0, scheme.step)
    expected = fem_reference.solve(problem, elements, 12, COLUMNS, full=corrections is not None)
    assert corrections is None or result.solves == 12 * (1 + corrections)
    assert largest_error(result, expected) < 1e-9  # 1e-8 is asked
