"""One thing changed, with a number that is fitted: the candidates, their fit, and which of them count as alike.

Whoever searches says what a candidate gives (a run of a scene by a solver of the suite, or columns moved in time) and
how far that is from a history.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Generic, TypeVar

import numpy as np

from validation.diagnosis.constants import ARITHMETIC, CHANGE, FIRST_ROUNDS, SLIGHT, TWICE, UNITS
from validation.diagnosis.fits.bar import norm
from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.hooks import DiagnosisHooks
from validation.diagnosis.numbers import CandidateChange, Change, Values, fixed
from validation.diagnosis.sentences import scheme_words
from validation.runs.history import Array
from validation.runs.numbers import ROUNDING
from validation.scenes.scene import Scene

Explanation = TypeVar("Explanation")
Residual = Callable[[float], Array]  # of a candidate's u: what it leaves of a history
IN_UNITS = frozenset({"density-factor", "young-factor", "springs-factor", "load-factor"})


def of_schemes(scene: Scene) -> Iterator[CandidateChange[Values]]:
    """Yield the schemes by which programs step, with either start."""
    t = scene.time
    scene_pairs = [(t.alpha, t.delta)] if t.scheme == "newmark" else []
    for alpha, delta in dict.fromkeys([*scene_pairs, *NAMED.values()]):
        for start in dict.fromkeys([t.start, "zero", "consistent"]):
            values: Values = {"time.scheme": "newmark", "time.alpha": alpha, "time.delta": delta, "time.start": start}
            if (alpha, delta) not in scene_pairs:
                also = "" if start == t.start else f', the initial acceleration is "{start}"'
                yield fixed("scheme", f"{scheme_words(alpha, delta, t.discount)}{also}", values)
            elif start != t.start:
                yield fixed("start", f'the initial acceleration is "{start}", not "{t.start}"', values)


def of_numbers(scene: Scene, factors: Sequence[float], units: bool = True) -> Iterator[CandidateChange[Values]]:
    """Yield every number of a scene as wrong by a factor e^u; fits begin from the factors, and from `units` as well."""
    hooks = DiagnosisHooks.of(scene)
    for number in (*hooks.numbers(scene), *hooks.numbers_of_layers(scene)):
        starts = (*factors, *(UNITS if units and number.id in IN_UNITS else ()))

        def words(factor: float, name: str = number.name) -> str:
            return f"{name} is {factor:.4g} times the scene's{in_units(factor)}"

        def changed(u: float, change: Callable[[Scene, float], Values] = number.changed) -> Values:
            return change(scene, math.exp(u))

        yield CandidateChange(number.id, words, math.exp, changed, tuple(map(math.log, starts)))


def in_units(factor: float) -> str:
    """Return what a factor is by which units go wrong, nothing for another one."""
    return ", other units" if any(math.isclose(factor, unit, rel_tol=SLIGHT) for unit in UNITS) else ""


def of_discount(scene: Scene, discounts: Sequence[float]) -> CandidateChange[Values]:
    """Return another discount of the velocity at every step, gg = e^u; fits begin from some, times the scene's own."""
    scene_discount = scene.time.discount
    return CandidateChange(
        "gg",
        lambda gg: f"gg = {gg:.5g} where the scene has {scene_discount:.5g}",
        lambda u: min(math.exp(u), 1.0),
        lambda u: {"time.gg": min(math.exp(u), 1.0)},
        tuple(math.log(discount * scene_discount) for discount in discounts),
    )


# ---- fits ----


@dataclass(frozen=True, eq=False)
class Fitted(Generic[Change]):
    """A candidate at its best number so far."""

    change: CandidateChange[Change]
    u: float  # its number, zero where it has none
    remainder: float  # norm of what it leaves, or of what the best number would leave were the history linear in it


def nearest_start(residual: Residual, change: CandidateChange[Change]) -> Fitted[Change]:
    """Return a candidate at the start that leaves least, with what it would leave if the history were linear there.

    One without a number leaves what it leaves, one whose number has no effect infinitely much.
    """
    if not change.starts:
        return Fitted(change, 0.0, norm(residual(0.0)))
    residuals = {u: residual(u) for u in change.starts}
    start = min(residuals, key=lambda u: norm(residuals[u]))
    there = residuals[start]
    slope = (residual(start + change.nudge) - there) / change.nudge
    size = float(slope @ slope)
    linear = norm(there - slope * (slope @ there) / size) if size > 0 else math.inf
    return Fitted(change, start, linear)


def nearest(candidates: Sequence[Fitted[Change]], number: int, least: float) -> list[Fitted[Change]]:
    """Return so many candidates that leave least, and all that leave no more than `least`, the best first."""
    ordered = sorted(candidates, key=lambda candidate: candidate.remainder)
    bar = max(ordered[min(len(ordered), number) - 1].remainder, least) if ordered else least
    return [candidate for candidate in ordered if candidate.remainder <= bar]


def fitted(
    residual: Residual,
    candidate: Fitted[Change],
    rounds: int,
    nudge: float,
    settled: float = ARITHMETIC,
    hopeless: float = math.inf,
) -> Fitted[Change]:
    """Return a candidate at the number that comes nearest, as it is where it has none.

    Rounds are evaluations but for those of derivatives, for which u changes by the relative `nudge`; `settled` is the
    relative gain at which the fit has arrived, `hopeless` the remainder beyond which it is given up if its first rounds
    have not halved it, nor would its slope.
    """
    if not candidate.change.starts:
        return replace(candidate, remainder=norm(residual(0.0)))
    first = _least_squares(residual, candidate, min(rounds, FIRST_ROUNDS), nudge, settled)
    if rounds <= FIRST_ROUNDS or (
        min(first.remainder, candidate.remainder) > hopeless and TWICE * first.remainder > norm(residual(candidate.u))
    ):
        return first
    return _least_squares(residual, first, rounds - FIRST_ROUNDS, nudge, settled)


def _least_squares(
    residual: Residual, candidate: Fitted[Change], rounds: int, nudge: float, settled: float
) -> Fitted[Change]:
    from scipy.optimize import least_squares

    known = lru_cache(maxsize=4)(residual)

    def slope(u: Array) -> Array:
        """Return the derivative by a step relative to u, beside zero to the span."""
        x = float(u[0])
        step = nudge * (x if abs(x) > ROUNDING else CHANGE)
        return np.asarray((known(x + step) - known(x)) / step)[:, None]

    solution = least_squares(
        lambda u: known(float(u[0])),
        [candidate.u],
        jac=slope,
        x_scale=CHANGE,
        max_nfev=rounds,
        xtol=settled,
        ftol=settled,
    )
    return replace(candidate, u=float(solution.x[0]), remainder=norm(solution.fun))


# ---- the decision ----


def alike(
    explanations: Sequence[Explanation], remainder: Callable[[Explanation], float], times: float, least: float = 0.0
) -> list[Explanation]:
    """Return those of some explanations whose remainder is hardly more than the best's, the best first.

    Hardly more is at most so many times the best's, which counts as `least` at least: below it no difference is one.
    """
    ordered = sorted(explanations, key=remainder)
    return [each for each in ordered if remainder(each) <= times * max(remainder(ordered[0]), least)]
