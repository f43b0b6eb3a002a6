"""Combinations of causes at their best: fits of many at once, first over the first few periods, then over more.

Over a few periods no fit goes astray; what comes near there is fitted over more and more of the history.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.diagnosis.fits.fit import Fit, changed, fit
from validation.diagnosis.fits.target import Target
from validation.diagnosis.moves import Move
from validation.diagnosis.variant import Variant

PERIODS = 5.0  # of the first mode, over which a fit does not go astray
SHORTEST, COARSE = 30, 500  # steps of the first fits
STRETCH = 5  # of the fitted part of a long history, from fit to fit
KEPT = 16  # candidates that are fitted over more of the history
CHUNK = 1500  # variants in one pass
FIRST_ROUNDS, ROUNDS = 5, 12  # of the fits: of all candidates, of those that are left
MANY = 80  # candidates that are fitted further

Start = tuple[tuple[Move, ...], Variant, tuple[str, ...]]  # causes, where their fit begins, its free numbers


@dataclass(frozen=True, eq=False)
class Found:
    """Causes, with the fit that has them."""

    moves: tuple[Move, ...]
    fit: Fit

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the causes, each once."""
        return tuple(dict.fromkeys(move.id for move in self.moves))


# ---- fits -----------------------------------------------------------------------------------------------------------


def fitted(target: Target, scene: Variant, combos: Sequence[tuple[Move, ...]]) -> list[Found]:
    """Return combinations of causes at their best, the best first.

    A combination with free numbers begins at the two of its starts that come nearest.
    """
    n = len(target.steps)
    steps = min(max(SHORTEST, math.ceil(PERIODS * _period(target) / float(np.mean(target.steps)))), COARSE)
    part = target.until(steps) if steps < n else target
    explanations = _fits(part, _begun(part, scene, combos), FIRST_ROUNDS)
    if len(explanations) > MANY:
        explanations = explanations[:MANY]
    explanations = _further(part, explanations)
    while steps < n:
        steps *= STRETCH
        part = target.until(min(steps, n))
        explanations = _further(part, _leading(explanations))
    return explanations if part.same_steps(target) else _further(target, _leading(explanations))


def _further(target: Target, explanations: Sequence[Found]) -> list[Found]:
    return _fits(target, [(f.moves, f.fit.variant, f.fit.free) for f in explanations], ROUNDS)


def _fits(target: Target, starts: Sequence[Start], rounds: int) -> list[Found]:
    """Return the fits from some starts, the best first."""
    fits = [
        f
        for i in range(0, len(starts), CHUNK)
        for f in fit(target, [(v, free) for _, v, free in starts[i : i + CHUNK]], rounds)
    ]
    return sorted((Found(s[0], f) for s, f in zip(starts, fits, strict=True)), key=lambda f: f.fit.misfit)


def _begun(target: Target, scene: Variant, combos: Sequence[tuple[Move, ...]]) -> list[Start]:
    """Return the best two starts of every combination."""
    every = [(i, v) for i, combo in enumerate(combos) for v in _starts(scene, combo)]
    misfits: list[float] = []
    goal = target.values
    for i in range(0, len(every), CHUNK):
        answers = target.responses([v for _, v in every[i : i + CHUNK]])
        misfits += np.linalg.norm(answers - goal[:, None], axis=0).tolist()
    best: dict[int, list[tuple[float, Variant]]] = {}
    for (i, v), misfit in zip(every, misfits, strict=True):
        best.setdefault(i, []).append((misfit, v))
    chosen = []
    for i, misfits_of_starts in best.items():
        free = tuple(name for move in combos[i] for name in move.free)
        chosen += [(combos[i], v, free) for _, v in sorted(misfits_of_starts, key=lambda t: t[0])[: 2 if free else 1]]
    return chosen


def _starts(scene: Variant, combo: Sequence[Move]) -> list[Variant]:
    """Return the variants from which the fits of a combination may begin: one number at a time."""
    fixed = changed(scene, {name: value for move in combo for name, value in move.changes})
    if len(combo) == 1:
        (move,) = combo
        return [changed(fixed, {move.free[0]: value}) for value in move.starts] or [fixed]
    firsts = [changed(fixed, {move.free[0]: value}) for move in combo for value in move.starts]
    return [fixed, *firsts]


def _leading(explanations: Sequence[Found]) -> list[Found]:
    """Return the best few, of the same causes the best with the same free numbers."""
    leading: dict[tuple[tuple[str, ...], tuple[str, ...], bool], Found] = {}
    for f in explanations:
        if len({ids for ids, _, _ in leading} | {f.ids}) <= KEPT:
            leading.setdefault((f.ids, f.fit.free, f.fit.variant.reset), f)
    return list(leading.values())


def _period(target: Target) -> float:
    """Return the period of a mass on springs as soft as block and springs together [s]."""
    c = target.column
    mass = c.density * c.width * c.height
    return 2 * math.pi * math.sqrt(mass * abs(c.static) / abs(c.force or 1.0))
