"""The search for the fewest causes that explain a history: none, one, what surrounds a block, two.

Candidates are fitted many at once over the first few periods, where no fit goes astray; what comes near there is fitted
over more and more of the history. A cause counts only if nothing but digits and noise remains with it. Of several that
explain it, the one that the Bayesian information criterion prefers by a clear margin is named, or none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from validation.diagnosis.causes import CONTACT_METHODS, LISTED, benign_springs
from validation.diagnosis.fits.bar import MARGIN
from validation.diagnosis.fits.fit import Fit, changed, fit, fit_one
from validation.diagnosis.fits.target import Target
from validation.diagnosis.moves import FINE_BANDS, OPENING_TENSION, Move, dead_bands, moves
from validation.diagnosis.schemes import SHARED
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Variant

PERIODS = 5.0  # of the first mode, over which a fit does not go astray
SHORTEST, COARSE = 30, 500  # steps of the first fits
STRETCH = 5  # of the fitted part of a long history, from fit to fit
KEPT = 28  # candidates that are fitted over more of the history
FIRST_ROUNDS, ROUNDS = 5, 12  # of the fits: of all candidates, of those that are left
MANY = 140  # candidates that are fitted further

Start = tuple[tuple[Move, ...], Variant, tuple[str, ...]]  # causes, where their fit begins, its free numbers
CLEAR = 10.0  # of the information criterion: odds of 150 to 1
NEEDED = 14.0  # the same for a cause where noise alone would do: there are some forty to choose from
AROUND = 5e-5  # relative L2 that moving geometry and a base leave, which every program treats in its own way
AROUND_OPEN = 3e-4  # the same where the contact opens: each landing is late or early by what the base leaves
NEGLIGIBLE, NEGLIGIBLE_SHARE = 1e-6, 1e-3  # relative L2 that rounded constants leave, and share of the difference
WITHOUT_IT = 2.0  # times more that a fit leaves without what surrounds the block, if that is there at all
SHARE = 0.02  # of what is to be explained, at most, that they may leave
SURROUNDINGS = ("springs-factor", "own-weight", "geometry-updated")
FAULT = 3e-3  # relative L2 of a fault beside what surrounds a block: that is not known better than to 1e-3
RARE = 14.0  # of the information criterion: a thousand to one
ROUND = 3  # significant digits of a round number
EXACT = 1e-7  # relative error of a round number
LARGEST_EXPONENT = 7.0  # of a factor that is fitted by its logarithm
WITHOUT_BAND = (("contact-opened",), ("contact-locked",))
SWITCHING = (("dead-band",), (OPENING_TENSION,), ("late-opening",), ("late-contact",))
MOST_ALIKE = 5  # explanations that are told where the file cannot tell them apart
# share of the difference, at most, that noise may hide where one usual cause is named, one that is rare, or two: what
# is in no catalogue comes as near to one of them as that, but not nearer
HIDDEN, HIDDEN_RARE, HIDDEN_TWO, HIDDEN_SCHEME = 0.2, 0.03, 0.01, 0.003
SCHEMES = [  # causes that are a time scheme, in the order in which one of several names is chosen
    *("start", "velocity", "substeps", "leapfrog", "scheme", "generalised-alpha", "hht", "wbz", "theta", "composite"),
    *("symplectic-euler", "exact-in-time"),
]
COMPARED = 40  # explanations of which another one may be a special case
PROBES = (0.4, 1.0, 2.5)  # time steps over the history's, at which two names are seen to be one scheme
PROBED = 40  # steps of such a run
SAME_PROGRAM = 1e-8  # relative difference, of roundings
HIDDEN_FAMILY = 0.001  # the same for a scheme or a contact method of another kind: of these many are near to each other
LEAST_LANDINGS = 2  # of which the first gives any restitution, and the second says that it is one
OTHER_PROGRAMS = 1e-3  # of ntdda and its relatives, whose other habits stand beside it
RAYLEIGH = ("viscous-damping", "stiffness-damping")  # C = a0 M + a1 K, which programs have together
BASES = ((5.0, 1.0), (5.0, 1.25), (20.0, 1.0))  # mass of a base to begin with over the block's, change of softness


@dataclass(frozen=True, eq=False)
class Explanation:
    """Causes, with the fit that has them."""

    moves: tuple[Move, ...]
    fit: Fit

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the causes, each once."""
        return tuple(dict.fromkeys(move.id for move in self.moves))


