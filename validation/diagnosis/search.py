"""The search for the fewest changes that explain a history, and the one decision over what explains it.

Candidates are fitted many at once over the first few periods, where no fit goes astray; what comes near is fitted over
more and more of the history. A change explains a history if nothing but digits and noise remains with it
(`validation.diagnosis.fits.bar`). The scene as it is comes first, then one change, then what surrounds a block, then
two. Of those that explain, the one with the least Bayesian information criterion

    n ln chi^2 + k ln n + 14 r

is named, chi^2 the mean square over the variances of n rows, at least 1, k the free numbers and r the changes that
people rarely make: if no other is within 10 of it, and if the scene leaves ten times more for every change and every
further number. What runs the same program by another name is no other one; a number that the rows do not determine is
none.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from validation.diagnosis.causes import BAND_FIELDS, CAUSES, CONTACT_METHODS, benign_springs
from validation.diagnosis.constants import (
    ARITHMETIC,
    CLEARLY,
    FIRST_ROUNDS,
    MOST_ALIKE,
    ROUNDS,
    SEEN,
    SLIGHT,
    TWICE,
    WINDOW,
)
from validation.diagnosis.fits.bar import LONGEST
from validation.diagnosis.fits.fit import Fit, changed, fit, fit_one, intervals, is_factor
from validation.diagnosis.fits.target import Target
from validation.diagnosis.moves import FINE_BANDS, OF_NTDDA, Move, dead_bands, moves
from validation.diagnosis.schemes import SHARED
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Variant
from validation.metrics.contact import AGREED
from validation.runs.history import Array

PERIODS = 5.0  # of the first mode, over which a fit does not go astray: a frequency off by a tenth is half a period off
STRETCH = 5  # of the fitted part of a long history, from fit to fit
KEPT = 28  # candidates that are fitted over more of the history

Start = tuple[tuple[Move, ...], Variant, tuple[str, ...]]  # causes, where their fit begins, its free numbers
CLEAR = 10.0  # of the information criterion: odds of 150 to 1
RARE = 14.0  # of the same, for a change that people rarely make: a thousand to one
AROUND = 5e-5  # relative L2 that moving geometry and a base leave, which every program treats in its own way
AROUND_OPEN = 3e-4  # the same where the contact opens: landings are late or early by what the base leaves
FACTORS = ("density-factor", "young-factor", "side-factor", "springs-factor", "load-factor")
SURROUNDINGS = ("springs-factor", "own-weight", "geometry-updated")
SCHEMES = [  # causes that are a time scheme: of several names the first is chosen
    *("start", "velocity", "substeps", "leapfrog", "scheme", "generalised-alpha", "hht", "wbz", "theta", "composite"),
    *("symplectic-euler", "exact-in-time"),
]
PROBES = (0.5, 2.0)  # time steps over the history's, at which two names are seen to be one scheme: half and double
RAYLEIGH = ("viscous-damping", "stiffness-damping")  # C = a0 M + a1 K, which programs have together
BASES = ((5.0, 1.0), (5.0, 1.25), (20.0, 1.0))  # to begin with: mass of a base over the block's, change of softness
NEUTRAL = Variant(0.5, 1.0, 1.0)  # given: numbers of a variant by which nothing is changed


@dataclass(frozen=True, eq=False)
class Explanation:
    """Causes, with the fit that has them."""

    moves: tuple[Move, ...]
    fit: Fit

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the causes, each once."""
        return tuple(dict.fromkeys(move.id for move in self.moves))


# ---- fits ----


