"""Invariants of contact that opens on many random scenes; the short set draws the first of them."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.unilateral_checks import apart, checked, mirrored, random_model, size, sums

from dda import Scheme, UnilateralOptions, solve_unilateral

MANY, FEW = 250, 4  # scenes, and those of the short set
STEPS = 50
NAMES = ("normal_force_m", "normal_force_n", "shear_force_m", "shear_force_n", "gap_m", "gap_n", "velocity")
ENERGIES = UnilateralOptions(energies=True)


def scheme_of(seed):
    """Return a scheme with alpha = delta / 2 and gg = 1; the step is a twentieth to ten times that of a contact."""
    rng = np.random.default_rng([seed, 7])
    delta, start = [(1.0, "zero"), (0.5, "consistent"), (rng.uniform(0.5, 1.0), "zero")][seed % 3]
    return Scheme(delta / 2, delta, 1.0, 10 ** rng.uniform(-4.5, -2.7), start)


@pytest.mark.parametrize("seeds", [range(FEW), pytest.param(range(FEW, MANY), marks=pytest.mark.long)], ids=len)
def test_random_scenes_keep_the_invariants(seeds):
    for seed in seeds:
        print(f"seed {seed}")  # which pytest shows of a test that fails
        _keeps_the_invariants(seed)


def _keeps_the_invariants(seed):
    model, scheme = random_model(seed), scheme_of(seed)
    result = checked(model, scheme, STEPS)  # N >= 0, w >= -N/p, momentum, energy identity
    total, _ = sums(result)
    if scheme.delta == 1:
        assert np.max(np.diff(total)) < 1e-13 * size(result)
    if not model.contact.shear:
        assert np.max(result.step_solves) <= (3 if result.unknowns == 6 else 2) and not np.any(result.step_cuts)
    again = solve_unilateral(model, scheme, STEPS, options=ENERGIES)
    assert all(np.array_equal(getattr(result, name), getattr(again, name)) for name in NAMES)
    _scales(model, scheme, result)
    if seed % 2:
        _mirrors(model, scheme, result)


def _scales(model, scheme, result):
    """Twice the loads, gap and speed: twice the history, bit by bit, and the same switches."""
    contact = replace(model.contact, gap=2 * model.contact.gap)
    loads = {name: 2 * getattr(model, name) for name in ("pressure", "traction", "gravity", "velocity")}
    two = solve_unilateral(replace(model, contact=contact, **loads), scheme, STEPS)
    assert all(np.array_equal(2 * getattr(result, name), getattr(two, name)) for name in NAMES)
    assert np.array_equal(result.step_solves, two.step_solves) and np.array_equal(result.closed, two.closed)


def _mirrors(model, scheme, result):
    """The mirror image exchanges the corners, to the rounding that impacts multiply, as they multiply a part of p."""
    image = solve_unilateral(mirrored(model), scheme, STEPS)
    grown = 1e-11
    shadow = replace(model, contact=replace(model.contact, stiffness=model.contact.stiffness * (1 + grown)))
    moved = solve_unilateral(shadow, scheme, STEPS)
    growth = max(apart(getattr(result, n), getattr(moved, n)) for n in ("normal_force_m", "normal_force_n")) / grown
    bound = 1e-12 * (1 + 10 * growth)
    if bound > 1e-4:  # beyond the horizon up to which two histories can be compared
        return
    largest = max(np.max(result.normal_force_m), np.max(result.normal_force_n), 1e-300)
    for one, other in (("m", "n"), ("n", "m")):
        mine, theirs = getattr(result, f"normal_force_{one}"), getattr(image, f"normal_force_{other}")
        assert np.max(np.abs(mine - theirs)) <= bound * largest