# ---- fits -----------------------------------------------------------------------------------------------------------


def fitted(target: Target, scene: Variant, combos: Sequence[tuple[Move, ...]]) -> list[Explanation]:
    """Return combinations of causes at their best, the best first.

    A combination with free numbers begins at the two of its starts that come nearest.
    """
    n = len(target.steps)
    # of a mass on springs as soft as block and springs together
    c = target.column
    period = 2 * math.pi * math.sqrt(c.density * c.width * c.height * abs(c.static) / abs(c.force or 1.0))
    steps = min(max(SHORTEST, math.ceil(PERIODS * period / float(np.mean(target.steps)))), COARSE)
    part = target.until(steps) if steps < n else target
    explanations = _further(part, _fits(part, _begun(part, scene, combos), FIRST_ROUNDS)[:MANY])
    while steps < n:
        steps *= STRETCH
        part = target.until(min(steps, n))
        explanations = _further(part, _leading(explanations))
    is_whole = len(part.steps) == len(target.steps) and len(part.rows) == len(target.rows)
    return explanations if is_whole else _further(target, _leading(explanations))


def _further(target: Target, explanations: Sequence[Explanation]) -> list[Explanation]:
    return _fits(target, [(f.moves, f.fit.variant, f.fit.free) for f in explanations], ROUNDS)


def _fits(target: Target, starts: Sequence[Start], rounds: int) -> list[Explanation]:
    """Return the fits from some starts, the best first."""
    fits = fit(target, [(v, free) for _, v, free in starts], rounds)
    return sorted((Explanation(s[0], f) for s, f in zip(starts, fits, strict=True)), key=lambda f: f.fit.misfit)


def _begun(target: Target, scene: Variant, combos: Sequence[tuple[Move, ...]]) -> list[Start]:
    """Return the best two starts of every combination."""
    chosen = []
    starts = [_starts(scene, combo) for combo in combos]
    answers = target.responses([v for variants in starts for v in variants])
    misfits = iter(np.linalg.norm(answers - target.values[:, None], axis=0).tolist())
    for combo, variants in zip(combos, starts, strict=True):
        free = tuple(name for move in combo for name in move.free)
        ranked = sorted(((next(misfits), v) for v in variants), key=lambda t: t[0])
        chosen += [(combo, v, free) for _, v in ranked[: 2 if free else 1]]
    return chosen


def _starts(scene: Variant, combo: Sequence[Move]) -> list[Variant]:
    """Return the variants from which the fits of a combination may begin: one number at a time."""
    fixed = changed(scene, {name: value for move in combo for name, value in move.changes.items()})
    firsts = [changed(fixed, {move.free[0]: value}) for move in combo for value in move.starts]
    return firsts if firsts and len(combo) == 1 else [fixed, *firsts]


def _leading(explanations: Sequence[Explanation]) -> list[Explanation]:
    """Return the best few, of the same causes the best with the same free numbers."""
    leading: dict[tuple[tuple[str, ...], tuple[str, ...], bool], Explanation] = {}
    for f in explanations:
        if len({ids for ids, _, _ in leading} | {f.ids}) <= KEPT:
            leading.setdefault((f.ids, f.fit.free, f.fit.variant.reset), f)
    return list(leading.values())


@dataclass(frozen=True, eq=False)
class Verdict:
    """What the search came to."""

    scene_fit: Fit  # of the scene as it is
    best: Explanation  # what explains it, or comes nearest
    explained: bool
    alike: tuple[Explanation, ...] = ()  # others that explain it as well
    single: tuple[Explanation, ...] = ()  # every cause by itself, the best first
    around: float = 0.0  # relative L2 that what surrounds a block leaves [-]
    reached: bool = False  # something leaves digits and noise only, also where no cause is named
    aliases: tuple[Explanation, ...] = ()  # other names of the best one: one scheme at any time step

    @property
    def explains(self) -> bool:
        """Whether something leaves digits and noise only, named or not."""
        return self.explained or self.reached

    @property
    def same(self) -> bool:
        """Whether the scene as it is explains the history."""
        return self.explained and not self.best.moves

    @property
    def left(self) -> float:
        """Share of the difference that the best explanation leaves [-]."""
        return 0.0 if self.same else min(self.best.fit.misfit / max(self.scene_fit.misfit, 1e-300), 1.0)


