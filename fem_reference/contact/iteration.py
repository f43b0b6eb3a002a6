"""The states of a step: guessed, the forces solved for, and all corrected at once until none changes.

For three and more points that may cycle (Ben Gharbia and Gilbert, 2010). Without shear springs the first wrong state is
then set again and again, which ends at the only contact there is, as W + diag(c) is positive definite (Murty, 1974).
With them some steps have no consistent states and some have several: all sets of states are tried if there are few,
and with friction the first wrong state is set again and again if there are many.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from fem_reference.contact.law import (
    AT_LOWER,
    AT_UPPER,
    INSIDE,
    Equations,
    Law,
    States,
    Trial,
    agreed,
    solution,
)
from fem_reference.problem.problem import Array

CONVERGED = 0
NONE = 1
SEVERAL = 2
OVERFLOW = 3
UNSETTLED = 4
"""How a step ends: with its contact, with no consistent set of states, with several, with numbers that overflow;
where there is no fallback, without an end of the iteration."""
ENUMERATED = 256
"""Most sets of states that are all tried: eight points that hold, four that may slide."""
ALIKE = 1e-9
"""Difference of forces below which two sets of states are one contact, over the largest force."""

Contact = tuple[Trial, States, int, int]
"""Forces and places; states; number of solutions; how it has ended."""
Fallback = Callable[[Law, Trial, Array, Array, States, States], Contact]


def find_contact(
    law: Law, equations: Equations, q: Array, gap: Array, states: States, fallback: Fallback | None
) -> Contact:
    """Contact of a step: all states are corrected at once until none changes, from the arguments of `law.solution`.

    Where that does not end within `law.limit` solutions the `fallback` follows.
    """
    trial = solution(law, equations, q, gap, states, states)
    guess = states
    for solves in range(1, law.limit + 1):
        following, wrong = agreed(law, trial, gap, states, guess)
        if trial.settled and wrong < 0:
            return trial, guess, solves, CONVERGED
        guess = following
        if solves < law.limit:
            trial = solution(law, trial.equations, q, gap, states, guess)
    if fallback is None:
        return trial, guess, law.limit, UNSETTLED
    return fallback(law, trial, q, gap, states, guess)


def fall_back(law: Law, trial: Trial, q: Array, gap: Array, states: States, guess: States) -> Contact:
    """Try all sets of states where few points have partners, correct one after the other without or with many."""
    pairs = law.partner != np.arange(len(q))
    if pairs.any():
        slides = bool(np.isfinite(law.upper[pairs]).any())
        points = len(q) - np.count_nonzero(pairs)
        if float(4 if slides else 2) ** points <= ENUMERATED:
            return only_contact(law, trial, q, gap, states, slides)
        if not slides:
            return trial, guess, law.limit, NONE
    return singly(law, trial, q, gap, states, guess)


def singly(law: Law, trial: Trial, q: Array, gap: Array, states: States, guess: States) -> Contact:
    """Set the states of the first point that is wrong until none is, from where all at once have led."""
    guess = guess.copy()
    unique = not np.any(law.partner != np.arange(len(q)))
    for changes in range(1, law.single_limit + 1):
        trial = solution(law, trial.equations, q, gap, states, guess)
        following, wrong = agreed(law, trial, gap, states, guess)
        if wrong < 0:
            # Without partners this ends at the only contact, and counts as one solution.
            return trial, guess, law.limit + (1 if unique else changes), CONVERGED if trial.settled else NONE
        guess = np.where(law.partner == wrong, following, guess)
    return trial, guess, law.limit + law.single_limit, NONE


def only_contact(law: Law, trial: Trial, q: Array, gap: Array, states: States, slides: bool) -> Contact:
    """Try all sets of states for the one whose forces and places ask for it.

    Two sets with the same forces are one contact: a point without any force has several names for its state.
    """
    outcome = NONE
    first = trial
    names = states
    pairs = law.partner != np.arange(len(q))
    held = [(INSIDE, AT_LOWER), (INSIDE, AT_UPPER)] if slides else []
    choices = ((AT_LOWER, INSIDE), (INSIDE, INSIDE), *held)  # of a point and of the rows that it presses
    points = len(q) - int(np.count_nonzero(pairs))
    for sets in itertools.product(choices, repeat=points):
        chosen = np.array(sets, dtype=np.int8)
        place = np.cumsum(~pairs)[law.partner] - 1
        guess = np.where(pairs, chosen[place, 1], chosen[place, 0])
        trial = solution(law, trial.equations, q, gap, states, guess)
        if not trial.settled or agreed(law, trial, gap, states, guess)[1] >= 0:
            continue
        if outcome == NONE:
            outcome = CONVERGED
            first = trial
            names = guess
            continue
        size = max(np.abs(trial.force).max(), np.abs(first.force).max())
        if np.abs(trial.force - first.force).max() > ALIKE * size:
            outcome = SEVERAL
    return first, names, law.limit + 1, outcome
