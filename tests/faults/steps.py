"""Slips of a step that is cut: seeded faults of the stepping of one block, whatever its contact law."""

from contextlib import suppress
from unittest.mock import patch

import pytest

import dda.one_block.unilateral as unilateral
import dda.one_block.unilateral_step as step
from dda.contact.iteration import NONE, Iteration


def damped_again(monkeypatch):
    """Gg stands in a shorter step as in a whole one."""
    real = step.replace
    monkeypatch.setattr(step, "replace", lambda scheme, gg, **given: real(scheme, gg=scheme.gg, **given))


def velocity_twice(monkeypatch):
    """A step that is repeated begins with the velocity of the failed one."""
    real = unilateral.advance

    def faulty(law, length, state, limit, carried=None):
        after, found = real(law, length, state, limit, carried)
        if length.ratio == 1 and after is not None:
            state.P[:] = after.P
        return after, found

    monkeypatch.setattr(unilateral, "advance", faulty)


def after(monkeypatch, owner, name, change):
    """Change what a function returns: `change` is given that, then the function's arguments."""
    real = getattr(owner, name)
    monkeypatch.setattr(owner, name, lambda *given: change(real(*given), *given))


def kept_shear(monkeypatch, owner, name):
    """A corner that opens goes on pulling along the base."""

    def change(found, law, before, free, limit):
        if found.corners is None:
            return found
        every = zip(found.corners.shear, found.corners.closed, before.shear, strict=True)
        shear = tuple(T if now else 0.5 * old for T, now, old in every)
        return found._replace(corners=found.corners._replace(shear=shear))

    after(monkeypatch, owner, name, change)


def gap_of_the_increment(monkeypatch, owner, name):
    """A force is the sum of p times increments: contact remembers tension, or is pressed by a whole step's approach."""
    real = getattr(owner, name)

    def faulty(law, before, free, limit):
        start = [0.0 if shut else w for shut, w in zip(before.closed, before.gap, strict=True)]
        return real(law, before, free._replace(gap=[w - w0 for w, w0 in zip(free.gap, start, strict=True)]), limit)

    monkeypatch.setattr(owner, name, faulty)


def marked(items, short):
    """Mark all but the named ones as long."""
    return [pytest.param(item, marks=[pytest.mark.long] * (item not in short), id=item.__name__) for item in items]


def stopped(first, times, run):
    """Return what a run gives whose steps fail so often after the first ones, and what each try of a step was given."""
    real, calls = unilateral.advance, []

    def stubborn(law, length, state, limit, carried=None):
        calls.append(([*map(list, state[:3])], state.corners))
        after, found = real(law, length, state, limit, carried)
        return (None, Iteration(None, limit, NONE)) if first < len(calls) <= first + times else (after, found)

    with patch.object(unilateral, "advance", stubborn):
        return run(), calls


def notices(check):
    """Whether a check fails."""
    with suppress(AssertionError):
        check()
        return False
    return True
