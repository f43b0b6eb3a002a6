"""Motion of the base of the block."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """Displacement of the foundation's fixed side, piecewise linear, held beyond both ends of its record."""

    time: tuple[float, ...]  # instants [s], increasing
    x: tuple[float, ...]  # displacement at the instants [m]
    y: tuple[float, ...]  # the same [m]

    def __post_init__(self) -> None:
        if not len(self.time) == len(self.x) == len(self.y) > 0:
            raise ValueError(f"motion: must give x and y for every instant, got {len(self.time)} instants")
        if not np.all(np.isfinite([self.time, self.x, self.y])) or np.any(np.diff(self.time) <= 0):
            raise ValueError("motion: must hold finite numbers at increasing instants, got other values")

    def __call__(self, instants: Array) -> Array:
        """Displacement (x, y) at some instants, shape (count, 2) [m]."""
        return np.stack([np.interp(instants, self.time, part) for part in (self.x, self.y)], axis=1)

    @property
    def sideways(self) -> bool:
        """Whether the base ever moves in x."""
        return any(self.x)


def moved_base(motion: Motion | None, positions: Array, times: Array) -> Array:
    """Displacement of a base in x and y at the ends of the stages, shape (steps, stages, 2) [m]; zero without motion.

    `positions` are those of the steps [steps], `times` those of the ends of their stages [s], shape (steps, stages).
    """
    if motion is None:
        return np.zeros((*times.shape, 2))
    return motion(times.ravel()).reshape(*times.shape, 2)
