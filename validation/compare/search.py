"""The search for the fewest causes that explain a history: none, one, what surrounds a block, two.

A cause counts only if nothing but digits and noise remains with it. Every candidate is fitted over the first few
periods, where no fit goes astray, then over more and more of the history. Of several that explain it, the one that
the Bayesian information criterion prefers by a clear margin is named; without that margin none is.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from dda.one_block.variants import Variant
from validation.compare.causes import CAUSES, OUTSIDE, Move, benign_springs, moves
from validation.compare.fits.bar import MARGIN
from validation.compare.fits.fit import Fit, changed, fit
from validation.compare.fits.target import Target

PERIODS = 5.0  # of the first mode, over which a fit does not go astray
SHORTEST, COARSE = 30, 500  # steps of the first fits
STRETCH = 5  # of the fitted part of a long history, from fit to fit
KEPT = 16  # candidates that are fitted over more of the history
CLEAR = 10.0  # of the information criterion: odds of 150 to 1
NEEDED = 14.0  # the same for a cause where noise alone would do: there are some forty to choose from
AROUND = 5e-5  # relative L2 that moving geometry and a base leave, which every program treats in its own way
# share of the difference, at most, that noise may hide where one usual cause is named, one that is rare, or two: what
# is in no catalogue comes as near to one of them as that, but not nearer
HIDDEN, HIDDEN_RARE, HIDDEN_TWO = 0.2, 0.03, 0.01
USUAL = (
    *("density-factor", "young-factor", "springs-factor", "load-factor", "own-weight", "contact-opened", "start"),
    *("gg", "gg-in-one-formula", "scheme", "time-shift", "pressure-shift", "pressure-factor", "reported-point"),
)
RARE = 14.0  # of the information criterion: a thousand to one
ROUND, EXACT, LARGEST_EXPONENT = (
    3,
    1e-7,
    7.0,
)  # significant digits of a round number, its relative error, ln of a factor
MOST_ALIKE = 5  # explanations that are told where the file cannot tell them apart
NEGLIGIBLE, NEGLIGIBLE_SHARE = 1e-6, 1e-3  # relative L2 that rounded constants leave, and share of the difference
SHARE = 0.02  # of what is to be explained, at most, that they may leave
SURROUNDINGS = ("springs-factor", "own-weight", "geometry-updated")
BASES = ((5.0, 1.0), (5.0, 1.25), (20.0, 1.0))  # mass of a base to begin with over the block's, change of softness
CHUNK = 1500  # variants in one pass


@dataclass(frozen=True, eq=False)
class Found:
    """Causes, with the fit that has them."""

    moves: tuple[Move, ...]
    fit: Fit

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the causes, each once."""
        return tuple(dict.fromkeys(move.id for move in self.moves))


@dataclass(frozen=True, eq=False)
class Verdict:
    """What the search came to."""

    own: Fit  # of the scene as it is
    best: Found  # what explains it, or comes nearest
    explained: bool
    alike: tuple[Found, ...] = ()  # others that explain it as well

    @property
    def same(self) -> bool:
        """Whether the scene as it is explains the history."""
        return self.explained and not self.best.moves

    @property
    def left(self) -> float:
        """Share of the difference that the best explanation leaves [-]."""
        return 0.0 if self.same else min(self.best.fit.misfit / max(self.own.misfit, 1e-300), 1.0)


# ---- the search -----------------------------------------------------------------------------------------------------


def simple(target: Target, scene: Variant) -> Verdict:
    """Return what none, one cause, or what surrounds a block explains.

    Parameters
    ----------
    target
        The history.
    scene
        The scene's own scheme, nothing added.
    """
    own = fit(target, [(scene, ())])[0]
    nothing = Found((), own)
    if target.within_digits(own.residual) or own.misfit <= NEGLIGIBLE:
        return Verdict(own, nothing, True)
    single = fitted(target, scene, [(move,) for move in moves(target, scene)])
    verdict = _decided(target, own, [nothing, *single])
    if verdict.explained:
        return verdict
    around = _decided(target, own, _around(target, scene))
    return around if around.explained or around.best.fit.misfit < verdict.best.fit.misfit else verdict


