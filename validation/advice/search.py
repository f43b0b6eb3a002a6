"""A search for all values of one parameter that give a function its target: a root between two samples around it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from validation.runs.history import Array, ArrayPair

FLAT = 1e-12  # relative; smaller turns of a function are rounding, not extrema
HALVINGS = 100  # of an interval in which a function ends to be defined: to the last bit


@dataclass(frozen=True)
class Search:
    """A one-parameter search: the damping ratio xi over a coordinate s, and the scene's settings there."""

    grid: Array  # coordinates, increasing
    xi: Callable[[Array], Array]  # damping ratios [1], NaN where a root is not positive
    value: Callable[[float], float]  # dt [s], gg [1] or delta [1] at a coordinate
    settings: Callable[[float], dict[str, float]]  # for Scene.with_values
    flat: float = FLAT  # relative size of turns that are rounding

    @cached_property
    def samples(self) -> ArrayPair:
        """Coordinates and xi: the grid, its extrema refined, and the last ones at which xi is defined."""
        ratios = self._ratios(self.grid)
        slopes = np.diff(ratios)
        bends = np.abs(np.diff(slopes)) > self.flat * np.abs(ratios[1:-1]) + np.finfo(float).eps
        turns = 1 + np.flatnonzero((slopes[1:] * slopes[:-1] <= 0) & bends)
        cuts = np.flatnonzero(np.diff(np.isfinite(ratios)))
        refined = [*map(self._extremum, turns.tolist()), *map(self._edge, cuts.tolist())]
        coordinates = np.unique([*self.grid, *refined])
        return coordinates, self._ratios(coordinates)

    def _ratios(self, coordinates: Array) -> Array:
        """Return xi, NaN wherever it is not finite."""
        ratios = self.xi(coordinates)
        return np.where(np.isfinite(ratios), ratios, np.nan)

    def _edge(self, i: int) -> float:
        """Return the last coordinate between two neighbours of the grid at which xi is defined."""
        inside, outside = self.grid[i : i + 2] if np.isfinite(self.at(self.grid[i])) else self.grid[i : i + 2][::-1]
        for _ in range(HALVINGS):
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if np.isfinite(self.at(middle)) else (inside, middle)
        return float(inside)

    def _extremum(self, i: int) -> float:
        """Return where xi turns next to a point of the grid."""
        from scipy.optimize import minimize_scalar

        sign = np.sign(self.at(self.grid[i - 1]) - self.at(self.grid[i])) or 1.0
        bounds = self.grid[[i - 1, i + 1]]
        best = minimize_scalar(lambda s: sign * self.at(s), bounds=bounds, method="bounded", options={"xatol": 1e-14})
        return float(min(best.x, self.grid[i], key=lambda s: sign * self.at(s)))

    def at(self, s: float) -> float:
        """Return xi at one coordinate."""
        return float(self.xi(np.array([s]))[0])

    def solutions(self, target: float) -> list[float]:
        """Return all coordinates at which xi is the target."""
        from scipy.optimize import brentq

        coordinates, ratios = self.samples
        excess = ratios - target
        is_passed = (excess[1:] * excess[:-1] <= 0) & (np.abs(excess[1:]) + np.abs(excess[:-1]) > 0)
        roots: list[float] = []
        for i in np.flatnonzero(is_passed):
            ends = coordinates[i : i + 2]
            root = brentq(lambda s: self.at(s) - target, *ends, xtol=1e-300, rtol=4 * np.finfo(float).eps)
            # a root at a sample belongs to both of its neighbours
            if not roots or not math.isclose(self.value(root), self.value(roots[-1]), rel_tol=1e-12):
                roots.append(root)
        return roots
