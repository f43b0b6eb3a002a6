"""Slips that frictional contact codes are known for, each put in once: some check must notice it."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from faults.steps import (
    after,
    crossed_at_start,
    damped_again,
    gap_of_the_increment,
    kept_shear,
    marked,
    notices,
    stopped,
    velocity_twice,
)
from oracles.frictional import KNOWN, cases, held, sliding, square
from oracles.unilateral_checks import apart

import dda.one_block.unilateral_step as step
from dda import (
    Scheme,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    opening_subdivided,
    solve_opening_system,
    solve_unilateral,
)
from dda.contact import kernel
from dda.contact.unilateral import OPEN, SLIP, STICK

PLACE = ("horizontal_displacement", "displacement", "rotation")
SINGLY = UnilateralOptions(full=True)
MODEL = KNOWN["incline"].model


def invariants():
    for seed, scheme in cases(12):
        held(seed, scheme, 120)


def events():
    """Of second order: three times the steps, a ninth of the error, but for where a switch falls within its step."""
    for name, time in (("rubbing", 0.01), ("pulled", 0.03)):
        errors = []
        for count in (500, 1500):
            scheme = Scheme(0.25, 0.5, 1.0, time / count, "consistent")
            result = solve_unilateral(KNOWN[name].model, scheme, count, PLACE)
            errors.append(np.linalg.norm([result.columns[c][-1] for c in PLACE] - np.array(KNOWN[name].at[time])))
        assert errors[1] < errors[0] / 5


def identity():
    model = UnilateralModel(square(), Unilateral(1e9, 3e9, gap=1e-4, friction=0.27), gravity=9.81, slope=35.0)
    own, must, size = sliding(model, Scheme(0.5, 1.0, 0.99, 3e-4), 120)
    assert len(own) > 12 and np.max(np.abs(own - must)) < 1e-12 * np.max(size)


def cutting():
    """A step that is repeated begins where the failed one did: in free fall the velocity is that of the recursion."""
    flying = replace(MODEL, contact=replace(MODEL.contact, gap=1.0), gravity=0.0, velocity=-0.8)
    for model, first, count in ((MODEL, 20, 30), (flying, 1, 3)):
        scheme = Scheme(0.5, 1.0, 0.9, 2e-4)
        run = partial(solve_unilateral, model, scheme, count, options=SINGLY)
        result, calls = stopped(first, 2, run)
        assert result.step_cuts[first] == 2 and calls[first] == calls[first + 1] == calls[first + 2]
    assert result.velocity == pytest.approx([-0.8 * 0.9, -0.8 * 0.81, -0.8 * 0.729], rel=1e-14)


def points():
    """One sub-block, whose points are solved by another code, is the block."""
    scheme = Scheme(0.5, 1.0, 1.0, 2e-4)
    model = KNOWN["rubbing"].model
    block = solve_unilateral(model, scheme, 150)
    one = solve_opening_system(opening_subdivided(model, 1, 1, 1e15), scheme, 150)
    assert apart(one.shear, block.shear) < 1e-9 and apart(one.slip, block.slip) < 1e-9


CHECKS = (invariants, events, identity, cutting, points)


def of_the_solve_before(monkeypatch):
    """Friction takes N of the solve before."""
    real = step.find_contacts

    def faulty(law, shear_law, *given):
        return real(law, shear_law and shear_law._replace(lagged=shear_law.slips), *given)

    monkeypatch.setattr(step, "find_contacts", faulty)


def outside_the_test(monkeypatch):
    """The iteration ends where nothing opens or closes, whatever sticks and slips."""

    def change(agreed, law, shear_law, state, *given):
        return state if (agreed == OPEN) == (state == OPEN) else agreed

    after(monkeypatch, kernel, "agreed_state", change)


def any_direction(monkeypatch):
    """A contact goes on slipping in its direction, wherever it moves."""
    real = kernel.agreed_state

    def faulty(law, shear_law, state, gap, N, T, slipped):
        return real(law, shear_law, state, gap, N, T, abs(slipped) * state)

    monkeypatch.setattr(kernel, "agreed_state", faulty)


def kept_reference(monkeypatch):
    """A contact that slips keeps its reference: the spring of its next stick remembers all of its way."""

    def change(found, law, shear_law, before, free, flexible, contacts, work):
        for i in range(len(contacts.gap)):
            contacts.stretch[i] += contacts.slipped[i]
        return found

    after(monkeypatch, step, "find_contacts", change)


def old_reference(monkeypatch):
    """A contact that closes again is held from where it was when it opened."""
    real, kept = step.find_contacts, {}

    def faulty(law, shear_law, before, *given):
        for i in range(len(before.gap)):
            kept[i] = before.reference[i] if before.state[i] != OPEN else kept.get(i, 0.0)
        moved = [before.stretch[i] + before.reference[i] - kept[i] for i in range(len(before.gap))]
        state = [now if now != OPEN else STICK for now in before.state[: len(before.gap)]]
        return real(law, shear_law, before._replace(stretch=moved, state=state), *given)

    monkeypatch.setattr(step, "find_contacts", faulty)


def pushed_along(monkeypatch):
    """Friction pushes in the direction of the slip."""
    real = kernel.trial

    def faulty(law, shear_law, before, free, flexible, contacts, work):
        tried = list(work.tried)
        work.tried[:] = [-now if abs(now) == SLIP else now for now in tried]
        real(law, shear_law, before, free, flexible, contacts, work)
        work.tried[:] = tried
        contacts.state[:] = tried

    monkeypatch.setattr(kernel, "trial", faulty)


def forgotten_coupling(monkeypatch):
    """T of a slipping contact is set, but N is found as if there were none."""
    monkeypatch.setattr(kernel, "add_friction", lambda *given: None)


FAULTS = {
    of_the_solve_before: [invariants, events, identity],
    outside_the_test: [invariants, events],
    any_direction: [invariants, events],
    kept_reference: [events],
    old_reference: [events],
    crossed_at_start: [events],
    kept_shear: [invariants],
    pushed_along: [invariants, identity],
    forgotten_coupling: [invariants],
    gap_of_the_increment: [invariants],
    damped_again: [cutting],
    velocity_twice: [cutting],
}


@pytest.mark.parametrize("check", marked(CHECKS, (identity, cutting)))
def test_nothing_is_noticed_without_a_fault(check):
    assert not notices(check)


@pytest.mark.parametrize("fault", marked(FAULTS, (pushed_along, velocity_twice)))
def test_a_known_slip_is_noticed(monkeypatch, fault):
    fault(monkeypatch)
    assert all(map(notices, FAULTS[fault]))