# ---- the decision ---------------------------------------------------------------------------------------------------


def decided(target: Target, scene_fit: Fit, explanations: Sequence[Explanation]) -> Verdict:
    """Return the verdict over candidates, the scene as it is among them or not."""
    scores = {id(f): score(target, f.fit, f.moves) for f in explanations}
    ranked = sorted(explanations, key=lambda f: scores[id(f)])
    fine = [_with_effect(target, f) for f in ranked if accepted(target, scene_fit, f.fit) and _sensible(f)]
    scores |= {id(f): score(target, f.fit, f.moves) for f in fine}
    if not fine:
        return Verdict(
            scene_fit,
            min(explanations, key=lambda f: f.fit.misfit) if explanations else Explanation((), scene_fit),
            False,
        )
    fine = _without_special_cases(target, fine, scores)
    near = scores[id(fine[0])] + CLEAR
    close = _rounder([f for f in fine if scores[id(f)] < near])
    best = min((f for f in close if f.ids == close[0].ids), key=lambda f: len(f.fit.free))
    best = next((f for f in close if f.ids in WITHOUT_BAND), best)  # a dead band or a lag without effect
    # not the best one with a further part that has no effect
    others = [f for f in close if f.ids != best.ids and not set(best.ids) < set(f.ids)]
    alike = {f.ids: f for f in reversed(others) if best.ids not in WITHOUT_BAND or f.ids not in SWITCHING}
    best, aliases = _canonical(target, best, close)
    alike = {ids: f for ids, f in alike.items() if ids not in aliases}
    is_named = not alike and _nameable(target, scene_fit, best)
    if target.explained(scene_fit.residual) and not (
        is_named and score(target, scene_fit) - score(target, best.fit) >= NEEDED
    ):
        return Verdict(scene_fit, Explanation((), scene_fit), True, reached=True)
    names = tuple(f for ids, f in aliases.items() if ids != best.ids)
    return Verdict(scene_fit, best, is_named, tuple(alike.values())[:MOST_ALIKE], reached=True, aliases=names)


def _with_effect(target: Target, explanation: Explanation) -> Explanation:
    """Return a dead band that also opens beyond a gap as the tension that this is, where the closing has no effect."""
    v = explanation.fit.variant
    if explanation.ids != ("dead-band",) or v.reopening == 0:
        return explanation
    opening = {"hold": v.band * v.reopening, "band": 0.0, "reopening": 0.0}
    alone = fit_one(target, changed(v, opening))
    if alone.misfit > explanation.fit.misfit * (1 + SAME_PROGRAM) + target.floor:
        return explanation
    changes = {**explanation.moves[0].changes, **opening}
    return Explanation((Move(OPENING_TENSION, changes),), alone)


def _rounder(close: list[Explanation]) -> list[Explanation]:
    """Return explanations without those whose numbers are far less round: 1.2 and 1.2 before 0.833333 and 0.833333."""
    digits = [sum(_digits(getattr(f.fit.variant, name)) for name in f.fit.free) for f in close]
    if min(digits) > ROUND * max(len(close[0].fit.free), 1):
        return close
    return [f for f, d in zip(close, digits, strict=True) if d <= min(digits) + ROUND]


def _digits(value: float) -> int:
    """Return the significant digits that a fitted number or its exponential has, of what can be told."""
    forms = (value, math.exp(-value)) if abs(value) < LARGEST_EXPONENT else (value,)
    return min(next((d for d in range(1, 7) if abs(float(f"{x:.{d - 1}e}") - x) <= EXACT * abs(x)), 7) for x in forms)


def _without_special_cases(target: Target, fine: list[Explanation], scores: dict[int, float]) -> list[Explanation]:
    """Return explanations, the best first, without those whose number says no more than that another one holds.

    HHT at alpha_f = 1e-7 is average acceleration, and a dashpot of nothing the scene's own contact: where such a
    special case leaves hardly more, or what rounded constants leave, the further number is none.
    """
    plain = [f for f in fine[:COMPARED] if len(f.ids) < 2]
    kept = []
    for f in fine:
        simpler = [g for g in plain if len(g.fit.free) < len(f.fit.free)]
        simpler = [g for g in simpler if g.fit.misfit <= NEGLIGIBLE or scores[id(g)] < scores[id(f)] + CLEAR]
        if not any(same_program(target, v, g.fit.variant) for g in simpler for v in _special_cases(f, g)):
            kept.append(f)
    return kept