def paired(target: Target, scene: Variant, before: Verdict) -> Verdict:
    """Return what two causes explain, or one beside what surrounds the block; else what was found before."""
    few = _few(target, scene)
    if target.spread > 3 * HIDDEN_TWO * before.own.misfit:
        return before  # noise hides too much for two causes to be told
    pairs = [pair for pair in combinations(few, 2) if _together(pair)]
    verdict = _decided(target, before.own, fitted(target, scene, pairs))
    if verdict.explained:
        return verdict
    faults = [move for move in few if move.id not in SURROUNDINGS]
    around = tuple(_surroundings(target, scene))
    beside = fitted(target, scene, [(move, *around) for move in faults if _together((move, *around))])
    beside = [*beside[:3], *_heavy(target, beside[:3])]
    fine = [f for f in beside if _accepted(target, before.own, f.fit)]
    last = _decided(target, before.own, [_without_excess(target, before.own, f) for f in fine] or beside)
    return min((last, verdict, before), key=lambda v: (not v.explained, v.best.fit.misfit))


def _around(target: Target, scene: Variant) -> list[Found]:
    """Return two or three of what surrounds a block: a softer base, weight, moving geometry."""
    parts = _surroundings(target, scene)
    combos = [tuple(parts[:1])] + [combo for size in (2, 3) for combo in combinations(parts, size)]
    found = fitted(target, scene, combos)
    soft = [f for f in found if len(f.moves) == 1]
    return sorted([*found, *_heavy(target, found[:2]), *_heavy(target, soft)], key=lambda f: f.fit.misfit)


def _surroundings(target: Target, scene: Variant) -> list[Move]:
    plain = {move.id: move for move in moves(target, scene) if move.id in SURROUNDINGS}
    plain["springs-factor"] = Move("springs-factor", (), ("softness",), (0.0, 0.02))
    return [plain[name] for name in SURROUNDINGS]


def _heavy(target: Target, found: Sequence[Found]) -> list[Found]:
    """Return explanations by a softer base with a base that has mass."""
    more = []
    for f in found:
        v = f.fit.variant
        if v.softness > 0 and "softness" in f.fit.free:
            starts = [(replace(v, base=m, softness=v.softness * soft), (*f.fit.free, "base")) for m, soft in BASES]
            more += [Found(f.moves, heavy) for heavy in fit(target, starts, rounds=12)]
    return more


def _without_excess(target: Target, own: Fit, found: Found) -> Found:
    """Return an explanation without those of its surroundings that it does not need."""
    for move in [m for m in found.moves if m.id in SURROUNDINGS]:
        rest = tuple(m for m in found.moves if m is not move)
        plain = Variant(own.variant.alpha, own.variant.delta, own.variant.gg)
        names = [name for name, _ in move.changes] + list(move.free) + (["base"] if "softness" in move.free else [])
        back = changed(found.fit.variant, {name: getattr(plain, name) for name in names})
        free = tuple(name for name in found.fit.free if name not in names)
        (less,) = fit(target, [(back, free)], rounds=12)
        fine = _accepted(target, own, less) and less.misfit < max(2 * found.fit.misfit, AROUND / 10)
        if fine or _score(target, less) <= _score(target, found.fit):
            found = Found(rest, less)
    return found


# ---- fits -----------------------------------------------------------------------------------------------------------


def fitted(target: Target, scene: Variant, combos: Sequence[tuple[Move, ...]]) -> list[Found]:
    """Return combinations of causes at their best, the best first.

    A combination with free numbers begins at the two of its starts that come nearest.
    """
    n = len(target.steps)
    steps = min(max(SHORTEST, math.ceil(PERIODS * _period(target) / float(np.mean(target.steps)))), COARSE)
    part = target.until(steps).quick() if steps < n else target.quick()
    begun = _begun(part, scene, combos)
    found = _fits(part, [(combo, v, free) for combo, v, free in begun])
    while steps < n:
        steps *= STRETCH
        part = target.until(min(steps, n)).quick()
        found = _fits(part, [(f.moves, f.fit.variant, f.fit.free) for f in _leading(found)])
    return _fits(target, [(f.moves, f.fit.variant, f.fit.free) for f in _leading(found)])


