"""Which iteration finds the states of contacts: the law decides."""

from __future__ import annotations

from dda.contact.friction import rubbing
from dda.contact.glued import Free
from dda.contact.iteration import Iteration, open_close
from dda.contact.lagged import lagged
from dda.contact.unilateral import LAGGED, Corners, Unilateral


def find_states(law: Unilateral, before: Corners, free: Free, limit: int) -> Iteration:
    """Find the contacts at the end of a step; those that cannot slide have no friction.

    Parameters
    ----------
    law, before, free
        Law of the contacts, the contacts at the start of the step, and the step without contact forces.
    limit
        Greatest number of solves before all states are tried.
    """
    if law.friction is None or not len(free.slide):
        return open_close(law, before, free, limit)
    return (lagged if law.rules == LAGGED else rubbing)(law, before, free, limit)
