"""The columns of a column's history: of its surface, of its base, and of the heights that a scene asks for."""

from __future__ import annotations

from validation.errors import InputError
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.scenes.column import MOST_HEIGHTS, ColumnSection
from validation.scenes.scene import Scene

STRESS = "stress"
AT_HEIGHTS = tuple(f"{part}_{number + 1}" for part in (DISPLACEMENT, STRESS) for number in range(MOST_HEIGHTS))
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
        raise InputError(f"{scene.name}: column: is needed for what is asked, got a scene of a block")
    count = len(scene.column.heights)
    known = (DISPLACEMENT, PRESSURE, *(f"{part}_{n + 1}" for part in (DISPLACEMENT, STRESS) for n in range(count)))
    unknown = [name for name in scene.run.columns if name not in known]
    if unknown:
        raise InputError(f"{scene.name}: run.columns: must be among {', '.join(known)}, got {unknown[0]!r}")
    return scene.column
