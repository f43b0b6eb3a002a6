"""Growth of a history, and what the largest eigenvalue of a step makes of it."""

from __future__ import annotations

import math

import numpy as np

from validation.metrics.measurable import Measurable
from validation.metrics.values import NOT_REPORTED, UNDEFINED
from validation.runs.history import Array, History
from validation.runs.row import Value
from validation.runs.run import Outcome, WordWithSentence

WINDOW = 4000  # steps at either end of a run in which the amplitudes of its modes are fitted
ROUNDING = 1e-9  # |radius - 1| within which a mode neither grows nor decays: a double root doubles the lost digits
DEVELOPED = 1e8  # growth over the first steps beyond which the other modes no longer disturb the measured rate
AGREED = 1e-2  # relative difference between growth seen and predicted: several modes may grow nearly alike
GROWN = (Outcome.UNSTABLE, Outcome.OVERFLOW, Outcome.MISPREDICTED, Outcome.UNBOUNDED)


class Stability(WordWithSentence):
    """What the largest eigenvalue of a step makes of a run; `sentence` says it in words."""

    STABLE = "stable", "Every mode decays: the spectral radius is below one."
    MARGINAL = "marginal", "No mode grows and at least one does not decay: the spectral radius is one."
    UNSTABLE = "unstable as predicted", "The spectral radius exceeds one and the numbers grow as it says."
    OVERFLOW = "overflow", "The spectral radius exceeds one and the numbers left the range of double precision."


def diagnosed(m: Measurable, key: str) -> Value:
    """Return a number of the solver's diagnostics."""
    value = m.diagnostics.get(key)
    if value is None:
        return NOT_REPORTED
    return float(value) if math.isfinite(value) else UNDEFINED


def kind_of_run(m: Measurable) -> Value:
    """Return the name of the predicted `Stability` of the run."""
    radius = diagnosed(m, "predicted_radius")
    return str(kind(radius, m.outcome)) if isinstance(radius, float) else NOT_REPORTED


def kind(radius: float, outcome: Outcome) -> Stability:
    """Name what a spectral radius makes of a run."""
    if outcome is Outcome.OVERFLOW:
        return Stability.OVERFLOW
    if radius > 1 + ROUNDING:
        return Stability.UNSTABLE
    return Stability.MARGINAL if radius >= 1 - ROUNDING else Stability.STABLE


def growth(values: Array) -> float | None:
    """Return the factor a step by which a history grows in the end, None where it has not grown by `DEVELOPED`.

    The last values are powers of a few roots; the largest is found by Prony's method on their scaled Hankel matrix.
    """
    y = values[: int(np.argmin(np.isfinite(values)))] if not np.all(np.isfinite(values)) else values
    if len(y) < 8 or not np.any(y):
        return None
    y = y / np.max(np.abs(y))
    if np.max(np.abs(y[:2])) * DEVELOPED > 1:
        return None
    # modulus of the largest root of the last values; a growing mode has one outside the unit circle, or a pair
    order = 2
    n = np.arange(len(y))[-6:]
    rate = float(np.max(np.abs(y)) / np.max(np.abs(y[:-1])))
    scaled = y[n] * rate ** (n[-1] - n).astype(float)
    hankel = np.lib.stride_tricks.sliding_window_view(scaled, order + 1)
    vectors, singular_values, _ = np.linalg.svd(hankel.T, full_matrices=False)
    signal_space = vectors[:, : min(order, int(np.sum(singular_values > 1e-11 * singular_values[0])))]
    roots = np.linalg.eigvals(np.linalg.lstsq(signal_space[:-1], signal_space[1:], rcond=None)[0])
    root = rate * float(np.max(np.abs(roots)))
    half = len(y) // 2
    mean = float(np.max(np.abs(y[-4:])) / np.max(np.abs(y[-4 - half : -half]))) ** (1 / half)
    # Many modes that grow alike are no two powers: their common rate is then all there is to see.
    return root if abs(root / mean - 1) < 5 * AGREED else mean


def growth_of_run(m: Measurable) -> Value:
    """Return the growth of a run that left its bounds; undefined where there is none."""
    if m.outcome not in GROWN or not m.history.columns:
        return UNDEFINED
    rate = growth(first_column(m.history))
    return UNDEFINED if rate is None else rate


def first_column(history: History) -> Array:
    """Return the first column, which shows whether a run grows."""
    return next(iter(history.columns.values()))


def drift(m: Measurable) -> Value:
    """Return the largest relative change of a mode's energy between the first and the last steps of a run.

    The amplitudes of all modes are fitted, at the numerical frequencies of the step, to each column about its static
    value; a mode counts in the column that shows it best. Undefined for short runs and modes that do not turn.
    """
    if not m.modes or not m.static:
        return NOT_REPORTED
    angles = np.array([np.angle(mode.eigenvalues[0]) for mode in m.modes])
    if len(m.history.time) < 2 * WINDOW or not np.all(np.abs(np.sin(angles)) > 1e-6):
        return UNDEFINED
    turns = np.outer(np.arange(WINDOW), angles)
    waves = np.concatenate([np.cos(turns), np.sin(turns)], axis=1)
    best = np.zeros((3, len(angles)))  # share of the static value; energy at the beginning and at the end
    for name, column in m.history.columns.items():
        y = column / m.static[name] - 1
        energy = [np.linalg.lstsq(waves, part, rcond=None)[0] ** 2 for part in (y[:WINDOW], y[-WINDOW:])]
        first, last = (part[: len(angles)] + part[len(angles) :] for part in energy)
        best = np.where(first > best[0], np.array([first, first, last]), best)
    return float(np.max(np.abs(best[2] / best[1] - 1)))


def limit(m: Measurable) -> Value:
    """Return the largest w dt that the code steps without growth."""
    return NOT_REPORTED if m.limit is None else m.limit()
