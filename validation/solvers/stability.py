"""Stability: what one step does to the modes of a solver, predicted and seen, and the name of how that ends."""

from __future__ import annotations

import enum
import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from validation.runs.history import Array, History
from validation.runs.results import Value
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene
from validation.solvers.contract import NotReported, Solver

UNDEFINED, NOT_REPORTED = "undefined", "not reported"
METRICS = {  # metric -> key of a solver's diagnostics
    "stability.radius": "predicted_radius",
    "stability.radius_seen": "spectral_radius",
    "stability.condition": "condition_number",
    "stability.residual": "scaled_residual",
    "stability.omega": "largest_omega",
}
GROWTH, LIMIT, KIND, DRIFT = "stability.growth", "stability.limit", "stability.kind", "energy.drift"
WINDOW = 4000  # steps at either end of a run in which the amplitudes of its modes are fitted
ROUNDING = 1e-9  # |radius - 1| within which a mode neither grows nor decays: a double root doubles the lost digits
DEVELOPED = 1e8  # growth over the first steps beyond which the other modes no longer disturb the measured rate
AGREED = 1e-2  # relative difference between growth seen and predicted: several modes may grow nearly alike
BISECTIONS = 40


class Stability(enum.StrEnum):
    """What the largest eigenvalue of a step makes of a run; `sentence` says it in words."""

    STABLE = "stable"
    MARGINAL = "marginal"
    UNSTABLE = "unstable as predicted"
    OVERFLOW = "overflow"

    @property
    def sentence(self) -> str:
        """One sentence for a table or a report."""
        return _SENTENCES[self]


_SENTENCES = {
    Stability.STABLE: "Every mode decays: the spectral radius is below one.",
    Stability.MARGINAL: "No mode grows and at least one does not decay: the spectral radius is one.",
    Stability.UNSTABLE: "The spectral radius exceeds one and the numbers grow as it says.",
    Stability.OVERFLOW: "The spectral radius exceeds one and the numbers left the range of double precision.",
}


def measure(solver: Solver, scene: Scene, run: Run) -> dict[str, Value]:
    """Return spectral radius (predicted and seen), growth, condition number, residual and the outcome's name."""
    found = _diagnostics(solver, scene)
    values: dict[str, Value] = {name: _number(found.get(key)) for name, key in METRICS.items()}
    values[GROWTH] = _growth_of(run)
    radius = values["stability.radius"]
    values[KIND] = str(kind(radius, run.outcome)) if isinstance(radius, float) else NOT_REPORTED
    return values


def _number(value: float | None) -> Value:
    if value is None:
        return NOT_REPORTED
    return float(value) if math.isfinite(value) else UNDEFINED


def _diagnostics(solver: Solver, scene: Scene) -> Mapping[str, float]:
    try:
        with np.errstate(all="ignore"):
            return solver.diagnostics(scene)
    except NotReported:
        return {}


def kind(radius: float, outcome: Outcome) -> Stability:
    """Name what a spectral radius makes of a run."""
    if outcome is Outcome.OVERFLOW:
        return Stability.OVERFLOW
    if radius > 1 + ROUNDING:
        return Stability.UNSTABLE
    return Stability.MARGINAL if radius >= 1 - ROUNDING else Stability.STABLE


def growth(values: Array) -> float | None:
    """Return the factor a step that a history grows by in the end, or None where it has not grown by `DEVELOPED`.

    The last values are powers of a few roots; the largest is found by Prony's method on their scaled Hankel matrix.
    """
    y = values[: int(np.argmin(np.isfinite(values)))] if not np.all(np.isfinite(values)) else values
    if len(y) < 8 or not np.any(y):
        return None
    y = y / np.max(np.abs(y))
    if np.max(np.abs(y[:2])) * DEVELOPED > 1:
        return None
    order = 2  # a growing mode has one root outside the unit circle, or a pair
    n = np.arange(len(y))[-6:]
    rate = float(np.max(np.abs(y)) / np.max(np.abs(y[:-1])))
    scaled = y[n] * rate ** (n[-1] - n).astype(float)
    hankel = np.lib.stride_tricks.sliding_window_view(scaled, order + 1)
    left, size, _ = np.linalg.svd(hankel.T, full_matrices=False)
    kept = left[:, : min(order, int(np.sum(size > 1e-11 * size[0])))]
    roots = np.linalg.eigvals(np.linalg.lstsq(kept[:-1], kept[1:], rcond=None)[0])
    root = rate * float(np.max(np.abs(roots)))
    half = len(y) // 2
    mean = float(np.max(np.abs(y[-4:])) / np.max(np.abs(y[-4 - half : -half]))) ** (1 / half)
    # Many modes that grow alike are no two powers: their common rate is then all there is to see.
    return root if abs(root / mean - 1) < 5 * AGREED else mean