def _fits(target: Target, starts: Iterable[tuple[tuple[Move, ...], Variant, tuple[str, ...]]]) -> list[Found]:
    starts = list(starts)
    fits = [
        f
        for i in range(0, len(starts), CHUNK)
        for f in fit(target, [(v, free) for _, v, free in starts[i : i + CHUNK]], rounds=12)
    ]
    return sorted((Found(s[0], f) for s, f in zip(starts, fits, strict=True)), key=lambda f: f.fit.misfit)


def _begun(
    target: Target, scene: Variant, combos: Sequence[tuple[Move, ...]]
) -> list[tuple[tuple[Move, ...], Variant, tuple[str, ...]]]:
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
    for i, tried in best.items():
        free = tuple(name for move in combos[i] for name in move.free)
        chosen += [(combos[i], v, free) for _, v in sorted(tried, key=lambda t: t[0])[: 2 if free else 1]]
    return chosen


def _starts(scene: Variant, combo: Sequence[Move]) -> list[Variant]:
    """Return the variants from which the fits of a combination may begin: one number at a time."""
    fixed = changed(scene, {name: value for move in combo for name, value in move.changes})
    if len(combo) == 1:
        (move,) = combo
        return [changed(fixed, {move.free[0]: value}) for value in move.starts] or [fixed]
    firsts = [changed(fixed, {move.free[0]: value}) for move in combo for value in move.starts]
    return [fixed, *firsts]


def _leading(found: Sequence[Found]) -> list[Found]:
    """Return the best few, of the same causes the best with the same free numbers."""
    kept: dict[tuple[tuple[str, ...], tuple[str, ...]], Found] = {}
    for f in found:
        if len({ids for ids, _ in kept} | {f.ids}) <= KEPT:
            kept.setdefault((f.ids, f.fit.free), f)
    return list(kept.values())


def _period(target: Target) -> float:
    """Return the period of a mass on springs as soft as block and springs together [s]."""
    c = target.column
    mass = c.density * c.width * c.height
    return 2 * math.pi * math.sqrt(mass * abs(c.static) / abs(c.force or 1.0))