def fitted(target: Target, scene: Variant, combos: Sequence[tuple[Move, ...]]) -> list[Explanation]:
    """Return combinations of causes at their best, each from the nearest two of its starts, the best first."""
    n = len(target.steps)
    # of a mass on springs as soft as block and springs together
    c = target.column
    period = 2 * math.pi * math.sqrt(c.density * c.width * c.height * abs(c.static) / abs(c.force or 1.0))
    steps = min(math.ceil(PERIODS * period / float(np.mean(target.steps))), LONGEST)
    part = target.until(steps) if steps < n else target
    explanations = _further(part, _fits(part, _begun(part, scene, combos), FIRST_ROUNDS)[: STRETCH * KEPT])
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
    """Return the variants from which the fits of a combination may begin."""
    fixed = changed(scene, {name: value for move in combo for name, value in move.changes.items()})
    firsts = [changed(fixed, {move.free[0]: value}) for move in combo for value in move.starts]
    return firsts if firsts and len(combo) == 1 else [fixed, *firsts]


def _leading(explanations: Sequence[Explanation]) -> list[Explanation]:
    """Return the best few, one for the same causes and free numbers."""
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
    reached: bool = False  # something leaves digits and noise only, also where no cause is named
    aliases: tuple[Explanation, ...] = ()  # other names of the best one: one scheme at any time step
    others: tuple[Explanation, ...] = ()  # less likely ones that explain it, too
    same_rows: tuple[Explanation, ...] = ()  # what gives the rows of the named one themselves

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


# ---- the decision ----


def decided(target: Target, scene_fit: Fit, explanations: Sequence[Explanation]) -> Verdict:
    """Return the verdict over candidates."""
    nearest = min(explanations, key=lambda f: f.fit.misfit, default=Explanation((), scene_fit))
    fine = [f for f in explanations if accepted(target, scene_fit, f.fit)]
    fewer = _fewer(target, scene_fit.variant, fine)
    fine += [f for f in fewer if accepted(target, scene_fit, f.fit)]
    fine = [f for f in fine if is_determined(target, scene_fit, f)]
    if not fine:
        return Verdict(scene_fit, nearest, False)
    deviations = target.deviations(min(fine, key=lambda f: f.fit.misfit).fit.residual)
    scores = {id(f): score(target, deviations, f) for f in (*fine, *explanations)}
    near = min(scores[id(f)] for f in fine) + CLEAR

    def order(explanation: Explanation) -> tuple[float, tuple[str, ...]]:
        """Return by what explanations are told first; equally likely ones by name, since their order is rounding's."""
        return round(scores[id(explanation)], 3), explanation.ids

    close = sorted((f for f in fine if scores[id(f)] < near), key=order)
    # a change is there only if the rows are clearly worse without it
    ids = min((f.ids for f in close if set(f.ids) <= set(close[0].ids)), key=len)
    best = min((f for f in close if f.ids == ids), key=lambda f: len(f.fit.free))
    best, names = _canonical(target, best, close)
    # what is as likely and misses the bar by a hair is as likely still, but no change with a part that has no effect
    likely = sorted((f for f in explanations if scores[id(f)] < near and f not in close), key=order)
    rivals = [*close, *(f for f in likely if is_determined(target, scene_fit, f) and not set(f.ids) <= set(best.ids))]
    wider = [f for f in rivals if any(set(other.ids) < set(f.ids) for other in (best, *close, *likely))]
    alike = {f.ids: f for f in reversed(rivals) if f.ids not in names and f not in wider}
    is_named = not alike and _stands_out(target, scene_fit, best) and not _of_one_landing(target, best)
    aliases = tuple(f for ids, f in names.items() if ids != best.ids)
    others = {f.ids: f for f in fine if f.ids not in {*names, *alike} and not set(best.ids) < set(f.ids)}
    return Verdict(
        scene_fit,
        best,
        is_named,
        tuple(alike.values())[:MOST_ALIKE],
        reached=True,
        aliases=aliases,
        others=tuple(others.values()),
    )


