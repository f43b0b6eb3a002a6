"""What is observed of glued blocks in the plane, by each of their solvers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from validation.models.plane.tables import PlaneSection, Point
from validation.runs.history import Array

MODES = 4  # that are reported


def observed_row(plane: PlaneSection, observer: Callable[[Point, Point], Array]) -> Array:
    """Return the row of the displacement that a scene observes."""
    observe = plane.observed
    rows = observer(*observe.place)
    for edge in observe.less:
        rows = rows - observer(*edge) / len(observe.less)
    return np.array(observe.direction) @ rows