def _few(target: Target, scene: Variant) -> list[Move]:
    """Return the causes that are tried in pairs, each beginning near the scene or at a few of its numbers."""
    few = []
    for move in moves(target, scene):
        if move.id == "dead-band" or move.id in OUTSIDE or move.free == ("alpha", "delta"):
            continue
        if move.id == "reported-point" and not move.free:
            continue
        few.append(replace(move, starts=move.starts[:: max(1, len(move.starts) // 6)]) if move.free else move)
    return few


def _together(combo: Sequence[Move]) -> bool:
    """Whether causes can be in one computation: different ones that change different things."""
    names = [name for move in combo for name in [*(name for name, _ in move.changes), *move.free]]
    ids = [move.id for move in combo]
    return len(set(names)) == len(names) and len(set(ids)) == len(ids)


# ---- the decision ---------------------------------------------------------------------------------------------------


def _decided(target: Target, own: Fit, found: Sequence[Found]) -> Verdict:
    """Return the verdict over candidates, the scene as it is among them or not."""
    scores = {id(f): _score(target, f.fit, f.ids) for f in found}
    ranked = sorted(found, key=lambda f: scores[id(f)])
    accepted = [f for f in ranked if _accepted(target, own, f.fit) and _sensible(f)]
    if not accepted:
        return Verdict(own, min(found, key=lambda f: f.fit.misfit) if found else Found((), own), False)
    near = scores[id(accepted[0])] + CLEAR
    close = _rounder([f for f in accepted if scores[id(f)] < near])
    best = min((f for f in close if f.ids == close[0].ids), key=lambda f: len(f.fit.free))
    best = next((f for f in close if f.ids == ("contact-opened",)), best)  # a dead band without effect
    alike = {f.ids: f for f in reversed(close) if f.ids != best.ids and not _contained(best, f)}
    named = not alike and _nameable(target, own, best)
    if target.explained(own.residual) and not (named and _score(target, own) - _score(target, best.fit) >= NEEDED):
        return Verdict(own, Found((), own), True)
    return Verdict(own, best, named, tuple(alike.values())[:MOST_ALIKE])


def _rounder(close: list[Found]) -> list[Found]:
    """Return explanations without those whose numbers are far less round: 1.2 and 1.2 before 0.833333 and 0.833333."""
    digits = [sum(_digits(getattr(f.fit.variant, name)) for name in f.fit.free) for f in close]
    if min(digits) > ROUND * max(len(close[0].fit.free), 1):
        return close
    return [f for f, d in zip(close, digits, strict=True) if d <= min(digits) + ROUND]


def _digits(value: float) -> int:
    """Return the significant digits that a fitted number or its exponential has, of what can be told."""
    told = (value, math.exp(-value)) if abs(value) < LARGEST_EXPONENT else (value,)
    return min(next((d for d in range(1, 7) if abs(float(f"{x:.{d - 1}e}") - x) <= EXACT * abs(x)), 7) for x in told)


def _contained(best: Found, other: Found) -> bool:
    """Whether an explanation is the best one with a further part that has no effect."""
    return set(best.ids) < set(other.ids) or (best.ids == ("contact-opened",) and other.ids == ("dead-band",))


def _accepted(target: Target, own: Fit, found: Fit) -> bool:
    """Whether a fit leaves no more than it may: digits and noise, or next to nothing, or what a base does."""
    v = found.variant
    if target.explained(target.inner(found.residual, v)):
        return True
    if found is own or v == own.variant:
        return found.misfit <= NEGLIGIBLE
    if found.misfit <= min(NEGLIGIBLE, own.misfit * NEGLIGIBLE_SHARE):
        return True
    noise = MARGIN * target.spread
    around = v.updated or v.base > 0 or (v.softness > 0 and benign_springs(target, v))
    return around and found.misfit <= min(math.hypot(AROUND, noise), SHARE * own.misfit)


def _nameable(target: Target, own: Fit, found: Found) -> bool:
    """Whether enough of the difference stands out of the noise for a cause to be named.

    Where noise hides a share of it, another cause that leaves less than that share would look the same.
    """
    if any(name in OUTSIDE for name in found.ids):
        return False
    if not found.moves or target.within_digits(target.inner(found.fit.residual, found.fit.variant)):
        return True
    single = len(found.moves) == 1 and len(set(found.fit.free) - {"base"}) <= 1
    usual = single and found.ids[0] in USUAL
    limit = HIDDEN if usual else HIDDEN_RARE if single else HIDDEN_TWO
    return found.fit.misfit <= limit * own.misfit


def _sensible(found: Found) -> bool:
    """Whether every cause is there in a measurable amount and within its bounds."""
    plain = Variant(0.5, 1.0, 1.0)
    for move in found.moves:
        for name in move.free:
            value = getattr(found.fit.variant, name)
            if name not in ("alpha", "delta", "gg") and abs(value - getattr(plain, name)) < 1e-7:
                return False
    return all(name in CAUSES or name in OUTSIDE for name in found.ids)


def _score(target: Target, found: Fit, ids: Sequence[str] = ()) -> float:
    """Return the Bayesian information criterion of a fit, digits not counted below what was printed.

    A cause that people rarely make counts less than one that they make often.
    """
    n, rare = len(found.residual), sum(name not in (*USUAL, *SURROUNDINGS) for name in ids)
    return 2 * n * math.log(max(found.misfit, target.floor)) + len(found.free) * math.log(n) + RARE * rare
