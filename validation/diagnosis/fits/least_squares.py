"""Least squares by Levenberg and Marquardt's method: many fits advance together, since one pass may serve them all."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from validation.diagnosis.fits.bar import norm
from validation.runs.history import Array

FIRST_DAMPING, LAST_DAMPING = 1e-4, 1e4  # of the diagonal; beyond the last one no step gains
NUDGE = 1e-6  # of the spans, for a derivative: root of the rounding of a relative history, about
UNFELT = 1e-12  # of the largest curvature: keeps the equations of a number without effect solvable

Evaluated = Callable[[Sequence[tuple[int, Array]]], Sequence[Array]]  # pairs of a problem and its numbers to residuals


class Problem(NamedTuple):
    """The numbers of one fit, all of shape (numbers,)."""

    start: Array
    span: Array  # in which steps are measured
    low: Array
    high: Array
    nudges: Callable[[Array], Array]  # of each number at a point, for a derivative
    reach: float = math.inf  # of a step, over the span; a number may double: beyond it no slope is trusted


@dataclass(frozen=True, eq=False)
class Solution:
    """Where a fit stands."""

    point: Array  # (numbers,)
    residual: Array  # (rows,)
    jacobian: Array  # of the residual, (rows, numbers)

    @property
    def misfit(self) -> float:
        """Root of the sum of squares."""
        return norm(self.residual)


def least_squares(
    residuals: Evaluated, problems: Sequence[Problem], rounds: int, settled: float, least: float = 0.0
) -> list[Solution]:
    """Return all fits at their best.

    Parameters
    ----------
    residuals
        Of problems, by their place, and their numbers.
    rounds
        Trials of each fit.
    settled
        Relative gain at which a fit has arrived.
    least
        Misfit that is as good as none.
    """
    best = _linearised(residuals, problems, [(i, problem.start) for i, problem in enumerate(problems)])
    damping = [FIRST_DAMPING] * len(best)
    active = [len(problem.start) > 0 for problem in problems]
    for _ in range(rounds):
        tried = [i for i, on in enumerate(active) if on]
        if not tried:
            break
        trials = [(i, _moved(problems[i], best[i], damping[i])) for i in tried]
        for i, trial in zip(tried, _linearised(residuals, problems, trials), strict=True):
            gain = best[i].misfit - trial.misfit
            damping[i] *= 0.1 if gain > 0 else 10.0
            has_arrived = 0 <= gain <= settled * trial.misfit or trial.misfit <= least
            active[i] = damping[i] < LAST_DAMPING and not has_arrived
            if gain > 0:
                best[i] = trial
    return best


def one_fit(
    residual: Callable[[Array], Array],
    start: Sequence[float],
    span: Sequence[float],
    rounds: int,
    settled: float,
    nudges: Callable[[Array], Array] | None = None,
    farthest: float = math.inf,
    reach: float = math.inf,
) -> Solution:
    """Return one fit at its best, without bounds but on the size of its numbers; nudges are shares of the spans."""
    spans = np.array(span, dtype=float)
    limits = np.full(len(spans), farthest)
    problem = Problem(np.array(start, dtype=float), spans, -limits, limits, nudges or (lambda _: NUDGE * spans), reach)
    (solution,) = least_squares(lambda points: [residual(point) for _, point in points], [problem], rounds, settled)
    return solution


def _linearised(
    residuals: Evaluated, problems: Sequence[Problem], points: Sequence[tuple[int, Array]]
) -> list[Solution]:
    """Return where problems stand at some points, with their derivatives."""
    requested = []
    nudges_of_points = []
    for i, point in points:
        nudges = problems[i].nudges(point) if len(point) else point
        nudges_of_points.append(nudges)
        requested += [(i, point), *((i, point + nudge) for nudge in np.diag(nudges))]
    answers = iter(residuals(requested))
    solutions = []
    for (_, point), nudges in zip(points, nudges_of_points, strict=True):
        residual = next(answers)
        slopes = [(next(answers) - residual) / nudge for nudge in nudges]
        jacobian = np.column_stack(slopes) if slopes else np.empty((len(residual), 0))
        solutions.append(Solution(point, residual, jacobian))
    return solutions


def _moved(problem: Problem, current: Solution, damping: float) -> Array:
    """Return the numbers one damped Gauss-Newton step on."""
    J = current.jacobian * problem.span
    H = J.T @ J
    scale = np.diag(H) + UNFELT * (np.max(np.diag(H)) or 1.0)
    step = np.linalg.solve(H + damping * np.diag(scale), -J.T @ current.residual) * problem.span
    reach = np.inf if math.isinf(problem.reach) else np.maximum(problem.reach * problem.span, np.abs(current.point))
    return np.clip(current.point + np.clip(step, -reach, reach), problem.low, problem.high)
