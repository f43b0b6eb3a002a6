"""Which of many explanations is named: the simplest that leaves digits and noise only, by a clear margin, or none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from validation.diagnosis.causes import LISTED, OUTSIDE, benign_springs
from validation.diagnosis.fits.bar import MARGIN
from validation.diagnosis.fits.fit import Fit, fit
from validation.diagnosis.fits.target import Target
from validation.diagnosis.fitting import Found
from validation.diagnosis.moves import Move
from validation.diagnosis.variant import Variant

CLEAR = 10.0  # of the information criterion: odds of 150 to 1
NEEDED = 14.0  # the same for a cause where noise alone would do: there are some forty to choose from
AROUND = 5e-5  # relative L2 that moving geometry and a base leave, which every program treats in its own way
AROUND_OPEN = 3e-4  # the same where the contact opens: each landing is late or early by what the base leaves
NEGLIGIBLE, NEGLIGIBLE_SHARE = 1e-6, 1e-3  # relative L2 that rounded constants leave, and share of the difference
SEEN = 2.0  # times more that a fit leaves without what surrounds the block, if that is there at all
SHARE = 0.02  # of what is to be explained, at most, that they may leave
SURROUNDINGS = ("springs-factor", "own-weight", "geometry-updated")
FAULT = 3e-3  # relative L2 of a fault beside what surrounds a block: that is not known better than to 1e-3
RARE = 14.0  # of the information criterion: a thousand to one
ROUND = 3  # significant digits of a round number
EXACT = 1e-7  # relative error of a round number
LARGEST_EXPONENT = 7.0  # of a factor that is fitted by its logarithm
WITHOUT_BAND = (("contact-opened",), ("contact-locked",))
MOST_ALIKE = 5  # explanations that are told where the file cannot tell them apart
# share of the difference, at most, that noise may hide where one usual cause is named, one that is rare, or two: what
# is in no catalogue comes as near to one of them as that, but not nearer
HIDDEN, HIDDEN_RARE, HIDDEN_TWO, HIDDEN_SCHEME = 0.2, 0.03, 0.01, 0.003
USUAL = (
    *("density-factor", "young-factor", "springs-factor", "load-factor", "own-weight", "contact-opened", "start"),
    *("viscous-damping", "gravity-factor"),
    *("gg", "gg-in-one-formula", "scheme", "time-shift", "pressure-shift", "pressure-factor", "reported-point"),
)


@dataclass(frozen=True, eq=False)
class Verdict:
    """What the search came to."""

    own: Fit  # of the scene as it is
    best: Found  # what explains it, or comes nearest
    explained: bool
    alike: tuple[Found, ...] = ()  # others that explain it as well
    single: tuple[Found, ...] = ()  # every cause by itself, the best first
    around: float = 0.0  # relative L2 that what surrounds a block leaves [-]
    reached: bool = False  # something leaves digits and noise only, also where no cause is named

    @property
    def same(self) -> bool:
        """Whether the scene as it is explains the history."""
        return self.explained and not self.best.moves

    @property
    def left(self) -> float:
        """Share of the difference that the best explanation leaves [-]."""
        return 0.0 if self.same else min(self.best.fit.misfit / max(self.own.misfit, 1e-300), 1.0)


# ---- the decision ---------------------------------------------------------------------------------------------------


def decided(target: Target, scene_fit: Fit, explanations: Sequence[Found]) -> Verdict:
    """Return the verdict over candidates, the scene as it is among them or not."""
    scores = {id(f): score(target, f.fit, f.moves) for f in explanations}
    ranked = sorted(explanations, key=lambda f: scores[id(f)])
    fine = [f for f in ranked if accepted(target, scene_fit, f.fit) and _sensible(f)]
    if not fine:
        return Verdict(
            scene_fit, min(explanations, key=lambda f: f.fit.misfit) if explanations else Found((), scene_fit), False
        )
    near = scores[id(fine[0])] + CLEAR
    close = _rounder([f for f in fine if scores[id(f)] < near])
    best = min((f for f in close if f.ids == close[0].ids), key=lambda f: len(f.fit.free))
    best = next((f for f in close if f.ids in WITHOUT_BAND), best)  # a dead band without effect
    alike = {f.ids: f for f in reversed(close) if f.ids != best.ids and not _contained(best, f)}
    is_named = not alike and _nameable(target, scene_fit, best)
    if target.explained(scene_fit.residual) and not (
        is_named and score(target, scene_fit) - score(target, best.fit) >= NEEDED
    ):
        return Verdict(scene_fit, Found((), scene_fit), True)
    return Verdict(scene_fit, best, is_named, tuple(alike.values())[:MOST_ALIKE], reached=True)


def _rounder(close: list[Found]) -> list[Found]:
    """Return explanations without those whose numbers are far less round: 1.2 and 1.2 before 0.833333 and 0.833333."""
    digits = [sum(_digits(getattr(f.fit.variant, name)) for name in f.fit.free) for f in close]
    if min(digits) > ROUND * max(len(close[0].fit.free), 1):
        return close
    return [f for f, d in zip(close, digits, strict=True) if d <= min(digits) + ROUND]


def _digits(value: float) -> int:
    """Return the significant digits that a fitted number or its exponential has, of what can be told."""
    forms = (value, math.exp(-value)) if abs(value) < LARGEST_EXPONENT else (value,)
    return min(next((d for d in range(1, 7) if abs(float(f"{x:.{d - 1}e}") - x) <= EXACT * abs(x)), 7) for x in forms)


def _contained(best: Found, other: Found) -> bool:
    """Whether an explanation is the best one with a further part that has no effect."""
    return set(best.ids) < set(other.ids) or (best.ids in WITHOUT_BAND and other.ids == ("dead-band",))


def accepted(target: Target, scene_fit: Fit, candidate: Fit) -> bool:
    """Whether a fit leaves no more than it may: digits and noise, or next to nothing, or what a base does."""
    v = candidate.variant
    if target.explained(target.inner(candidate.residual, v)):
        return True
    if candidate is scene_fit or v == scene_fit.variant:
        return candidate.misfit <= NEGLIGIBLE
    if candidate.misfit <= min(NEGLIGIBLE, scene_fit.misfit * NEGLIGIBLE_SHARE):
        return True
    noise = MARGIN * target.spread
    around = AROUND_OPEN if v.opens else AROUND
    loose = min(math.hypot(around, noise), SHARE * scene_fit.misfit)
    return candidate.misfit <= loose and _surrounded(target, candidate)


def _surrounded(target: Target, candidate: Fit) -> bool:
    """Whether moving geometry or a base is seen in a history: without it the same fit leaves much more.

    What surrounds a block is treated differently by every program, so that some of it may be left; a base of 1e-6 or
    a geometry that makes no difference has explained nothing, and excuses nothing.
    """
    v = candidate.variant
    base = v.base > 0 or (v.softness > 0 and benign_springs(target.column, v))
    if not (v.updated or base):
        return False
    without = replace(v, updated=False, base=0.0, softness=0.0 if base else v.softness)
    return fit(target, [(without, ())])[0].misfit > SEEN * candidate.misfit


def _nameable(target: Target, scene_fit: Fit, explanation: Found) -> bool:
    """Whether enough of the difference stands out of the noise for a cause to be named.

    Where noise hides a share of it, another cause that leaves less than that share would look the same.
    """
    if any(name in OUTSIDE for name in explanation.ids):
        return False
    if not explanation.moves or target.within_digits(target.inner(explanation.fit.residual, explanation.fit.variant)):
        return True
    single = len(explanation.moves) == 1 and len(set(explanation.fit.free) - {"base"}) <= 1
    if explanation.ids == ("scheme",):  # any other integrator is near to some scheme
        return explanation.fit.misfit <= HIDDEN_SCHEME * scene_fit.misfit
    usual = single and explanation.ids[0] in USUAL
    limit = HIDDEN if usual else HIDDEN_RARE if single else HIDDEN_TWO
    return explanation.fit.misfit <= limit * scene_fit.misfit


def _rare(move: Move, among: int) -> bool:
    """Whether people rarely make a cause; a factor on one column is one that they make by itself."""
    return move.id not in (*USUAL, *SURROUNDINGS) or (among > 1 and "displacement_factor" in move.free)


def _sensible(explanation: Found) -> bool:
    """Whether every cause is there in a measurable amount and within its bounds."""
    plain = Variant(0.5, 1.0, 1.0)
    for move in explanation.moves:
        for name in move.free:
            value = getattr(explanation.fit.variant, name)
            if name not in ("alpha", "delta", "gg", "spectral") and abs(value - getattr(plain, name)) < 1e-7:
                return False
    return all(name in LISTED for name in explanation.ids)


def score(target: Target, candidate: Fit, moves: Sequence[Move] = ()) -> float:
    """Return the Bayesian information criterion of a fit, digits not counted below what was printed.

    A cause that people rarely make counts less than one that they make often.
    """
    n, rare = len(candidate.residual), sum(_rare(move, len(moves)) for move in moves)
    return 2 * n * math.log(max(candidate.misfit, target.floor)) + len(candidate.free) * math.log(n) + RARE * rare
