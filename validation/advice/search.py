"""A search for all values of one parameter that give a function its target: monotone pieces, one root in each."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from validation.runs.history import Array

FLAT = 1e-12  # relative; smaller turns of a function are rounding, not extrema


@dataclass(frozen=True)
class Search:
    """A one-parameter search: the damping ratio xi over a coordinate s, and the scene's settings there."""

    grid: Array  # coordinates, increasing
    xi: Callable[[Array], Array]  # damping ratios [1], NaN where a root is not positive
    value: Callable[[float], float]  # dt [s], gg [1] or delta [1] at a coordinate
    settings: Callable[[float], dict[str, float]]  # for Scene.with_values
    flat: float = FLAT  # relative size of turns that are rounding

    @cached_property
    def pieces(self) -> list[tuple[float, float]]:
        """Intervals of s on which xi is defined and monotone."""
        pieces: list[tuple[float, float]] = []
        for s in self._defined():
            extrema = (self._extremum(s, i) for i in _turning_points(self.xi(s), self.flat))
            ends = [float(s[0]), *extrema, float(s[-1])]
            pieces += [(a, b) for a, b in itertools.pairwise(ends) if b > a]
        return pieces

    def _defined(self) -> list[Array]:
        """Cut the grid where xi is not defined; the cuts are exact to the last bit."""
        is_defined = np.isfinite(self.xi(self.grid))
        cuts = np.flatnonzero(is_defined[1:] != is_defined[:-1])
        edges = [self._edge(float(self.grid[i]), float(self.grid[i + 1]), bool(is_defined[i])) for i in cuts]
        parts = []
        for k, part in enumerate(np.split(self.grid, cuts + 1)):
            if bool(is_defined[0]) == (k % 2 == 0):  # defined and undefined parts take turns
                parts.append(np.unique([*edges[max(k - 1, 0) : k], *part, *edges[k : k + 1]]))
        return parts

    def _edge(self, a: float, b: float, defined_at_a: bool) -> float:
        """Last coordinate of [a, b] at which xi is defined."""
        inside, outside = (a, b) if defined_at_a else (b, a)
        for _ in range(200):
            middle = (inside + outside) / 2
            if middle in (inside, outside):
                break
            defined = bool(np.isfinite(self.at(middle)))
            inside, outside = (middle, outside) if defined else (inside, middle)
        return inside

    def _extremum(self, s: Array, i: int) -> float:
        """Refine a turning point of the grid."""
        from scipy.optimize import minimize_scalar

        y = self.xi(s[i - 1 : i + 2])
        sign = -1.0 if y[1] >= max(y[0], y[2]) else 1.0
        bounds = (float(s[i - 1]), float(s[i + 1]))
        best = minimize_scalar(lambda x: sign * self.at(x), bounds=bounds, method="bounded", options={"xatol": 1e-14})
        return float(best.x) if sign * self.at(best.x) <= sign * y[1] else float(s[i])

    def at(self, s: float) -> float:
        """Return xi at one coordinate."""
        return float(self.xi(np.array([s]))[0])

    def solutions(self, target: float) -> list[float]:
        """Return all coordinates at which xi is the target."""
        from scipy.optimize import brentq

        roots: list[float] = []
        for a, b in self.pieces:
            low = self.at(a) - target
            high = self.at(b) - target
            if low * high <= 0 and (low or high):
                root = float(brentq(lambda s: self.at(s) - target, a, b, xtol=1e-300, rtol=4 * np.finfo(float).eps))
                # A root where two pieces meet belongs to both.
                if not roots or not math.isclose(self.value(root), self.value(roots[-1]), rel_tol=1e-12):
                    roots.append(root)
        return roots

    def ends(self) -> list[float]:
        """Return the ends of all pieces, where xi is least and greatest; none where it is nowhere defined."""
        return list(itertools.chain(*self.pieces))


def _turning_points(y: Array, flat: float) -> list[int]:
    """Indices of the local extrema, turns within rounding left out."""
    steps = np.sign(np.diff(y))
    candidates = np.flatnonzero(steps[1:] * steps[:-1] <= 0) + 1
    extrema: list[int] = []
    low = high = 0
    rising: bool | None = None  # None until the first change that is more than rounding
    for i in [*candidates.tolist(), len(y) - 1]:
        size = flat * max(abs(y[i]), abs(y[high]), abs(y[low]))
        high = i if y[i] > y[high] else high
        low = i if y[i] < y[low] else low
        if rising is not False and y[high] - y[i] > size:
            extrema.append(high)
            rising = False
            low = i
        elif rising is not True and y[i] - y[low] > size:
            extrema.append(low)
            rising = True
            high = i
    return [i for i in extrema if 0 < i < len(y) - 1]
