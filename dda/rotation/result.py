"""What is read from the history of a block that turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dda.one_block.gap_form import COLUMNS
from dda.one_block.solution import Result
from dda.rotation.body import Body, positions, strain_matrix
from dda.rotation.energy import Ledger
from dda.rotation.step import Part, Setting, State

Array = NDArray[np.float64]


def observed(body: Body, start: State, states: Sequence[State]) -> dict[str, Array]:
    """Return all of `dda.COLUMNS`."""
    out = body.to_base.T
    moved = stacked([s.c - start.c for s in states], 2) @ out.T
    e = stacked([s.e for s in states], 3)
    own = np.array([[e[:, 0], e[:, 2] / 2], [e[:, 2] / 2, e[:, 1]]])
    E = np.einsum("ai,ijk,bj->abk", out, own, out)
    normal = stacked([s.touch.normal for s in states], len(body.xi))
    a = float(np.hypot(*(body.xi[body.base[1]] - body.xi[body.base[0]])))
    values = (
        moved[:, 1],
        normal.sum(axis=1) / a,
        moved[:, 0],
        np.array([s.r for s in states]),
        E[0, 0],
        E[1, 1],
        2 * E[0, 1],
    )
    return dict(zip(COLUMNS, values, strict=True))


def stacked(rows: Sequence[Array], width: int) -> Array:
    """Return rows as an array, (len(rows), width), also where there are none."""
    return np.array(rows).reshape(len(rows), width)


@dataclass(frozen=True, eq=False)
class RollingResult(Result):
    """Histories of the steps that were reached; element 0 is step 1. Forces act on the block."""

    outcome: str  # "completed", or why the history ends early, in words
    setting: Setting
    parts: list[Part]  # the state at t = 0, then all that was made
    ends: list[int]  # part with which each step ends
    step_solves: NDArray[np.int_]  # of each step, repeated and cut ones included
    step_cuts: NDArray[np.int_]  # times that a step was cut

    @cached_property
    def states(self) -> list[State]:
        """At the end of every step."""
        return [self.parts[end].state for end in self.ends]

    def of_points(self, name: str) -> Array:
        """Return a field of `dda.rotation.step.Touch` of all corners, (corners, steps)."""
        rows = [getattr(state.touch, name) for state in self.states]
        return stacked(rows, len(self.setting.body.xi)).T

    @property
    def base(self) -> list[int]:
        """Corners M and N."""
        return list(self.setting.body.base)

    @cached_property
    def normal(self) -> Array:
        """N at every corner, (corners, steps) [N]."""
        return self.of_points("normal")

    @cached_property
    def shear(self) -> Array:
        """T at every corner, (corners, steps) [N]."""
        return self.of_points("shear")

    @cached_property
    def gap(self) -> Array:
        """W of every corner, (corners, steps) [m]."""
        return self.of_points("gap")

    @cached_property
    def impulse(self) -> Array:
        """Integral of the sum of N from t = 0 on, as the scheme takes it, (steps,) [N s]."""
        N = np.array([float(part.state.touch.normal.sum()) for part in self.parts])
        h, late = np.array([(part.scheme.step, part.scheme.delta) for part in self.parts]).T
        given = np.cumsum(h[1:] * ((1 - late[1:]) * N[:-1] + late[1:] * N[1:]))
        summed: Array = given[np.array(self.ends, dtype=int) - 1]
        return summed

    @cached_property
    def slip(self) -> Array:
        """Largest movement of the shear reference of any corner by slip, summed while it was closed, (steps,) [m]."""
        moved = np.cumsum([np.abs(part.state.touch.slipped) for part in self.parts], axis=0)
        summed: Array = moved[np.array(self.ends, dtype=int)].max(axis=1)
        return summed

    @cached_property
    def slide(self) -> Array:
        """Displacement of every corner along the base, less that of the base, (corners, steps) [m]."""
        own, first = self.setting.body.xi, self.parts[0]
        start = positions(first.state.c, first.state.Q, first.state.e, own)[:, 0] - first.base[0]
        carried = np.array([self.parts[end].base[0] for end in self.ends])
        moved: Array = (self.outline[:, :, 0] - carried[:, None] - start).T
        return moved

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """State of M and N, (2, steps)."""
        return self.of_points("closed").astype(bool)[self.base]

    @cached_property
    def outline(self) -> Array:
        """Corners in the frame of the base, (steps, corners, 2) [m]."""
        own = self.setting.body.xi
        return np.array([positions(s.c, s.Q, s.e, own) for s in self.states]).reshape(-1, len(own), 2)

    @cached_property
    def area(self) -> Array:
        """Area of the outline over that of the start, (steps,) [-]."""
        return np.array([np.linalg.det(s.Q) * np.linalg.det(np.eye(2) + strain_matrix(s.e)) for s in self.states])

    @property
    def velocity(self) -> Array:
        """Of the centroid, along +y of the block's coordinates [m/s]."""
        return self._velocities[:, 1]

    @property
    def spin(self) -> Array:
        """Rate of rotation [rad/s]."""
        return np.array([s.V[2] for s in self.states])

    @cached_property
    def _velocities(self) -> Array:
        return stacked([s.V[:2] for s in self.states], 2) @ self.setting.body.to_base

    @cached_property
    def energies(self) -> dict[str, Array]:
        """By `dda.rotation.energy.ENERGIES` [J], losses summed from t = 0 on."""
        with np.errstate(all="ignore"):
            return Ledger(self.setting, self.parts).energies(self.ends)