def _fewer(target: Target, scene: Variant, explanations: Sequence[Explanation]) -> list[Explanation]:
    """Return explanations of several changes without each of them, fitted from where they are.

    Candidates are pursued before all are in: a dead band may stand in for the mass of a base that is fitted later.
    """
    nearest = {f.ids: f for f in sorted(explanations, key=lambda f: -f.fit.misfit) if len(f.moves) > 1}
    starts: list[Start] = []
    for f in nearest.values():
        for move in f.moves:
            if move.id in SURROUNDINGS:  # without which they are tried anyway
                continue
            names = {*move.changes, *move.free}
            rest = tuple(other for other in f.moves if other is not move)
            if move.id in BAND_FIELDS and "opens" in names:  # without its limit the contact still opens
                names -= {"opens"}
                rest = (Move("contact-opened", {"opens": True}), *rest)
            without = changed(f.fit.variant, {name: getattr(scene, name) for name in names})
            starts.append((rest, without, _without(f.fit.free, names)))
    return _fits(target, starts, ROUNDS)


def score(target: Target, deviations: Array, explanation: Explanation) -> float:
    """Return the information criterion of an explanation, by the standard deviation of each row of each column."""
    remainder = target.inner(explanation.fit.residual, explanation.fit.variant)
    shares = np.ravel(target.parts(remainder) / deviations)
    n = len(shares)
    rare = sum(_is_rare(move, len(explanation.moves)) for move in explanation.moves)
    v = explanation.fit.variant
    rare += bool(v.band and v.reopening)  # two changes: one of where a contact closes, one of where it opens
    with np.errstate(over="ignore"):  # beside a column at rest nothing else is likely
        chi_square = max(float(shares @ shares) / n, 1.0)
    return n * math.log(chi_square) + len(explanation.fit.free) * math.log(n) + RARE * rare


def _is_rare(move: Move, among: int) -> bool:
    """Whether people rarely make a cause: of two factors neither, of a factor on one column they make by itself."""
    if among > 1 and move.id in FACTORS:
        return "displacement_factor" in move.free
    return not (CAUSES[move.id].usual or move.id in SURROUNDINGS)


def _canonical(
    target: Target, best: Explanation, close: Sequence[Explanation]
) -> tuple[Explanation, dict[tuple[str, ...], Explanation]]:
    """Return the explanation that names a scheme of several names, and all of these.

    Two explanations are one scheme if they give the same rows at any time step.
    """
    names = {best.ids: best}
    if _scheme_alone(best) is None:
        return best, names
    for f in close:
        is_other = f.ids not in names and _scheme_alone(f) is not None and f.ids[1:] == best.ids[1:]
        if is_other and same_program(target, best.fit.variant, replace(f.fit.variant, gg=best.fit.variant.gg)):
            names[f.ids] = f
    return names[min(names, key=lambda ids: SCHEMES.index(ids[0]))], names


def _scheme_alone(explanation: Explanation) -> str | None:
    """Return the id of a time scheme with fixed numbers that explains alone or beside a discount, else None."""
    first, *others = explanation.ids or ("",)
    alone = first in SCHEMES and others in ([], ["gg"]) and set(explanation.fit.free) <= {"gg"}
    return first if alone else None


def relatives(target: Target, scene: Variant, verdict: Verdict) -> list[Explanation]:
    """Return the other explanations that give the rows of the named one themselves, without digits and noise.

    What explains the rows as well, and the factors of a scene in pairs, is fitted to the history of the named one.
    """
    best = verdict.best
    if not (verdict.explained and best.moves):
        return []
    run = histories(target.column, [best.fit.variant], target.steps)
    both = np.array([run.displacement[target.rows, 0], run.pressure[target.rows, 0]])
    clean = Target(target.column, target.steps, target.rows, both[: len(target.recorded)])
    same = [f for f in _further(clean, verdict.others) if f.fit.misfit <= ARITHMETIC]
    if set(best.ids) <= {*FACTORS, "height-factor"}:  # a height by f is a density by f and a modulus by 1/f
        factors = {move.id: move for move in moves(target, scene) if move.id in FACTORS}
        pairs = [(factors[one], factors[two]) for one, two in itertools.combinations(factors, 2)]
        pairs = [pair for pair in pairs if set(best.ids).isdisjoint({move.id for move in pair})]
        same += [f for f in fitted(clean, scene, pairs) if f.fit.misfit <= ARITHMETIC]
    distinct = {f.ids: f for f in reversed(same) if is_determined(clean, fit_one(clean, scene), f)}
    return list(distinct.values())[:MOST_ALIKE]


