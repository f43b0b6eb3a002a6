"""Schemes by name where contact opens or slips: one block, columns, sub-blocks."""

import numpy as np
import pytest
from oracles.contact_bodies import apart, shaken
from oracles.scheme_cases import few_schemes, scheme_of

from dda import (
    COLUMNS,
    Block,
    Load,
    Material,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    opening_subdivided,
    solve_unilateral,
)

ENERGIES = UnilateralOptions(energies=True)


def block(mu=0.0, height=2.0):
    return Block.rectangle(2.0, height, Material(2700.0, 1e9, mu, "plane stress"))


@few_schemes
def test_one_sub_block_on_a_base_that_shakes_is_the_block(name, values):
    scheme = scheme_of(name, values, 1e-4, 0.99)
    law = Unilateral(2e8, 1e8, friction=0.3)
    load = Load(1e5, 0.0, 5e4, 9.81, shaken(np.random.default_rng(0), 1e-4))
    model = UnilateralModel(block(0.25, 1.5), law, load, velocity=-0.01)
    one = solve_unilateral(model, scheme, 45, COLUMNS, ENERGIES)
    sub = solve_unilateral(opening_subdivided(model, 1, 1, 1e12), scheme, 45, COLUMNS, ENERGIES)
    for column in COLUMNS:
        assert np.max(np.abs(one.columns[column] - sub.columns[column])) < 1e-11 * np.max(np.abs(one.columns[column]))
    assert np.array_equal(sub.states, one.states) and np.any(np.abs(one.states) == 2)
    for field in ("normal", "shear", "gap", "slide", "slip"):
        assert apart(getattr(sub, field), getattr(one, field)) < 1e-10, field
    for mine, its in zip(sub.base_contacts, one.base_contacts, strict=True):
        assert apart(sub.normal[mine], one.normal[its]) < 1e-10
    assert sub.solves == one.solves and sub.slip[-1] == pytest.approx(one.slip[-1], rel=1e-11) and one.slip[-1] > 0
    assert sub.velocity == pytest.approx(one.velocity, rel=1e-9, abs=1e-12)
    for part, energy in one.energies.items():
        assert np.max(np.abs(energy - sub.energies[part])) < 1e-10 * np.max(one.energies["kinetic"]), part
