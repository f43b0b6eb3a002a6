"""Slips that contact codes are known for, each put in once: some check of the stepping must notice it."""

from contextlib import suppress
from dataclasses import replace

import pytest
from oracles import unilateral_mp
from oracles.unilateral_checks import DT, checked, random_model, run

import dda.contact.glued as glued
import dda.contact.iteration as iteration
import dda.one_block.unilateral as unilateral
import dda.one_block.unilateral_step as step
from dda import Scheme, Unilateral, solve_unilateral
from dda.contact.unilateral import Corners

RECTANGLE = 5  # a seed whose block is a rectangle, off-centre and glued


def invariants():
    for seed in range(8):
        checked(random_model(seed), Scheme(0.5, 1.0, 1.0, DT), 200)


def digits():
    """Against 60 digits: a glued block that lands, opens and lands again."""
    model, scheme = random_model(RECTANGLE), Scheme(0.5, 1.0, 0.99, 4 * DT)
    result, exact = solve_unilateral(model, scheme, 60), unilateral_mp.history(model, scheme, 60)
    for values, part, i in (
        (result.normal_force_m, 1, 0),
        (result.shear_force_m, 2, 0),
        (result.shear_force_n, 2, 1),
    ):
        assert unilateral_mp.lost(values, [row[part][i] for row in exact]) < 1e-10


def stiff_digits():
    model = replace(random_model(1, glued=False), contact=Unilateral(1e24), gravity=0.0, pressure=0.0, velocity=-1.0)
    scheme = Scheme(0.5, 1.0, 0.99, 1e-3)
    result, exact = solve_unilateral(model, scheme, 20), unilateral_mp.history(model, scheme, 20)
    assert unilateral_mp.lost(result.normal_force_m, [row[1][0] for row in exact]) < 1e-12


def cutting():
    """The first trials fail: the step is repeated, shorter, from the state that was saved."""
    real, calls = unilateral.advance, []

    def stubborn(law, length, state, limit):
        calls.append(([*map(list, state[:3])], state.corners))
        after, found = real(law, length, state, limit)
        return (None, iteration.Iteration(None, limit, iteration.NONE)) if len(calls) <= 2 else (after, found)

    unilateral.advance = stubborn
    try:
        model = replace(random_model(1, glued=False), contact=Unilateral(1e9, gap=1.0), gravity=0.0, pressure=0.0)
        result = run(replace(model, velocity=-0.8), gg=0.9, steps=3)
    finally:
        unilateral.advance = real
    assert result.step_cuts.tolist() == [2, 0, 0]
    assert calls[0] == calls[1] == calls[2]
    assert result.velocity == pytest.approx([-0.8 * 0.9, -0.8 * 0.81, -0.8 * 0.729], rel=1e-14)


CHECKS = (invariants, digits, stiff_digits, cutting)


def notices(check):
    """Whether a check fails."""
    with suppress(AssertionError):
        check()
        return False
    return True


def crossing_at_start(law, before, N):
    return 1.0, 0.0


def old_reference(monkeypatch):
    """A corner that closes again keeps the stretch that it opened with."""
    real, kept = glued.glued, {}

    def faulty(law, before, free, closed):
        for i, shut in enumerate(before.closed):
            if shut:
                kept[i] = before.stretch[i]
        stretch = tuple(kept.get(i, 0.0) for i in range(len(closed)))
        return real(law, before._replace(closed=(True,) * len(closed), stretch=stretch), free, closed)

    monkeypatch.setattr(iteration, "glued", faulty)


def dead_band(monkeypatch):
    monkeypatch.setattr(Unilateral, "stays_closed", lambda law, N: -law.stiffness * 1e-6 <= N)


def damped_again(monkeypatch):
    """Gg stands in a shorter step as in a whole one."""
    real = step.replace
    monkeypatch.setattr(step, "replace", lambda scheme, gg, **given: real(scheme, gg=scheme.gg, **given))


def velocity_twice(monkeypatch):
    """A step that is repeated begins with the velocity of the failed one."""
    real = unilateral.advance

    def faulty(law, length, state, limit):
        after, found = real(law, length, state, limit)
        if length.ratio == 1 and after is not None:
            state.P[:] = after.P
        return after, found

    monkeypatch.setattr(unilateral, "advance", faulty)


def kept_shear(monkeypatch):
    """A corner that opens goes on pulling along the base."""
    real = step.open_close

    def faulty(law, before, free, limit):
        found = real(law, before, free, limit)
        if found.corners is None:
            return found
        shear = tuple(
            T if now else 0.5 * old
            for T, now, old in zip(found.corners.shear, found.corners.closed, before.shear, strict=True)
        )
        return found._replace(corners=found.corners._replace(shear=shear))

    monkeypatch.setattr(step, "open_close", faulty)


def incremental_gap(monkeypatch):
    """A force is the sum of p times increments: a corner that closes is pressed by the whole step's approach."""
    real = step.open_close

    def faulty(law, before, free, limit):
        start = [0.0 if shut else w for shut, w in zip(before.closed, before.gap, strict=True)]
        return real(law, before, free._replace(gap=[w - w0 for w, w0 in zip(free.gap, start, strict=True)]), limit)

    monkeypatch.setattr(step, "open_close", faulty)


def remembered_tension(monkeypatch):
    """A corner closes again where it opened, not where it touches."""
    monkeypatch.setattr(Unilateral, "closes", lambda law, w: w < 2e-5)


def lost_weight(monkeypatch):
    """The contact force of the step's start is forgotten in the velocity."""
    monkeypatch.setattr(step, "velocity_corrector", lambda scheme, P, f, f1: scheme.gg * P + f1 * 0.999)


def crossed_at_start(monkeypatch):
    """A corner closes with the reference of the step's start, not of the crossing."""
    monkeypatch.setattr(glued, "slipped_share", crossing_at_start)


FAULTS = {
    old_reference: [digits],
    crossed_at_start: [digits],
    dead_band: [invariants],
    damped_again: [cutting],
    velocity_twice: [cutting],
    kept_shear: [invariants, digits],
    incremental_gap: [invariants, digits],
    remembered_tension: [invariants],
    lost_weight: [invariants, digits],
}


def test_nothing_is_noticed_without_a_fault():
    assert not any(map(notices, CHECKS))


SHORT = (crossed_at_start, dead_band, damped_again)  # one of each check
MARKED = [pytest.param(fault, marks=[pytest.mark.long] * (fault not in SHORT)) for fault in FAULTS]


@pytest.mark.parametrize("fault", MARKED, ids=lambda fault: fault.__name__)
def test_a_known_slip_is_noticed(monkeypatch, fault):
    fault(monkeypatch)
    assert all(map(notices, FAULTS[fault]))


def test_the_corners_of_the_faults_are_those_of_the_package():
    assert Corners._fields == ("closed", "gap", "stretch", "reference", "normal", "shear")