def _special_cases(explanation: Explanation, simpler: Explanation) -> list[Variant]:
    """Return what an explanation is at those values of its free numbers at which it may be a simpler one."""
    v = explanation.fit.variant
    if explanation.fit.free == ("alpha", "delta") and simpler.fit.variant.family == "newmark":
        return [replace(v, alpha=simpler.fit.variant.alpha, delta=simpler.fit.variant.delta)]
    if len(explanation.ids) > 1 or len(explanation.fit.free) > 1:
        return []
    if "dashpot" in explanation.fit.free:
        return [replace(v, dashpot=0.0)]
    if "spectral" in explanation.fit.free and v.contact in ("springs", "mean gap"):
        return [replace(v, spectral=number) for number in SHARED.get(v.family, ())]
    return []


def _canonical(
    target: Target, best: Explanation, close: Sequence[Explanation]
) -> tuple[Explanation, dict[tuple[str, ...], Explanation]]:
    """Return the explanation by whose name a scheme of several names is called, and all names of it.

    Two explanations are one scheme if they give the same rows at any time step, not only at this one.
    """
    aliases = {best.ids: best}
    if _scheme_alone(best) is None:
        return best, aliases
    for f in close:
        is_other = f.ids not in aliases and _scheme_alone(f) is not None and f.ids[1:] == best.ids[1:]
        if is_other and same_program(target, best.fit.variant, replace(f.fit.variant, gg=best.fit.variant.gg)):
            aliases[f.ids] = f
    return aliases[min(aliases, key=lambda ids: SCHEMES.index(ids[0]))], aliases


def _scheme_alone(explanation: Explanation) -> str | None:
    """Return the id of a time scheme with fixed numbers that explains by itself, or beside a discount, else None."""
    first, *others = explanation.ids or ("",)
    alone = first in SCHEMES and others in ([], ["gg"]) and set(explanation.fit.free) <= {"gg"}
    return first if alone else None


def same_program(target: Target, one: Variant, other: Variant) -> bool:
    """Whether two variants give the same rows at this and at other time steps."""
    for longer in PROBES:
        steps = np.full(PROBED, longer * float(target.steps[0]))
        run = histories(target.column, [one, other], steps).displacement
        with np.errstate(all="ignore"):
            apart = np.abs(run[:, 0] - run[:, 1])
            if not np.all(apart <= SAME_PROGRAM * np.max(np.abs(run), axis=1).max()):
                return False
    return True


def accepted(target: Target, scene_fit: Fit, candidate: Fit) -> bool:
    """Whether a fit leaves no more than it may: digits and noise, or next to nothing, or what a base does."""
    v = candidate.variant
    if target.explained(target.inner(candidate.residual, v)):
        return True
    if candidate is scene_fit or v == scene_fit.variant:
        return _is_negligible(target, candidate, NEGLIGIBLE)
    # rounded constants leave that much, and the passes of an augmented Lagrangian; of the other schemes and contact
    # methods some come as near to another one by chance
    is_usual = (v.family, v.contact) == (scene_fit.variant.family, scene_fit.variant.contact) or v.contact == "rigid"
    if is_usual and _is_negligible(target, candidate, min(NEGLIGIBLE, scene_fit.misfit * NEGLIGIBLE_SHARE)):
        return True
    noise = MARGIN * target.spread
    around = AROUND_OPEN if v.opens else AROUND
    loose = min(math.hypot(around, noise), SHARE * scene_fit.misfit)
    return candidate.misfit <= loose and _surrounded(target, candidate)


def _is_negligible(target: Target, candidate: Fit, least: float) -> bool:
    """Whether a fit leaves next to nothing, as rounded constants do, and no row by itself that is another one."""
    return candidate.misfit <= least and not target.has_lone_row(candidate.residual)


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
    return fit_one(target, without).misfit > WITHOUT_IT * candidate.misfit