def _growth_of(run: Run) -> Value:
    """Return the growth of a run that left its bounds, or say that there is none."""
    if run.outcome not in (Outcome.UNSTABLE, Outcome.OVERFLOW, Outcome.MISPREDICTED) or run.history is None:
        return UNDEFINED
    rate = growth(_first_column(run.history))
    return UNDEFINED if rate is None else rate


def _first_column(history: History) -> Array:
    return next(iter(history.columns.values()))


def named(run: Run, solver: Solver, scene: Scene) -> Run:
    """Return the run with the outcome that an unstable step deserves, growth seen against growth predicted."""
    if run.outcome not in (Outcome.COMPLETED, Outcome.OVERFLOW) or run.history is None:
        return run
    radius = _diagnostics(solver, scene).get("predicted_radius", 0.0)
    if not radius > 1 + ROUNDING:
        return run
    seen = growth(_first_column(run.history))
    if seen is not None:  # a slower mode may hold so much more of the motion that it leads until the last step
        radius = min((radius, *(mode.spectral_radius for mode in solver.modes(scene))), key=lambda r: abs(r - seen))
    said = f"predicted growth {radius:.9g} a step"
    if seen is None:
        slow = scene.time.steps * math.log10(radius) < 3 * math.log10(DEVELOPED)
        short = run.outcome is Outcome.OVERFLOW or not np.any(_first_column(run.history))
        outcome = run.outcome if slow or short else Outcome.MISPREDICTED
        return replace(run, outcome=outcome, notes=(*run.notes, f"{said}, not to be seen in so few steps"))
    if abs(seen / radius - 1) > AGREED:
        return replace(run, outcome=Outcome.MISPREDICTED, notes=(*run.notes, f"{said}, seen {seen:.9g}"))
    ended = Outcome.OVERFLOW if run.outcome is Outcome.OVERFLOW else Outcome.UNSTABLE
    return replace(run, outcome=ended, notes=(*run.notes, f"{said}, seen {seen:.9g}"))


def limit(solver: Solver, scene: Scene) -> Value:
    """Return the largest w dt that the code steps without growth, by bisection on the step's own eigenvalues.

    The step is applied to unit states of the modes; no formula of the limit enters. Undefined without a limit.
    """
    try:
        omega = solver.diagnostics(scene)["largest_omega"] / scene.time.step
    except NotReported:
        return NOT_REPORTED

    def grows(value: float) -> bool:
        tried = scene.with_values({"time.step": value / omega})
        return bool(solver.diagnostics(tried)["spectral_radius"] > 1 + ROUNDING)

    low, high = 1e-2, 1e3
    if grows(low) or not grows(high):
        return UNDEFINED
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if grows(middle) else (middle, high)
        if high / low < 1 + 1e-8:
            break
    return math.sqrt(low * high)


def drift(solver: Solver, scene: Scene, run: Run) -> Value:
    """Return the largest relative change of a mode's energy between the first and the last steps of a run.

    The amplitudes of all modes are fitted, at the numerical frequencies of the step, to each column about its static
    value; a mode counts in the column that shows it best. Undefined for short runs and for modes that do not turn.
    """
    try:
        static, modes = solver.static(scene), solver.modes(scene)
    except NotReported:
        return NOT_REPORTED
    angles = np.array([np.angle(mode.eigenvalues[0]) for mode in modes])
    if run.history is None or len(run.history.time) < 2 * WINDOW or not np.all(np.abs(np.sin(angles)) > 1e-6):
        return UNDEFINED
    turns = np.outer(np.arange(WINDOW), angles)
    waves = np.concatenate([np.cos(turns), np.sin(turns)], axis=1)
    best = np.zeros((3, len(angles)))  # share of the static value; energy at the beginning and at the end
    for name, column in run.history.columns.items():
        y = column / static[name] - 1
        energy = [np.linalg.lstsq(waves, part, rcond=None)[0] ** 2 for part in (y[:WINDOW], y[-WINDOW:])]
        first, last = (part[: len(angles)] + part[len(angles) :] for part in energy)
        best = np.where(first > best[0], np.array([first, first, last]), best)
    return float(np.max(np.abs(best[2] / best[1] - 1)))
