"""Invariants of contact that opens on many random scenes; the short set draws the first of them."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.unilateral_checks import apart, checked, mirrored, random_model, size, sums

from dda import Contact, Scheme, TwoBlockModel, UnilateralOptions, solve, solve_unilateral

MANY, FEW, LEAST = 500, 20, 4  # scenes of the short set: LEAST where each is stepped four times and more
STEPS = 50
NAMES = ("normal_force_m", "normal_force_n", "shear_force_m", "shear_force_n", "gap_m", "gap_n", "velocity")
ENERGIES = UnilateralOptions(energies=True)


def scheme_of(seed):
    """Return a scheme with alpha = delta / 2 and gg = 1; the step is a twentieth to ten times that of a contact."""
    rng = np.random.default_rng([seed, 7])
    delta, start = [(1.0, "zero"), (0.5, "consistent"), (rng.uniform(0.5, 1.0), "zero")][seed % 3]
    return Scheme(delta / 2, delta, 1.0, 10 ** rng.uniform(-4.5, -2.7), start)


def seeds_from(few):
    """Return the seeds of the short set, and all others as long."""
    return [range(few), pytest.param(range(few, MANY), marks=pytest.mark.long)]


@pytest.mark.parametrize("seeds", seeds_from(LEAST), ids=len)
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


@pytest.mark.parametrize("seeds", seeds_from(FEW), ids=len)
def test_what_never_opens_is_locked(seeds):
    """Steps beyond a/(c sqrt(6 alpha)) keep a pressed block on its springs."""
    names, compared = ("displacement", "contact_pressure", "rotation"), 0
    for seed in seeds:
        model = random_model(seed)
        model = replace(model, contact=replace(model.contact, gap=0.0), velocity=0.0)
        scheme = Scheme(0.5, 1.0, 0.99, 6e-3)
        opens = solve_unilateral(model, scheme, STEPS, names)
        if not opens.closed.all():
            continue
        contact = Contact(model.contact.stiffness, model.contact.shear or model.contact.stiffness)
        if not model.contact.shear:
            continue  # locked springs hold in shear
        loads = model.load, model.base, model.top
        locked = solve(TwoBlockModel(model.block, contact, *loads), scheme, STEPS, names)
        scale = np.max(np.abs(locked.columns["displacement"])) / model.block.corners[1, 0]
        for name in names:
            most = max(np.max(np.abs(locked.columns[name])), scale if name == "rotation" else 0.0)
            assert np.max(np.abs(opens.columns[name] - locked.columns[name])) <= 1e-11 * most, (seed, name)
        compared += 1
    assert compared > len(seeds) / 8
