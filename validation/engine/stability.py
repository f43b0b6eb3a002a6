"""How an unstable step ends by name, and the limit of stability found by bisection; both ask the prepared model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from validation.metrics.growth import AGREED, DEVELOPED, ROUNDING, first_column, growth
from validation.metrics.values import NOT_REPORTED, UNDEFINED
from validation.runs.row import Value
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene
from validation.solvers.contract import NotReported, Prepared, Solver

BISECTIONS = 40


def _diagnostics(prepared: Prepared) -> Mapping[str, float]:
    try:
        with np.errstate(all="ignore"):
            return prepared.diagnostics()
    except NotReported:
        return {}


def with_growth_outcome(run: Run, prepared: Prepared, scene: Scene) -> Run:
    """Return the run with the outcome that an unstable step deserves, growth seen against growth predicted.

    One that ended otherwise than by its growth is returned as it is.
    """
    if run.outcome not in (Outcome.COMPLETED, Outcome.OVERFLOW, Outcome.UNBOUNDED) or run.history is None:
        return run
    radius = _diagnostics(prepared).get("predicted_radius", 0.0)
    if not radius > 1 + ROUNDING:
        return run
    measured_growth = growth(first_column(run.history))
    if measured_growth is None:
        return _too_short_to_measure(run, scene, radius)
    # A slower mode may hold so much more of the motion that it leads until the last step.
    radius = min((radius, *(mode.spectral_radius for mode in prepared.modes())), key=lambda r: abs(r - measured_growth))
    note = f"predicted growth {radius:.9g} per step, measured {measured_growth:.9g}"
    if abs(measured_growth / radius - 1) > AGREED:
        return replace(run, outcome=Outcome.MISPREDICTED, notes=(*run.notes, note))
    ended = Outcome.OVERFLOW if run.outcome is Outcome.OVERFLOW else Outcome.UNSTABLE
    return replace(run, outcome=ended, notes=(*run.notes, note))


def _too_short_to_measure(run: Run, scene: Scene, radius: float) -> Run:
    """Name a run that should grow and has not grown enough to measure how fast."""
    is_slow = scene.time.steps * math.log10(radius) < 3 * math.log10(DEVELOPED)
    is_at_rest = run.history is None or not np.any(first_column(run.history))
    outcome = run.outcome if is_slow or is_at_rest or run.outcome is Outcome.OVERFLOW else Outcome.MISPREDICTED
    note = f"predicted growth {radius:.9g} per step; too few steps to measure growth"
    return replace(run, outcome=outcome, notes=(*run.notes, note))


def limit(solver: Solver, scene: Scene) -> Value:
    """Return the largest w dt that the code steps without growth, by bisection on the step's own eigenvalues.

    The step is applied to unit states of the modes; no formula of the limit enters. Undefined without a limit.
    """
    try:
        omega = solver.prepare(scene).diagnostics()["largest_omega"] / scene.time.step
    except NotReported:
        return NOT_REPORTED

    def grows(value: float) -> bool:
        prepared = solver.prepare(scene.with_values({"time.step": value / omega}))
        return bool(prepared.diagnostics()["spectral_radius"] > 1 + ROUNDING)

    low = 1e-2
    high = 1e3
    if grows(low) or not grows(high):
        return UNDEFINED
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        if grows(middle):
            high = middle
        else:
            low = middle
        if high / low < 1 + 1e-8:
            break
    return math.sqrt(low * high)
