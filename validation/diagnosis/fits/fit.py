"""Which scheme made a history: least-squares fits of many variants at once, compared by what each one explains.

A fit minimises the relative L2 difference between a history and a `Variant` over the variant's free numbers by the
method of Levenberg and Marquardt, all fits at once because one pass through the steps serves them all. The intervals
are 95 % ones of the linearised problem: n rows whose residual has the lag-one correlation r count as
n (1 - r) / (1 + r) independent ones.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from validation.diagnosis.constants import CHANGE, NUDGE, ORDER, ROUNDS, SEEN, UNBOUNDED
from validation.diagnosis.fits.bar import norm
from validation.diagnosis.fits.target import Target
from validation.diagnosis.schemes import LARGEST_ALPHA_F
from validation.diagnosis.variant import Variant
from validation.runs.history import Array
from validation.runs.numbers import ROUNDING

NAMED: dict[str, tuple[float, float]] = {  # given: alpha, delta
    "constant acceleration": (1 / 2, 1.0),
    "average acceleration": (1 / 4, 1 / 2),
    "linear acceleration": (1 / 6, 1 / 2),
    "Fox-Goodwin": (1 / 12, 1 / 2),
    "central differences": (0.0, 1 / 2),
    "unconditionally complex": (9 / 16, 1.0),
    "backward differences": (4 / 5, 3 / 2),
    "backward Euler": (1.0, 3 / 2),  # from rest with A0 = 0 row by row: M a1 + K x1 = F, v1 = v + dt a1, x1 = x + dt v1
}
NUMBERS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
SPAN: dict[str, float] = {name: row.get("span", CHANGE) for name, row in NUMBERS.items()}
NORMAL_95 = 1.96  # given: standard deviations
UNTOLD = 0.05  # share of its span from which on a number counts as not told by the data


@dataclass(frozen=True, eq=False)
class Fit:
    """A variant at its best, with what is left."""

    variant: Variant
    free: tuple[str, ...]
    misfit: float  # relative L2 [-]
    residual: Array  # scaled as the target's values
    jacobian: Array  # (rows, free)

    @property
    def independent(self) -> float:
        """Number of independent rows, from the lag-one correlation of the residual."""
        r = self.residual
        square = float(r @ r)
        lag = float(r[1:] @ r[:-1]) / square if square else 0.0
        lag = min(max(lag, 0.0), 1.0)
        # a smooth residual of a few swings tells as much as half the order
        return max(len(r) * (1 - lag) / (1 + lag), min(len(r), ORDER / 2))


@dataclass(frozen=True)
class Interval:
    """A fitted number and the half width of its 95 % interval."""

    value: float
    half_width: float


def fit(target: Target, starts: Sequence[tuple[Variant, tuple[str, ...]]], rounds: int = ROUNDS) -> list[Fit]:
    """Fit variants, each with the names of its free numbers, in some rounds of Levenberg and Marquardt's method."""
    goal = target.values
    best = _linearised(target, starts, goal)
    damping = [1e-4] * len(best)
    active = [bool(f.free) for f in best]
    for _ in range(rounds):
        trial_of = [i for i, on in enumerate(active) if on]
        if not trial_of:
            break
        trials = [(_moved(best[i], damping[i]), best[i].free) for i in trial_of]
        for i, new in zip(trial_of, _linearised(target, trials, goal), strict=True):
            gain = best[i].misfit - new.misfit
            damping[i] *= 0.1 if gain > 0 else 10.0
            active[i] = damping[i] < 1e4 and not 0 <= gain <= SEEN * new.misfit and new.misfit > ROUNDING
            if gain > 0:
                best[i] = new
    return best


def fit_one(target: Target, variant: Variant, free: tuple[str, ...] = (), rounds: int = ROUNDS) -> Fit:
    """Fit one variant with its free numbers."""
    return fit(target, [(variant, free)], rounds)[0]


def explains(target: Target, variant: Variant) -> bool:
    """Whether a variant as it is leaves nothing but digits and noise."""
    return target.explained(fit_one(target, variant).residual)


