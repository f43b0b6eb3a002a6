"""Sub-blocks that rub on their base: one of them is the block, and of many every point obeys the law."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.frictional import KNOWN, shaken
from oracles.unilateral_checks import apart

from dda import Scheme, UnilateralOptions, opening_subdivided, solve_unilateral

ENERGIES = UnilateralOptions(energies=True)
FIELDS = ("normal", "shear", "gap", "slide", "slip")


def test_one_sub_block_on_a_base_that_shakes_is_the_block():
    scheme = Scheme(0.5, 1.0, 1.0, 2e-4)
    model = replace(KNOWN["rubbing"].model, motion=shaken(np.random.default_rng(0), 1e-4))
    block = solve_unilateral(model, scheme, 150, options=ENERGIES)
    one = solve_unilateral(opening_subdivided(model, 1, 1, 1e15), scheme, 150, options=ENERGIES)
    assert np.array_equal(one.states, block.states) and np.any(np.abs(one.states) == 2)
    for field in FIELDS:
        assert apart(getattr(one, field), getattr(block, field)) < 1e-10, field
    for mine, its in zip(one.base_contacts, block.base_contacts, strict=True):
        assert apart(one.normal[mine], block.normal[its]) < 1e-10
    for name in ("friction", "load", "springs"):
        assert one.energies[name] == pytest.approx(block.energies[name], rel=1e-9, abs=1e-9 * np.max(block.normal))
    assert np.ptp(sum(one.energies.values())) < 1e-9 * np.max(np.abs(one.energies["load"]))
    assert one.columns["displacement"] == pytest.approx(block.columns["displacement"], rel=1e-9, abs=1e-12)
