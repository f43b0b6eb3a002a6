"""The forces that `compare` reads off a motion with friction, against those of the solver that made it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from validation import load_scene, solve
from validation.diagnosis.forces.laws import body_of, follow, motion_of

SLOPE = load_scene(Path(__file__).parents[2] / "docs" / "examples" / "ntdda" / "slope.toml")
PLACE = ("horizontal_displacement", "displacement")
SHEAR, NORMAL, GAP, STATE = (
    tuple(f"{name}_{corner}" for corner in "mn") for name in ("shear_force", "normal_force", "gap", "state")
)
COLUMNS = (*PLACE, *SHEAR, *NORMAL, *GAP, *STATE)
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
LAGGED = {"contact.rules": "lagged", "contact.cohesion": 1e4}
SHORT = {"time.step": 2e-4, "time.steps": 400}  # corners open
TIPPED = SHORT | {"load.pressure": 3e6, "load.eccentricity": -0.9}
LOW = {"block.width": 2.0, "block.height": 1.5, "load.pressure": 4e5}
CASES: list[dict[str, Any]] = [
    {"time.gg": 0.98, "load.pressure": 2e5} | AVERAGE,
    {"block.poisson": 0.25, "block.hypothesis": "plane strain", "contact.cohesion": 2e4},
    LOW | {"load.eccentricity": -0.3},
    LOW | {"load.traction": 5e4},
    LAGGED,
    SHORT,
    TIPPED,
]


@pytest.mark.parametrize("values", CASES)
def test_the_forces_of_a_motion_are_those_of_its_solver(values: dict[str, Any]) -> None:
    scene = SLOPE.with_values({"time.steps": 150, "run.columns": [*COLUMNS]} | values)
    history = solve(scene, "dda").history
    assert history is not None
    shear, normal, gap, state = (pair_of(history.columns, names) for names in (SHEAR, NORMAL, GAP, STATE))
    body = body_of(scene)
    motion = motion_of(pair_of(history.columns, PLACE), scene.time, body)
    found = follow(body, motion, lagged=scene.contact.rules == "lagged")
    size = 1e-7 * found.scale
    assert np.any(np.abs(state) == 2) and found.settled.mean() > 0.9
    assert np.max(np.abs(found.motion_forces - np.column_stack([shear.sum(axis=1), normal.sum(axis=1)]))) <= size
    assert np.array_equal(found.closed, state != 0)
    assert np.max(np.abs(found.gap - gap)) * body.stiffness <= size
    # where a corner lands within a step the law is met to some share of what it holds there, and from then on
    unbalanced = np.abs(found.law_forces - found.motion_forces)[found.settled]
    landing = int(np.argmin(found.settled[1:])) + 1 if not found.settled[1:].all() else len(found.settled)
    assert np.max(unbalanced[: landing - 1]) <= size and np.max(unbalanced) <= 1000 * size


def pair_of(columns: Any, names: tuple[str, ...]) -> np.ndarray:
    return np.column_stack([columns[name] for name in names])
