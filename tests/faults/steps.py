"""Slips of a step that is cut: seeded faults of the stepping of one block, whatever its contact law."""

from contextlib import suppress
from copy import deepcopy
from unittest.mock import patch

import pytest

import dda.one_block.unilateral as unilateral
import dda.one_block.unilateral_step as step
from dda.contact import kernel
from dda.contact.kernel import NONE
from dda.stepping.driver import driver


def stepping_by(advance):
    """Return the loop over the steps of one block whose steps are made by another function."""
    return driver(advance, step.account, step.keep)


def damped_again(monkeypatch):
    """Gg stands in a shorter step as in a whole one."""
    real = step.set_length

    def faulty(block, shear_law, stage, ratio, length):
        real(block, shear_law, stage, ratio, length)
        length.numbers[1] = block.gg

    monkeypatch.setattr(step, "set_length", faulty)


def velocity_twice(monkeypatch):
    """A step that is repeated begins with the velocity of the failed one."""
    real = step.accept

    def faulty(block, shear_law, stage, length, state, after):
        real(block, shear_law, stage, length, state, after)
        if length.numbers[0] == 1:
            state.P[:] = after.P

    monkeypatch.setattr(step, "accept", faulty)


def after(monkeypatch, owner, name, change):
    """Change what a function returns: `change` is given that, then the function's arguments."""
    real = getattr(owner, name)
    monkeypatch.setattr(owner, name, lambda *given: change(real(*given), *given))


def kept_shear(monkeypatch):
    """A corner that opens goes on pulling along the base."""

    def change(found, law, shear_law, before, free, flexible, contacts, work):
        for i in range(len(contacts.gap)):
            if contacts.state[i] == 0:
                contacts.shear[i] = 0.5 * before.shear[i]
        return found

    after(monkeypatch, step, "find_contacts", change)


def gap_of_the_increment(monkeypatch):
    """A force is the sum of p times increments: contact remembers tension, or is pressed by a whole step's approach."""
    real = step.find_contacts

    def faulty(law, shear_law, before, free, *given):
        gap = [free.gap[i] - (before.gap[i] if before.state[i] == 0 else 0.0) for i in range(len(before.gap))]
        return real(law, shear_law, before, free._replace(gap=gap), *given)

    monkeypatch.setattr(step, "find_contacts", faulty)


def crossed_at_start(monkeypatch):
    """A corner closes with the reference of the step's start, not of the crossing."""
    monkeypatch.setattr(kernel, "crossing_share", lambda law, before, N: 1.0)
    monkeypatch.setattr(kernel, "crossing_rate", lambda law, before, N: 0.0)


def marked(items, short):
    """Mark all but the named ones as long."""
    return [pytest.param(item, marks=[pytest.mark.long] * (item not in short), id=item.__name__) for item in items]


def stopped(first, times, run):
    """Return what a run gives whose steps fail so often after the first ones, and what each try of a step was given."""
    calls = []

    def stubborn(block, shear_law, state, after, base, part):
        calls.append(deepcopy(state))
        outcome, solves = step.advance(block, shear_law, state, after, base, part)
        return (NONE, solves) if first < len(calls) <= first + times else (outcome, solves)

    with patch.object(unilateral, "make_steps", stepping_by(stubborn)):
        return run(), calls


def notices(check):
    """Whether a check fails."""
    with suppress(AssertionError):
        check()
        return False
    return True
