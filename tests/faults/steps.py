"""Slips of a step that is cut: seeded faults of the stepping of one block, whatever its contact law."""

from contextlib import suppress

import dda.one_block.unilateral as unilateral
import dda.one_block.unilateral_step as step


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


def notices(check):
    """Whether a check fails."""
    with suppress(AssertionError):
        check()
        return False
    return True
