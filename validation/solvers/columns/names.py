"""The columns of a column's history: of its surface, of its base, and of the heights that a scene asks for."""

from __future__ import annotations

import itertools

from validation.errors import InputError
from validation.models.column.tables import MOST_HEIGHTS, NEAR, ColumnSection
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.scenes.scene import Scene

STRESS = "stress"
VELOCITY = "velocity"
FORCE = "force"
GAP = "gap"
SLIP = "slip"
BONDED = (DISPLACEMENT, STRESS)  # what a history may hold at each height
MOVING = (*BONDED, VELOCITY, FORCE, GAP, SLIP)  # and where contacts open or slip: the last three at a contact only


def at_heights(count: int, parts: tuple[str, ...] = BONDED) -> tuple[str, ...]:
    """Return the names of the columns at a number of heights."""
    return tuple(f"{part}_{n}" for part, n in itertools.product(parts, range(1, count + 1)))


AT_HEIGHTS = at_heights(MOST_HEIGHTS, MOVING)
OF_COLUMN = (DISPLACEMENT, PRESSURE, *at_heights(MOST_HEIGHTS))


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
    column = scene.table(ColumnSection)
    parts = BONDED if column.law == "bonded" else MOVING
    column_names = (DISPLACEMENT, PRESSURE, *at_heights(len(column.heights), parts))
    unknown = [name for name in scene.run.columns if name not in column_names]
    if unknown:
        raise InputError(
            f"must be among {', '.join(column_names)}", source=scene.name, field="run.columns", value=repr(unknown[0])
        )
    _check_contacts(scene, column)
    return column


def _check_contacts(scene: Scene, column: ColumnSection) -> None:
    """Refuse the force, gap or slip of a height that is no contact's."""
    faces = [contact.height for contact in column.contacts]
    for name in scene.run.columns:
        part, _, number = name.rpartition("_")
        if part in (FORCE, GAP, SLIP):
            height = column.heights[int(number) - 1]
            if all(abs(height - face) > NEAR * column.height for face in faces):
                raise InputError(
                    f"must be of a height where a contact is ({', '.join(f'{face:g}' for face in faces[:8])} m)",
                    source=scene.name,
                    field="run.columns",
                    value=f"{name} at {height:g} m",
                )