def with_same_rows(target: Target, scene: Variant, verdict: Verdict) -> Verdict:
    """Return a verdict with its `relatives`.

    Of several factors none is named where other ones, as few, do: two numbers of a product stand for two others.
    """
    same_rows = tuple(relatives(target, scene, verdict))
    count = len(verdict.best.ids)
    is_product = count > 1 and set(verdict.best.ids) <= {*FACTORS}
    ties = tuple(each for each in same_rows if is_product and len(each.ids) <= count)
    return replace(verdict, explained=False, alike=ties) if ties else replace(verdict, same_rows=same_rows)


def same_program(target: Target, one: Variant, other: Variant) -> bool:
    """Whether two variants give the same rows at other time steps, too."""
    for longer in PROBES:
        steps = np.full(WINDOW, longer * float(target.steps[0]))
        run = histories(target.column, [one, other], steps).displacement
        with np.errstate(all="ignore"):
            apart = np.abs(run[:, 0] - run[:, 1])
            if not np.all(apart <= ARITHMETIC * np.max(np.abs(run), axis=1).max()):
                return False
    return True


def accepted(target: Target, scene_fit: Fit, candidate: Fit) -> bool:
    """Whether a fit leaves no more than it may: digits and noise, or next to nothing, or what a base does."""
    v = candidate.variant
    if target.explained(target.inner(candidate.residual, v)):
        return True
    # rounded constants leave that much, and passes of an augmented Lagrangian; other schemes come as near by chance
    is_usual = (v.family, v.contact) == (scene_fit.variant.family, scene_fit.variant.contact) or v.contact == "rigid"
    if is_usual and _is_negligible(target, candidate, min(AGREED, scene_fit.misfit * SEEN)):
        return True
    around = AROUND_OPEN if v.opens else AROUND
    loose = min(math.hypot(around, target.floor), SLIGHT * scene_fit.misfit)
    return candidate.misfit <= loose and _surrounded(target, candidate)


def _is_negligible(target: Target, candidate: Fit, least: float) -> bool:
    """Whether a fit leaves next to nothing, and no row by itself that is another one."""
    return candidate.misfit <= least and target.outlying(candidate.residual) is None


def _surrounded(target: Target, candidate: Fit) -> bool:
    """Whether moving geometry or a base is seen in a history: without it the same fit leaves much more.

    Every program treats what surrounds a block in its own way, so that some of it may be left; a base of 1e-6 or a
    geometry that makes no difference excuses nothing.
    """
    v = candidate.variant
    base = v.base > 0 or (v.softness > 0 and benign_springs(target.column, v))
    if not (v.updated or base):
        return False
    without = replace(v, updated=False, base=0.0, softness=0.0 if base else v.softness)
    return fit_one(target, without).misfit > TWICE * candidate.misfit


