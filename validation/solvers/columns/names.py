"""The columns of a column's history: of its surface, of its base, and of the heights that a scene asks for."""

from __future__ import annotations

import numpy as np

from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.scenes.column import MOST_HEIGHTS, ColumnSection
from validation.scenes.scene import Scene

STRESS = "stress"
AT_HEIGHTS = tuple(f"{part}_{number + 1}" for part in (DISPLACEMENT, STRESS) for number in range(MOST_HEIGHTS))
OF_COLUMN = (DISPLACEMENT, PRESSURE, *AT_HEIGHTS)


def column_of(scene: Scene) -> ColumnSection:
    """Return the column of a scene, whose columns of the history are checked.

    Raises
    ------
    InputError
        The scene has a block, or asks for the history of a height that it does not give.
    """
    if scene.column is None:
        raise InputError(f"{scene.name}: column: is needed for what is asked, got a scene of a block")
    count = len(scene.column.heights)
    known = (DISPLACEMENT, PRESSURE, *(f"{part}_{n + 1}" for part in (DISPLACEMENT, STRESS) for n in range(count)))
    unknown = [name for name in scene.run.columns if name not in known]
    if unknown:
        raise InputError(f"{scene.name}: run.columns: must be among {', '.join(known)}, got {unknown[0]!r}")
    return scene.column


def vibration(scene: Scene, frequencies: Array) -> tuple[bool, float]:
    """Return whether a column answers to its base, per metre, and else the pressure on its top [Pa].

    Raises
    ------
    InputError
        A frequency is zero, at which a half-space does not hold the column.
    """
    if np.any(np.asarray(frequencies) == 0):
        raise InputError(f"{scene.name}: frequencies: must be greater than 0 for a column, got 0")
    pressure = scene.input.pressure
    return scene.input.at == "base", 1.0 if pressure is None else pressure
