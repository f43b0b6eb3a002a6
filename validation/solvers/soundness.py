r"""Whether a history is sound: one finite number for each step, and no motion that the scene could not have driven.

What neither creates energy nor takes it from elsewhere (springs, closed, open or slipping contacts, damping) moves no
faster than its load alone would drive it: with E the energy of a body of mass m under a force F in the frame of its
base, dE/dt <= (|F| + m |y''|) v and v <= sqrt(2 E / m), so that

    s = sqrt(2 E / m),   s' <= |F| / m + |y''|,   |u| <= s0 T + |F| T^2 / (2 m) + T integral |y''| dt + max |y|.

A history beyond `MARGIN` times that bound is unbounded growth, whatever made it.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from validation.errors import InputError
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene
from validation.solvers.hooks import SolvingHooks

# The bound is of the mean over the body: a point may move further by the square root of the mass over that of its
# surroundings, and a scheme overshoots in its first steps. A growing step passes a thousandfold at once.
MARGIN = 1e3
ROUNDING = float(np.finfo(float).eps)  # part of its size that stands for the displacement of a body at rest
TINY = float(np.finfo(float).tiny)  # what stands for a mass or modulus that underflows
LENGTHS = ("displacement", "horizontal_displacement", "gap_", "slide_", "largest_")  # columns in m begin so


def checked(run: Run, scene: Scene) -> Run:
    """Check a run's history against its scene; a defect replaces the outcome."""
    if run.history is None or run.outcome is not Outcome.COMPLETED:
        return run
    steps = scene.time.steps
    for name in ("time", *scene.run.columns):
        values = run.history.time if name == "time" else run.history.columns.get(name)
        if values is None:
            continue
        if np.shape(values) != (steps,):
            return _failed(run, Outcome.WRONG_SHAPE, f"{name} has shape {np.shape(values)}, not ({steps},)")
        if np.isnan(values).any():
            return _failed(run, Outcome.NOT_A_NUMBER, f"{name} at step {int(np.argmax(np.isnan(values))) + 1}")
        if np.isinf(values).any():
            return _failed(run, Outcome.OVERFLOW, f"{name} at step {int(np.argmax(np.isinf(values))) + 1}")
    largest = MARGIN * reach(scene)
    for name in scene.run.columns:
        values = run.history.columns.get(name)
        if values is None or not name.startswith(LENGTHS):
            continue
        beyond = np.abs(values) > largest
        if beyond.any():
            step = int(np.argmax(beyond)) + 1
            note = f"{name} exceeds {largest:.3g} m, {MARGIN:g} times what the load can do, at step {step}"
            return _failed(run, Outcome.UNBOUNDED, note)
    return run


def _failed(run: Run, outcome: Outcome, note: str) -> Run:
    return replace(run, outcome=outcome, notes=(*run.notes, note))


def reach(scene: Scene) -> float:
    """Return the bound of the displacement that the load and the given energy of a scene can drive [m].

    It is infinite where the motion of the base cannot be read: the solver that ran the scene has not read it either;
    of rigid boxes, whose columns are positions, and of blocks in the plane.
    """
    with np.errstate(all="ignore"):
        try:
            bound = SolvingHooks.of(scene).reach(scene)
        except InputError:
            return math.inf
    return math.inf if math.isnan(bound) else bound