def is_determined(target: Target, scene_fit: Fit, explanation: Explanation) -> bool:
    """Whether the rows determine every free number, and as another one than that by which nothing is changed.

    HHT at alpha_f = 1e-7 is average acceleration, a dashpot of nothing the scene's own contact: a number says nothing
    if such a special case explains the rows as well, if no row changes with it, or if they leave open how many times
    the scene's it is.
    """
    solution, scene = explanation.fit, scene_fit.variant
    v = solution.variant
    special_cases: list[dict[str, float]] = []
    many_times: list[dict[str, float]] = []
    for name in solution.free:
        if name in ("alpha", "delta"):
            special_cases.append({"alpha": scene.alpha, "delta": scene.delta})
        elif name == "spectral":
            special_cases += [{name: number} for number in SHARED.get(v.family, ())]
        elif name == "gg":
            special_cases.append({name: scene.gg})
        else:
            special_cases.append({name: getattr(NEUTRAL, name)})
        if is_factor(name):
            many_times += [{name: getattr(v, name) * CLEARLY}, {name: getattr(v, name) / CLEARLY}]
        elif name == "softness":
            many_times += [{name: v.softness + math.log(CLEARLY)}, {name: v.softness - math.log(CLEARLY)}]
    if not all(math.isfinite(interval.half_width) for interval in intervals(solution).values()):
        return False
    specials = fit(target, [(changed(v, case), ()) for case in (*special_cases, *many_times)])
    # beside a stiffness that is hardly felt the other numbers are hardly others
    near = [each.misfit <= SLIGHT * scene_fit.misfit for each in specials[len(special_cases) :]]
    starts = [(changed(v, case), _without(solution.free, case)) for case in itertools.compress(many_times, near)]
    # not by the tolerance of a base: a heavy one hardly feels its springs, and digits tell them
    leaves_digits = [target.explained(target.inner(f.residual, f.variant)) for f in fit(target, starts, ROUNDS)]
    of_none = specials[: len(special_cases)]
    least = TWICE * max(AGREED, solution.misfit)
    is_none = any(each.misfit <= least or accepted(target, scene_fit, each) for each in of_none)
    return not (is_none or any(leaves_digits))


def _without(free: Sequence[str], names: Collection[str]) -> tuple[str, ...]:
    return tuple(name for name in free if name not in names)


def _stands_out(target: Target, scene_fit: Fit, explanation: Explanation) -> bool:
    """Whether enough of the difference stands out of digits and noise for a cause to be named.

    Where they hide a share of it, another cause that leaves less would look the same: a scheme or a contact method has
    many near to it and counts twice, what surrounds a block counts as nothing.
    """
    many = any(CAUSES[name].family or name in CONTACT_METHODS or name == "scheme" for name in explanation.ids)
    faults = [move for move in explanation.moves if move.id not in SURROUNDINGS]
    changes = max(1, len(faults), sum(len(move.free) for move in faults)) * (1 + many)
    most = SLIGHT if len(explanation.moves) > 1 else 1.0
    return explanation.fit.misfit <= min(most, CLEARLY**-changes) * scene_fit.misfit


def _of_one_landing(target: Target, explanation: Explanation) -> bool:
    """Whether an explanation has a restitution from one landing: every contact leaves some share of one speed."""
    if "restitution" not in explanation.fit.free:
        return False
    is_open = histories(target.column, [explanation.fit.variant], target.steps).open[:, 0]
    return int(np.count_nonzero(is_open[:-1] & ~is_open[1:])) < 2


# ---- the search ----


def as_it_is(target: Target, scene: Variant) -> Verdict:
    """Return whether the scene's own scheme, nothing added, explains a history."""
    scene_fit = fit_one(target, scene)
    is_same = target.explained(scene_fit.residual) or _is_negligible(target, scene_fit, AGREED)
    return Verdict(scene_fit, Explanation((), scene_fit), is_same, reached=is_same)


def simple(target: Target, scene: Variant) -> Verdict:
    """Return what none, one cause, or what surrounds a block explains."""
    own = as_it_is(target, scene)
    if own.same:
        return own
    scene_fit = own.scene_fit
    single = fitted(target, scene, [(move,) for move in moves(target, scene)])
    verdict = decided(target, scene_fit, single)
    if not verdict.reached:
        single += fitted(target, scene, [(move,) for move in dead_bands(target, scene, FINE_BANDS)])
        single.sort(key=lambda f: f.fit.misfit)
        verdict = decided(target, scene_fit, single)
    if not verdict.reached:
        verdict = _nearer(decided(target, scene_fit, _around(target, scene)), verdict)
    return replace(verdict, single=tuple(single))