def _nameable(target: Target, scene_fit: Fit, explanation: Explanation) -> bool:
    """Whether enough of the difference stands out of the noise for a cause to be named.

    Where noise hides a share of it, another cause that leaves less than that share would look the same.
    """
    if any(LISTED[name].outside for name in explanation.ids):
        return False
    if "restitution" in explanation.fit.free and _landings(target, explanation.fit.variant) < LEAST_LANDINGS:
        return False
    if not explanation.moves or target.within_digits(target.inner(explanation.fit.residual, explanation.fit.variant)):
        return True
    single = len(explanation.moves) == 1 and len(set(explanation.fit.free) - {"base"}) <= 1
    if explanation.ids == ("scheme",):  # any other integrator is near to some scheme
        return explanation.fit.misfit <= HIDDEN_SCHEME * scene_fit.misfit
    if any(LISTED[name].family or name in CONTACT_METHODS for name in explanation.ids):
        is_single = len(explanation.fit.free) < 2  # two free numbers come within noise of too much
        return is_single and explanation.fit.misfit <= HIDDEN_FAMILY * scene_fit.misfit
    usual = single and LISTED[explanation.ids[0]].usual
    limit = HIDDEN if usual else HIDDEN_RARE if single else HIDDEN_TWO
    return explanation.fit.misfit <= limit * scene_fit.misfit


def _landings(target: Target, v: Variant) -> int:
    """Return how often a contact that was open closes."""
    is_open = histories(target.column, [v], target.steps).open[:, 0]
    return int(np.sum(is_open[:-1] & ~is_open[1:]))


def _rare(move: Move, among: int) -> bool:
    """Whether people rarely make a cause; a factor on one column is one that they make by itself."""
    is_frequent = LISTED[move.id].usual or move.id in SURROUNDINGS
    return not is_frequent or (among > 1 and "displacement_factor" in move.free)


def _sensible(explanation: Explanation) -> bool:
    """Whether every cause is there in a measurable amount and within its bounds."""
    plain = Variant(0.5, 1.0, 1.0)
    for move in explanation.moves:
        for name in move.free:
            value = getattr(explanation.fit.variant, name)
            if name not in ("alpha", "delta", "gg", "spectral") and abs(value - getattr(plain, name)) < 1e-7:
                return False
    return True


def score(target: Target, candidate: Fit, moves: Sequence[Move] = ()) -> float:
    """Return the Bayesian information criterion of a fit, digits not counted below what was printed.

    A cause that people rarely make counts less than one that they make often.
    """
    n, rare = len(candidate.residual), sum(_rare(move, len(moves)) for move in moves)
    return 2 * n * math.log(max(candidate.misfit, target.floor)) + len(candidate.free) * math.log(n) + RARE * rare


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
    scene_fit = fit_one(target, scene)
    nothing = Explanation((), scene_fit)
    if target.within_digits(scene_fit.residual) or _is_negligible(target, scene_fit, NEGLIGIBLE):
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
    if target.spread > 3 * HIDDEN_TWO * before.scene_fit.misfit:
        return before  # noise hides too much for two causes to be told
    pairs: list[tuple[Move, ...]] = [pair for pair in combinations(few, 2) if _together(pair)]
    damping = tuple(move for move in moves(target, scene) if move.id in RAYLEIGH)
    pairs += [damping] if len(damping) == len(RAYLEIGH) else []
    verdict = decided(target, before.scene_fit, fitted(target, scene, pairs))
    if verdict.reached or before.around < FAULT:
        return min((verdict, before), key=lambda v: (not v.reached, v.best.fit.misfit))
    return _nearer(verdict, beside(target, scene, before))


def discounted(target: Target, scene: Variant, before: Verdict) -> Verdict:
    """Return what another time scheme explains beside another discount; else what was found before."""
    if before.reached or target.spread > 3 * HIDDEN_TWO * before.scene_fit.misfit:
        return before
    every = moves(target, scene)
    (discount,) = (move for move in every if move.id == "gg" and move.free)
    of_schemes = [move for move in every if move.id == "scheme" or LISTED[move.id].family]
    combos = [(move, discount) for move in of_schemes if len(move.free) < 2]
    verdict = decided(target, before.scene_fit, fitted(target, scene, combos))
    return verdict if verdict.reached else before  # whose single causes are tried in pairs next


def _nearer(*verdicts: Verdict) -> Verdict:
    """Return the verdict that explains more."""
    return min(verdicts, key=lambda v: (not v.explained, not v.reached, v.best.fit.misfit))


