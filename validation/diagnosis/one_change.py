"""One thing changed, with a number that is fitted: the candidates, their fit, and which of them count as alike.

Whoever searches says what a candidate gives (a run of a scene by a solver of the suite, or columns moved in time) and
how far that is from a history. The fits and the decision are those of this module for every kind of scene.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np

from validation.diagnosis.changes import Values
from validation.diagnosis.numbers import numbers
from validation.runs.history import Array
from validation.scenes.scene import Scene

Given = TypeVar("Given")
Found = TypeVar("Found")
Residual = Callable[[float], Array]  # of a candidate's u: what it leaves of a history
UNITS = (1e-3, 1e3)  # factors of a datum in other units: mm, g, kPa, or MPa for Pa
IN_UNITS = frozenset({"density-factor", "young-factor", "springs-factor", "load-factor"})
NEAR_UNIT = 0.02  # relative, of a fitted factor that is said to be one of units: the rest is the fit's
SPAN = 0.05  # of u, that a step of a fit is measured in


@dataclass(frozen=True, eq=False)
class CandidateChange(Generic[Given]):
    """One thing changed; with `starts` it has a number u that is fitted.

    Attributes
    ----------
    id
        Of the cause.
    words
        The sentence of the cause by its number.
    value
        The number that people understand, of u.
    changed
        What the change gives, of u.
    starts
        Values of u that a fit begins from.
    nudge
        Of u, for the first derivative.
    """

    id: str
    words: Callable[[float], str]
    value: Callable[[float], float]
    changed: Callable[[float], Given]
    starts: tuple[float, ...] = ()
    nudge: float = 1e-3

    def giving(self, changed: Callable[[float], Any]) -> CandidateChange[Any]:
        """Return the same change with another thing that it gives."""
        return replace(self, changed=changed)


def of_numbers(scene: Scene, factors: Sequence[float], units: bool = True) -> Iterator[CandidateChange[Values]]:
    """Yield every number of a scene as wrong by a factor e^u.

    Parameters
    ----------
    factors
        That fits begin from.
    units
        Whether they begin from other units as well.
    """
    for number in numbers(scene):
        starts = (*factors, *(UNITS if units and number.id in IN_UNITS else ()))

        def words(factor: float, name: str = number.name) -> str:
            return f"{name} is {factor:.4g} times the scene's{in_units(factor)}"

        def changed(u: float, change: Callable[[Scene, float], Values] = number.changed) -> Values:
            return change(scene, math.exp(u))

        yield CandidateChange(number.id, words, math.exp, changed, tuple(map(math.log, starts)))


def in_units(factor: float) -> str:
    """Return what a factor is by which units go wrong, nothing for another one."""
    return ", other units" if any(math.isclose(factor, unit, rel_tol=NEAR_UNIT) for unit in UNITS) else ""


def of_discount(scene: Scene, discounts: Sequence[float]) -> CandidateChange[Values]:
    """Return another discount of the velocity at every step, gg = e^u; fits begin from some, times the scene's own."""
    own = scene.time.discount
    return CandidateChange(
        "gg",
        lambda gg: f"gg = {gg:.5g} where the scene has {own:.5g}",
        lambda u: min(math.exp(u), 1.0),
        lambda u: {"time.gg": min(math.exp(u), 1.0)},
        tuple(math.log(discount * own) for discount in discounts),
    )


# ---- fits -----------------------------------------------------------------------------------------------------------


def nearest_start(residual: Residual, starts: Sequence[float]) -> float:
    """Return the start that leaves least."""
    return min(starts, key=lambda u: float(np.linalg.norm(residual(u))))


def left_along_slope(residual: Residual, start: float, nudge: float) -> float:
    """Return what the best number leaves if the history is linear in it at a start; infinite without effect there."""
    at = residual(start)
    slope = (residual(start + nudge) - at) / nudge
    size = float(slope @ slope)
    return float(np.linalg.norm(at - slope * (slope @ at) / size)) if size > 0 else math.inf


def fitted(residual: Residual, start: float, rounds: int, nudge: float, settled: float = 1e-8) -> tuple[float, float]:
    """Return the number that comes nearest, and the norm of what it leaves.

    Parameters
    ----------
    rounds
        Evaluations, those of derivatives apart.
    nudge
        Relative change of u for a derivative.
    settled
        Relative gain at which the fit has arrived.
    """
    from scipy.optimize import least_squares

    done = least_squares(
        lambda u: residual(float(u[0])),
        [start],
        diff_step=nudge,
        x_scale=SPAN,
        max_nfev=rounds,
        xtol=settled,
        ftol=settled,
    )
    return float(done.x[0]), float(np.linalg.norm(done.fun))


# ---- the decision ---------------------------------------------------------------------------------------------------


def alike(found: Sequence[Found], left: Callable[[Found], float], times: float, least: float = 0.0) -> list[Found]:
    """Return those of some explanations that leave hardly more than the best, the best first.

    Parameters
    ----------
    left
        What one leaves.
    times
        More than the best that others may leave.
    least
        That the best counts as leaving: below it no difference is one.
    """
    ordered = sorted(found, key=left)
    return [one for one in ordered if left(one) <= times * max(left(ordered[0]), least)]
