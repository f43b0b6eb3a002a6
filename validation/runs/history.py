"""Histories: columns over time, one value a step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ArrayPair = tuple[Array, Array]
Complex = NDArray[np.complex128]
STRESS_ERROR = "stress_error"  # of a static solution of blocks in the plane
STRESSES = ("stress_xx", "stress_yy", "stress_xy")  # of the same, where they are observed
DISPLACEMENT = "displacement"
PRESSURE = "contact_pressure"


@dataclass(frozen=True)
class History:
    """Columns over time, one value per step from the first step on, each of the shape (steps,)."""

    time: Array  # of the steps [s]
    columns: Mapping[str, Array]  # displacement [m], contact_pressure [Pa], others
    between: History | None = None  # the same at more instants, of a motion that no time step enters

    @property
    def displacement(self) -> Array:
        """Vertical displacement v of the centroid point [m]."""
        return self.columns[DISPLACEMENT]

    @property
    def contact_pressure(self) -> Array:
        """Mean contact pressure [Pa], positive in compression."""
        return self.columns[PRESSURE]

    def until(self, duration: float) -> History:
        """Return the part up to a time [s]; the last step may exceed it by rounding only."""
        keep = self.time <= duration * (1 + 1e-9)
        columns = {name: values[keep] for name, values in self.columns.items()}
        return History(self.time[keep], columns, self.between and self.between.until(duration))