def _linearised(target: Target, starts: Sequence[tuple[Variant, tuple[str, ...]]], goal: Array) -> list[Fit]:
    """Return the fits where they stand, with their Jacobians."""
    requested = [v for variant, free in starts for v in (variant, *(_nudged(variant, name) for name in free))]
    answers, fits, at = target.responses(requested), [], 0
    for variant, free in starts:
        base = answers[:, at]
        rates = [
            (answers[:, at + 1 + j] - base) / (NUDGE * SPAN[name] * _side(variant, name)) for j, name in enumerate(free)
        ]
        jacobian = np.column_stack(rates) if rates else np.empty((len(base), 0))
        residual = goal - base
        fits.append(Fit(variant, free, norm(residual), residual, jacobian))
        at += 1 + len(free)
    return fits


def _side(variant: Variant, name: str) -> float:
    """Return the side to which a number is nudged: away from its upper bound."""
    return -1.0 if getattr(variant, name) + SPAN[name] * NUDGE > bounds(name, variant)[1] else 1.0


def _nudged(variant: Variant, name: str) -> Variant:
    value = getattr(variant, name) + _side(variant, name) * NUDGE * SPAN[name]
    return changed(variant, {name: value})


def _moved(current: Fit, damping: float) -> Variant:
    """Return the variant one damped Gauss-Newton step on."""
    span = np.array([SPAN[name] for name in current.free])
    J = current.jacobian * span
    H = J.T @ J
    # keeps the equations of a number without effect solvable
    scale = np.diag(H) + ROUNDING * (np.max(np.diag(H)) or 1.0)
    step = np.linalg.solve(H + damping * np.diag(scale), J.T @ current.residual) * span
    changes = {
        name: float(np.clip(getattr(current.variant, name) + change, *bounds(name, current.variant)))
        for name, change in zip(current.free, step, strict=True)
    }
    return changed(current.variant, changes)


def bounds(name: str, variant: Variant) -> tuple[float, float]:
    """Return the range within sense of a free number of a variant."""
    if name == "spectral" and variant.family == "hht":
        return 0.0, LARGEST_ALPHA_F
    return NUMBERS[name].get("low", 1 / UNBOUNDED), NUMBERS[name].get("high", UNBOUNDED)


def is_factor(name: str) -> bool:
    """Whether a free number is a factor, without a range of its own."""
    return "low" not in NUMBERS[name]


def changed(variant: Variant, changes: Mapping[str, Any]) -> Variant:
    """Return a variant with some fields replaced."""
    return replace(variant, **changes)


def _directions(solution: Fit) -> tuple[float, Array, Array]:
    """Return the standard deviation of a row, singular values and directions of the Jacobian by spans."""
    span = np.array([SPAN[name] for name in solution.free])
    _, s, vt = np.linalg.svd(solution.jacobian * span, full_matrices=False)
    return solution.misfit / math.sqrt(max(solution.independent - len(solution.free), 1.0)), s, vt


def intervals(solution: Fit) -> dict[str, Interval]:
    """Return the 95 % interval of every free number; infinite where the data do not tell it."""
    sigma, s, vt = _directions(solution)
    is_determined = s > 1e-9 * max(float(np.max(s, initial=0.0)), 1e-300)
    spread = np.where(is_determined, 1 / np.where(is_determined, s, 1.0), np.inf)
    with np.errstate(invalid="ignore"):
        parts = np.where(np.abs(vt.T) > 1e-9, np.abs(vt.T) * spread, 0.0)
    widths = np.sqrt(np.sum(parts**2, axis=1))
    intervals_by_name = {}
    for name, width in zip(solution.free, widths.tolist(), strict=True):
        # nothing is known of a number without effect, also where nothing is left
        half = NORMAL_95 * sigma * width * SPAN[name] if math.isfinite(width) else math.inf
        intervals_by_name[name] = Interval(float(getattr(solution.variant, name)), half)
    return intervals_by_name


def untold(solution: Fit) -> list[dict[str, float]]:
    """Return the directions of the free numbers that the history does not tell, as shares of their spans."""
    sigma, s, vt = _directions(solution)
    return [
        {name: float(part) for name, part in zip(solution.free, direction, strict=True) if abs(part) > 0.2}
        for size, direction in zip(s, vt, strict=True)
        if NORMAL_95 * sigma > UNTOLD * size
    ]


def named(alpha: float, delta: float) -> str | None:
    """Return the name of a scheme."""
    for name, pair in NAMED.items():
        if math.isclose(alpha, pair[0], abs_tol=1e-12) and math.isclose(delta, pair[1], abs_tol=1e-12):
            return name
    return None
