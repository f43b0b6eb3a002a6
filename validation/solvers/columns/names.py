"""The columns of a column's history: of its surface, of its base, and of the heights that a scene asks for."""

from __future__ import annotations

import itertools

from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.scenes.column import MOST_HEIGHTS, ColumnSection
from validation.scenes.scene import Scene

STRESS = "stress"


def at_heights(count: int) -> tuple[str, ...]:
    """Return the names of displacement and stress at a number of heights."""
    return tuple(f"{part}_{n}" for part, n in itertools.product((DISPLACEMENT, STRESS), range(1, count + 1)))


AT_HEIGHTS = at_heights(MOST_HEIGHTS)
OF_COLUMN = (DISPLACEMENT, PRESSURE, *AT_HEIGHTS)


def amplitude(scene: Scene) -> float:
    """Return the size of a vibration: 1 m at the base; on the top the pulse's pressure, or 1 Pa under a record."""
    drive = scene.input
    return float(drive.pressure) if drive.at == "top" and drive.pressure is not None else 1.0


def column_of(scene: Scene) -> ColumnSection:
    """Return the column of a scene, whose columns of the history are checked.

    Raises
    ------
    InputError
        The scene has a block, or asks for the history of a height that it does not give.
    """
    if scene.column is None:
        raise InputError("is needed for what is asked", source=scene.name, field="column", value="a scene of a block")
    column_names = (DISPLACEMENT, PRESSURE, *at_heights(len(scene.column.heights)))
    unknown = [name for name in scene.run.columns if name not in column_names]
    if unknown:
        raise InputError(
            f"must be among {', '.join(column_names)}", source=scene.name, field="run.columns", value=repr(unknown[0])
        )
    return scene.column
