"""One thing changed, with a number that is fitted: the candidates, and their fit.

Whoever searches says how far what a candidate gives is from a history.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from validation.diagnosis.constants import CHANGE, CLEARLY, DISCOUNTS, NUDGE, ROUNDS, SLIGHT, UNITS
from validation.diagnosis.fits.bar import norm
from validation.diagnosis.fits.fit import NAMED
from validation.diagnosis.hooks import DiagnosisHooks
from validation.diagnosis.moves import FACTORS
from validation.diagnosis.numbers import CandidateChange, Values, fixed
from validation.diagnosis.sentences import scheme_words
from validation.errors import InputError
from validation.runs.history import Array, History
from validation.runs.numbers import ROUNDING, significant
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver

LARGEST = math.log(CLEARLY * max(UNITS))  # of a factor that a number may be wrong by
Residual = Callable[[CandidateChange, float], Array]  # of a change and its u: what it leaves of a history
# of a factor: the middle half of those of a block, and near to one, which by itself tells nothing
STARTS = (0.95, 1.05, *FACTORS[len(FACTORS) // 4 : -len(FACTORS) // 4])


def of_schemes(scene: Scene) -> Iterator[CandidateChange]:
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


def of_numbers(scene: Scene, factors: Sequence[float]) -> Iterator[CandidateChange]:
    """Yield every number of a scene as wrong by a factor e^u; fits begin from some factors."""
    hooks = DiagnosisHooks.of(scene)
    for number in (*hooks.numbers(scene), *hooks.numbers_of_layers(scene)):

        def words(factor: float, name: str = number.name) -> str:
            return f"{name} is {factor:.4g} times the scene's{in_units(factor)}"

        def changed(u: float, change: Callable[[float], Values] = number.changed) -> Values:
            return change(math.exp(u))

        yield CandidateChange(number.id, words, math.exp, changed, tuple(map(math.log, factors)))


def in_units(factor: float) -> str:
    """Return what a factor is by which units go wrong, nothing for another one."""
    return ", other units" if any(math.isclose(factor, unit, rel_tol=SLIGHT) for unit in UNITS) else ""


def of_discount(scene: Scene) -> CandidateChange:
    """Return another discount of the velocity at every step, gg = e^u; fits begin from some, times the scene's own."""
    scene_discount = scene.time.discount
    return CandidateChange(
        "gg",
        lambda gg: f"gg = {gg:.5g} where the scene has {scene_discount:.5g}",
        lambda u: min(math.exp(u), 1.0),
        lambda u: {"time.gg": min(math.exp(u), 1.0)},
        tuple(math.log(discount * scene_discount) for discount in DISCOUNTS),
    )


def of_scene(scene: Scene, factors: Sequence[float]) -> Iterator[CandidateChange]:
    """Yield everything that may be changed in any scene, one thing at a time; fits of numbers begin from factors."""
    yield from of_schemes(scene)
    yield from DiagnosisHooks.of(scene).laws(scene)
    yield from of_numbers(scene, factors)
    yield of_discount(scene)


def run_of(scene: Scene, values: Values, name: str) -> History | None:
    """Return the history of a solver where some values of a scene are others; None where there is no such run."""
    try:
        changed = scene.with_values(values)
        solver = get_solver(name)
        if solver.refusal(changed) is not None:
            return None
        with np.errstate(all="ignore"):
            history = solver.solve(changed).history
    except (InputError, ArithmeticError, ValueError):
        return None
    if history is None or len(history.time) != changed.time.steps:
        return None
    return history if all(np.all(np.isfinite(column)) for column in history.columns.values()) else None


# ---- fits ----


@dataclass(frozen=True, eq=False)
class Fitted:
    """A candidate at its best number so far, with what its run leaves."""

    change: CandidateChange
    u: float = 0.0  # its number, zero where it has none
    remainder: float = math.inf  # norm of what it leaves, or of what the best number would, were it linear in it
    ratio: float = math.inf  # of what it leaves to what may remain, in the worst row [1]
    left: float = math.inf  # relative L2 difference of the worst column [1]
    is_noise: bool = False  # whether that is more than digits, but has no shape

    @property
    def explains(self) -> bool:
        """Whether digits or noise are all that remains."""
        return self.ratio <= 1 or self.is_noise

    @property
    def is_sensible(self) -> bool:
        """Whether its number is no factor so far away that it is forgotten, or rigid, which other candidates say."""
        return self.change.value is not math.exp or abs(self.u) <= LARGEST

    @property
    def id(self) -> str:
        """Of the cause."""
        return self.change.id

    @property
    def value(self) -> float | None:
        """The number of the cause, None where it has none."""
        number = self.change.value(self.u)
        return None if math.isnan(number) else significant(number, 6)

    @property
    def values(self) -> Values:
        """What of the scene is so."""
        return self.change.changed(self.u)

    @property
    def words(self) -> str:
        """The cause in words."""
        return self.change.words(self.value or 0.0)


def nearest(
    residual: Residual, changes: Iterable[CandidateChange], number: int, least: float, most: float
) -> list[Fitted]:
    """Return so many changes that leave least at their best start along their slope, the best first.

    Those that leave no more than `least` are all among them, those without a number that leave more than `most` are
    not: they are as near as they get.
    """
    starts = [_nearest_start(residual, change) for change in changes]
    possible = [start for start in starts if start.change.starts or start.remainder <= most]
    ordered = sorted(possible, key=lambda start: start.remainder)
    return [start for place, start in enumerate(ordered) if place < number or start.remainder <= least]


def _nearest_start(residual: Residual, change: CandidateChange) -> Fitted:
    """Return a candidate at the start that leaves least, with what it would leave if the history were linear there.

    One without a number leaves what it leaves, one whose number has no effect infinitely much.
    """
    if not change.starts:
        return fitted(residual, Fitted(change))
    residuals = {u: residual(change, u) for u in change.starts}
    start = min(residuals, key=lambda u: norm(residuals[u]))
    there = residuals[start]
    slope = (residual(change, start + change.nudge) - there) / change.nudge
    size = float(slope @ slope)
    linear = norm(there - slope * (slope @ there) / size) if size > 0 else math.inf
    return Fitted(change, start, linear)


def fitted(residual: Residual, candidate: Fitted) -> Fitted:
    """Return a candidate at the number that comes nearest, as it is where it has none."""
    from scipy.optimize import least_squares

    if not candidate.change.starts:
        return replace(candidate, remainder=norm(residual(candidate.change, 0.0)))
    # one is added since steps of derivatives are relative, and u may come to zero
    solution = least_squares(
        lambda x: residual(candidate.change, float(x[0]) - 1),
        [candidate.u + 1],
        diff_step=NUDGE,
        x_scale=CHANGE,
        max_nfev=ROUNDS,
        xtol=ROUNDING,
        ftol=ROUNDING,
    )
    return replace(candidate, u=float(solution.x[0]) - 1, remainder=norm(solution.fun))