def beside(target: Target, scene: Variant, before: Verdict) -> Verdict:
    """Return what one cause explains beside what surrounds the block; else what was found before."""
    few = _few(target, scene, before.single)
    faults = [move for move in few if move.id not in SURROUNDINGS]
    around = tuple(_surroundings(target, scene))
    faults += [move for move in moves(target, scene) if move.changes.get("reopening") == OTHER_PROGRAMS]
    explanations = fitted(target, scene, [(move, *around) for move in faults if _together((move, *around))])
    explanations = [*explanations[:3], *_heavy(target, explanations[:3])]
    fine = [f for f in explanations if accepted(target, before.scene_fit, f.fit)]
    needed = [_without_excess(target, before.scene_fit, f) for f in fine]
    last = decided(target, before.scene_fit, needed or explanations)
    return _nearer(last, before)


def _around(target: Target, scene: Variant) -> list[Explanation]:
    """Return two or three of what surrounds a block: a softer base, weight, moving geometry."""
    parts = _surroundings(target, scene)
    combos = [tuple(parts[:1])] + [combo for size in (2, 3) for combo in combinations(parts, size)]
    explanations = fitted(target, scene, combos)
    soft = [f for f in explanations if len(f.moves) == 1]
    return sorted([*explanations, *_heavy(target, explanations[:2]), *_heavy(target, soft)], key=lambda f: f.fit.misfit)


def _surroundings(target: Target, scene: Variant) -> list[Move]:
    plain = {move.id: move for move in moves(target, scene) if move.id in SURROUNDINGS}
    plain["springs-factor"] = Move("springs-factor", {}, ("softness",), (0.0, 0.02))
    return [plain[name] for name in SURROUNDINGS]


def _heavy(target: Target, explanations: Sequence[Explanation]) -> list[Explanation]:
    """Return explanations by a softer base with a base that has mass."""
    more = []
    for f in explanations:
        v = f.fit.variant
        if v.softness > 0 and "softness" in f.fit.free:
            starts = [(replace(v, base=m, softness=v.softness * soft), (*f.fit.free, "base")) for m, soft in BASES]
            more += [Explanation(f.moves, heavy) for heavy in fit(target, starts, rounds=12)]
    return more


def _without_excess(target: Target, scene_fit: Fit, explanation: Explanation) -> Explanation:
    """Return an explanation without those of its surroundings that it does not need."""
    for move in [m for m in explanation.moves if m.id in SURROUNDINGS]:
        rest = tuple(m for m in explanation.moves if m is not move)
        plain = Variant(scene_fit.variant.alpha, scene_fit.variant.delta, scene_fit.variant.gg)
        names = [*move.changes, *move.free, *(["base"] if "softness" in move.free else [])]
        back = changed(explanation.fit.variant, {name: getattr(plain, name) for name in names})
        free = tuple(name for name in explanation.fit.free if name not in names)
        less = fit_one(target, back, free, rounds=12)
        fine = accepted(target, scene_fit, less) and less.misfit < max(2 * explanation.fit.misfit, AROUND / 10)
        if fine or score(target, less) <= score(target, explanation.fit):
            explanation = Explanation(rest, less)
    return explanation


def _few(target: Target, scene: Variant, single: Sequence[Explanation]) -> list[Move]:
    """Return the causes that are tried in pairs, each beginning at the scene or where it was best by itself."""
    few = []
    alone = {f.ids[0]: f.fit.variant for f in reversed(single)}
    for move in moves(target, scene):
        cause = LISTED[move.id]
        if cause.alone or cause.outside or move.free == ("alpha", "delta"):
            continue
        if move.id == "scheme" and move.changes.get("start", scene.start) != scene.start:
            continue  # two causes
        if move.id == "reported-point" and not move.free:
            continue
        starts = tuple(getattr(alone[move.id], name) for name in move.free if move.id in alone) or move.starts[:1]
        few.append(replace(move, starts=starts) if move.free else move)
    return few


def _together(combo: Sequence[Move]) -> bool:
    """Whether causes can be in one computation: different ones that change different things."""
    names = [name for move in combo for name in (*move.changes, *move.free)]
    ids = [move.id for move in combo]
    return len(set(names)) == len(names) and len(set(ids)) == len(ids)
