"""What is read from the history of a block that turns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dda.one_block.contact_result import ContactResult
from dda.one_block.gap_form import COLUMNS
from dda.rotation.body import Body
from dda.rotation.energy import outlines
from dda.rotation.step import RollingHistory, RollingState

Array = NDArray[np.float64]


def observed(body: Body, start: RollingState, history: RollingHistory) -> dict[str, Array]:
    """Return all of `dda.COLUMNS`."""
    out = body.to_base.T
    moved = (history.c - start.c) @ out.T
    e = history.e
    own = np.array([[e[:, 0], e[:, 2] / 2], [e[:, 2] / 2, e[:, 1]]])
    E = np.einsum("ai,ijk,bj->abk", out, own, out)
    a = float(np.hypot(*(body.xi[body.base[1]] - body.xi[body.base[0]])))
    values = (
        moved[:, 1],
        history.normal.sum(axis=1) / a,
        moved[:, 0],
        history.r[:, 0],
        E[0, 0],
        E[1, 1],
        2 * E[0, 1],
    )
    return dict(zip(COLUMNS, values, strict=True))


@dataclass(frozen=True, eq=False)
class RollingResult(ContactResult):
    """Histories of a block that turns; the contacts are all corners of its outline, `base_contacts` M and N."""

    body: Body
    start: RollingState  # at t = 0
    history: RollingHistory

    @property
    def angle(self) -> Array:
        """Sum of the steps' rotations, (steps,) [rad]."""
        return self.history.r[:, 0]

    @property
    def impulse(self) -> Array:
        """Integral of the sum of N from t = 0 on, as the scheme takes it, (steps,) [N s]."""
        return self.history.impulse[:, 0]

    @cached_property
    def slip(self) -> Array:
        """Largest movement of the shear reference of any corner by slip, summed while it was closed, (steps,) [m]."""
        summed: Array = np.cumsum(self.history.slipped, axis=0).max(axis=1)
        return summed

    @cached_property
    def outline(self) -> Array:
        """Corners in the frame of the base, (steps, corners, 2) [m]."""
        return outlines(self.history, self.body.xi)

    @cached_property
    def area(self) -> Array:
        """Area of the outline over that of the start, (steps,) [-]."""
        e = self.history.e
        strained = (1 + e[:, 0]) * (1 + e[:, 1]) - e[:, 2] ** 2 / 4
        return np.asarray(np.linalg.det(self.history.Q.reshape(-1, 2, 2)) * strained)

    @property
    def spin(self) -> Array:
        """Rate of rotation [rad/s]."""
        return self.history.V[:, 2]


def parts_of(
    body: Body, start: RollingState, history: RollingHistory, base: Array, softness: float
) -> dict[str, Callable[[], Array]]:
    """Return what makes the properties of a result.

    Parameters
    ----------
    base : (steps + 1,) array
        Displacement of the base along itself, from t = 0 on [m].
    softness : float
        1/p_s, 0 without springs in shear [m/N].
    """

    def slide() -> Array:
        first = np.array([start.c]), start.Q.reshape(1, 4), np.zeros((1, 1)), np.array([start.e])
        at_start = outlines(history._replace(c=first[0], Q=first[1], e=first[3]), body.xi)[0, :, 0] - base[0]
        moved: Array = (outlines(history, body.xi)[:, :, 0] - base[1:, None] - at_start).T
        return moved

    def velocities() -> Array:
        velocity: Array = history.V[:, :2] @ body.to_base
        return velocity

    return {
        "normal": lambda: history.normal.T,
        "shear": lambda: history.shear.T,
        "gap": lambda: history.gap.T,
        "stretch": lambda: 0.0 - history.shear.T * softness,
        "slide": slide,
        "slipped": lambda: history.slipped.T,
        "states": lambda: history.state.T.astype(float),
        "velocity": lambda: velocities()[:, 1],
        "horizontal_velocity": lambda: velocities()[:, 0],
    }
