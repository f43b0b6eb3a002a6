"""One block on corners that open: invariants of the stepping at random data, to rounding, and named outcomes."""

import numpy as np
import pytest
from oracles.contact_bodies import CASES
from oracles.unilateral_checks import DT, apart

from dda import (
    Block,
    Material,
    Scheme,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    solve_unilateral,
)

SCHEMES = [
    (0.5, 1.0, 1.0, "zero"),
    (0.25, 0.5, 1.0, "consistent"),
    (0.3025, 0.6, 0.97, "zero"),
    (0.7, 0.8, 0.99, "zero"),
]
PAPER = UnilateralModel(Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0)), Unilateral(1e9), 5e6)
OTHER = UnilateralModel(
    Block.rectangle(1.7, 1.3, Material(2350.0, 4.3e9, 0.31)), Unilateral(7e9, 3e9), 3.7e6, gravity=4.0
)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_one_contact_for_both_corners_is_the_full_model(scheme):
    alpha, delta, gg, start = scheme
    names = ("normal", "shear", "gap", "velocity")
    one, full = (
        solve_unilateral(OTHER, Scheme(alpha, delta, gg, DT, start), 200, options=UnilateralOptions(full=kept))
        for kept in (False, True)
    )
    assert one.unknowns == 3 and full.unknowns == 6 and np.count_nonzero(np.diff(one.closed[0])) > 0
    for name in names:
        assert apart(getattr(full, name), getattr(one, name)) <= 1e-9, name
    assert solve_unilateral(PAPER, Scheme(alpha, delta, gg, DT), 2).unknowns == 2


def test_glued_states_that_disagree_are_cut_and_the_run_goes_on():
    """Long steps and stiff glued corners: some have no single state."""
    assert sum(np.sum(CASES["long steps"](seed).run().step_cuts) for seed in range(12)) > 0
