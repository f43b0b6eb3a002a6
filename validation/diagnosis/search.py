"""The search for the fewest causes that explain a history: none, one, what surrounds a block, two.

A cause counts only if nothing but digits and noise remains with it. Every candidate is fitted over the first few
periods, where no fit goes astray, then over more and more of the history. Of several that explain it, the one that
the Bayesian information criterion prefers by a clear margin is named; without that margin none is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

from validation.diagnosis.causes import OUTSIDE
from validation.diagnosis.decision import (
    AROUND,
    FAULT,
    HIDDEN_TWO,
    NEGLIGIBLE,
    SURROUNDINGS,
    Verdict,
    accepted,
    decided,
    score,
)
from validation.diagnosis.fits.fit import Fit, changed, fit
from validation.diagnosis.fits.target import Target
from validation.diagnosis.fitting import Found, fitted
from validation.diagnosis.moves import FINE_BANDS, Move, dead_bands, moves
from validation.diagnosis.variant import Variant

OTHER_PROGRAMS = ("reopening", 1e-3)  # of ntdda and its relatives, whose other habits stand beside it
# tried by themselves only: beside another cause they are rare, and the pairs grow with the square of what is tried
SINGLE = (
    *("dead-band", "hht", "generalised-alpha", "substeps", "exact-in-time", "velocity", "stiffness-damping"),
    *("load-ramp", "inertia", "one-spring"),
)
RAYLEIGH = ("viscous-damping", "stiffness-damping")  # C = a0 M + a1 K, which programs have together
BASES = ((5.0, 1.0), (5.0, 1.25), (20.0, 1.0))  # mass of a base to begin with over the block's, change of softness


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
    scene_fit = fit(target, [(scene, ())])[0]
    nothing = Found((), scene_fit)
    if target.within_digits(scene_fit.residual) or scene_fit.misfit <= NEGLIGIBLE:
        return Verdict(scene_fit, nothing, True)
    single = fitted(target, scene, [(move,) for move in moves(target, scene)])
    verdict = decided(target, scene_fit, [nothing, *single])
    if not verdict.reached:
        single += fitted(target, scene, [(move,) for move in dead_bands(target, scene, FINE_BANDS)])
        single.sort(key=lambda f: f.fit.misfit)
        verdict = decided(target, scene_fit, [nothing, *single])
    if verdict.reached:
        return verdict
    around = decided(target, scene_fit, _around(target, scene))
    better = around.reached or around.best.fit.misfit < verdict.best.fit.misfit
    misfit = around.best.fit.misfit
    return replace(around if better else verdict, single=tuple(single), around=misfit)


def paired(target: Target, scene: Variant, before: Verdict) -> Verdict:
    """Return what two causes explain, or one beside what surrounds the block; else what was found before."""
    few = _few(target, scene, before.single)
    if before.reached:
        return before  # one cause would do
    if target.spread > 3 * HIDDEN_TWO * before.own.misfit:
        return before  # noise hides too much for two causes to be told
    pairs: list[tuple[Move, ...]] = [pair for pair in combinations(few, 2) if _together(pair)]
    damping = tuple(move for move in moves(target, scene) if move.id in RAYLEIGH)
    pairs += [damping] if len(damping) == len(RAYLEIGH) else []
    verdict = decided(target, before.own, fitted(target, scene, pairs))
    if verdict.reached or before.around < FAULT:
        return min((verdict, before), key=lambda v: (not v.reached, v.best.fit.misfit))
    return _nearer(verdict, beside(target, scene, before))


def _nearer(*verdicts: Verdict) -> Verdict:
    """Return the verdict that explains more."""
    return min(verdicts, key=lambda v: (not v.explained, not v.reached, v.best.fit.misfit))


def beside(target: Target, scene: Variant, before: Verdict) -> Verdict:
    """Return what one cause explains beside what surrounds the block; else what was found before."""
    few = _few(target, scene, before.single)
    faults = [move for move in few if move.id not in SURROUNDINGS]
    around = tuple(_surroundings(target, scene))
    faults += [move for move in moves(target, scene) if move.id == "dead-band" and OTHER_PROGRAMS in move.changes]
    explanations = fitted(target, scene, [(move, *around) for move in faults if _together((move, *around))])
    explanations = [*explanations[:3], *_heavy(target, explanations[:3])]
    fine = [f for f in explanations if accepted(target, before.own, f.fit)]
    last = decided(target, before.own, [_without_excess(target, before.own, f) for f in fine] or explanations)
    return _nearer(last, before)


def _around(target: Target, scene: Variant) -> list[Found]:
    """Return two or three of what surrounds a block: a softer base, weight, moving geometry."""
    parts = _surroundings(target, scene)
    combos = [tuple(parts[:1])] + [combo for size in (2, 3) for combo in combinations(parts, size)]
    explanations = fitted(target, scene, combos)
    soft = [f for f in explanations if len(f.moves) == 1]
    return sorted([*explanations, *_heavy(target, explanations[:2]), *_heavy(target, soft)], key=lambda f: f.fit.misfit)


def _surroundings(target: Target, scene: Variant) -> list[Move]:
    plain = {move.id: move for move in moves(target, scene) if move.id in SURROUNDINGS}
    plain["springs-factor"] = Move("springs-factor", (), ("softness",), (0.0, 0.02))
    return [plain[name] for name in SURROUNDINGS]


def _heavy(target: Target, explanations: Sequence[Found]) -> list[Found]:
    """Return explanations by a softer base with a base that has mass."""
    more = []
    for f in explanations:
        v = f.fit.variant
        if v.softness > 0 and "softness" in f.fit.free:
            starts = [(replace(v, base=m, softness=v.softness * soft), (*f.fit.free, "base")) for m, soft in BASES]
            more += [Found(f.moves, heavy) for heavy in fit(target, starts, rounds=12)]
    return more


def _without_excess(target: Target, scene_fit: Fit, explanation: Found) -> Found:
    """Return an explanation without those of its surroundings that it does not need."""
    for move in [m for m in explanation.moves if m.id in SURROUNDINGS]:
        rest = tuple(m for m in explanation.moves if m is not move)
        plain = Variant(scene_fit.variant.alpha, scene_fit.variant.delta, scene_fit.variant.gg)
        names = [name for name, _ in move.changes] + list(move.free) + (["base"] if "softness" in move.free else [])
        back = changed(explanation.fit.variant, {name: getattr(plain, name) for name in names})
        free = tuple(name for name in explanation.fit.free if name not in names)
        (less,) = fit(target, [(back, free)], rounds=12)
        fine = accepted(target, scene_fit, less) and less.misfit < max(2 * explanation.fit.misfit, AROUND / 10)
        if fine or score(target, less) <= score(target, explanation.fit):
            explanation = Found(rest, less)
    return explanation


def _few(target: Target, scene: Variant, single: Sequence[Found]) -> list[Move]:
    """Return the causes that are tried in pairs, each beginning at the scene or where it was best by itself."""
    few = []
    alone = {f.ids[0]: f.fit.variant for f in reversed(single)}
    for move in moves(target, scene):
        if move.id in SINGLE or move.id in OUTSIDE or move.free == ("alpha", "delta"):
            continue
        if move.id == "reported-point" and not move.free:
            continue
        starts = tuple(getattr(alone[move.id], name) for name in move.free if move.id in alone) or move.starts[:1]
        few.append(replace(move, starts=starts) if move.free else move)
    return few


def _together(combo: Sequence[Move]) -> bool:
    """Whether causes can be in one computation: different ones that change different things."""
    names = [name for move in combo for name in [*(name for name, _ in move.changes), *move.free]]
    ids = [move.id for move in combo]
    return len(set(names)) == len(names) and len(set(ids)) == len(ids)