def twofold(target: Target, scene: Variant, before: Verdict) -> Verdict:
    """Return what two causes explain, or one beside what surrounds the block, else the verdict before."""
    every = moves(target, scene)
    # another scheme beside another discount, two causes, both parts of Rayleigh's damping
    discount = next(move for move in every if move.id == "gg" and move.free)
    of_schemes = [move for move in every if move.id == "scheme" or CAUSES[move.id].family]
    pairs: list[tuple[Move, ...]] = [(move, discount) for move in of_schemes if len(move.free) < 2]
    few = _few(target, scene, before.single)
    if not scene.opens:
        pairs += [pair for pair in itertools.combinations(few, 2) if _together(pair)]
        damping = tuple(move for move in every if move.id in RAYLEIGH)
        pairs += [damping] if len(damping) == len(RAYLEIGH) else []
    verdict = _nearer(decided(target, before.scene_fit, [*fitted(target, scene, pairs), *before.single]), before)
    if verdict.reached:
        return verdict
    faults = [move for move in few if move.id not in SURROUNDINGS]
    faults += [move for move in every if move.changes.get("reopening") == OF_NTDDA]
    parts = _surroundings(target, scene)
    around = [tuple(combo) for size in (1, 2, 3) for combo in itertools.combinations(parts, size)]
    beside = fitted(target, scene, [(move, *parts) for move in faults if _together((move, *parts))])[:MOST_ALIKE]
    fewer = [(f.moves[0], *some) for f in beside for some in around if _together((f.moves[0], *some))]
    explanations = [f for f in fitted(target, scene, fewer) if benign_springs(target.column, f.fit.variant)]
    last = decided(target, before.scene_fit, [*explanations, *_heavy(target, explanations[:3]), *before.single])
    return _nearer(last, verdict)


def _nearer(*verdicts: Verdict) -> Verdict:
    """Return the verdict that explains more."""
    return min(verdicts, key=lambda v: (not v.explained, not v.reached, v.best.fit.misfit))


def _around(target: Target, scene: Variant) -> list[Explanation]:
    """Return two or three of what surrounds a block: a softer base, weight, moving geometry."""
    parts = _surroundings(target, scene)
    combos = [tuple(parts[:1])] + [combo for size in (2, 3) for combo in itertools.combinations(parts, size)]
    explanations = fitted(target, scene, combos)
    soft = [f for f in explanations if len(f.moves) == 1]
    return sorted([*explanations, *_heavy(target, explanations[:2]), *_heavy(target, soft)], key=lambda f: f.fit.misfit)


def _surroundings(target: Target, scene: Variant) -> list[Move]:
    plain = {move.id: move for move in moves(target, scene) if move.id in SURROUNDINGS}
    plain["springs-factor"] = Move("springs-factor", {}, ("softness",), (0.0, 0.02))
    return [plain[name] for name in SURROUNDINGS]


def _heavy(target: Target, explanations: Sequence[Explanation]) -> list[Explanation]:
    """Return explanations by a softer base with a mass of the base."""
    more = []
    for f in explanations:
        v = f.fit.variant
        if v.softness > 0 and "softness" in f.fit.free:
            starts = [(replace(v, base=m, softness=v.softness * soft), (*f.fit.free, "base")) for m, soft in BASES]
            more += [Explanation(f.moves, heavy) for heavy in fit(target, starts)]
    return more


def _few(target: Target, scene: Variant, single: Sequence[Explanation]) -> list[Move]:
    """Return the causes that are tried in pairs, from the scene or where each was best by itself."""
    few = []
    alone = {f.ids[0]: f.fit.variant for f in reversed(single)}
    for move in moves(target, scene):
        cause = CAUSES[move.id]
        if cause.alone or move.free == ("alpha", "delta"):
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
