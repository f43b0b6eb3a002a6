"""What is read from the history of a block that turns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dda.one_block.contact_result import ContactResult
from dda.one_block.gap_form import COLUMNS
from dda.rotation.body import EXACT, Body, RollingMotion, strain_matrices
from dda.rotation.step import Setting
from dda.stepping.driver import History
from dda.stepping.energy import ENERGIES, FRICTION, GIVEN, IMPULSE, SWITCHING, spring_energies

Array = NDArray[np.float64]


def observed(body: Body, states: RollingMotion, history: History) -> dict[str, Array]:
    """Return all of `dda.COLUMNS`."""
    out = body.to_base.T
    moved = (states.c[1:] - states.c[0]) @ out.T
    E = np.einsum("ai,kij,bj->abk", out, strain_matrices(states.e[1:]), out)
    a = float(np.hypot(*(body.xi[body.base[1]] - body.xi[body.base[0]])))
    pressure = history.normal[1:].sum(axis=1) / a
    values = (moved[:, 1], pressure, moved[:, 0], states.r[1:], E[0, 0], E[1, 1], 2 * E[0, 1])
    return dict(zip(COLUMNS, values, strict=True))


def energies(setting: Setting, states: RollingMotion, history: History) -> dict[str, Array]:
    """Return the energies [J] after every step, the losses summed from t = 0 on.

    They are those of `dda.stepping.energy`, but for the algorithmic loss, which is what the others leave of the total:
    at delta = 1 and alpha >= 1/2 none of them is negative, however far the block turns.
    """
    M, V = setting.body.M, states.V
    growth = np.ones(len(V)) if setting.rotation == EXACT else np.linalg.det(states.Q)
    moving = growth * np.einsum("ki,ij,kj->k", V[:, :2], M[:2, :2], V[:, :2])
    turning = growth**2 * np.einsum("ki,ij,kj->k", V[:, 2:], M[2:, 2:], V[:, 2:])
    load = -(M[0, 0] * growth) * ((states.c - states.c[0]) @ setting.weight)
    loaded = states.points(setting.where)
    load -= np.einsum("kma,ma->k", loaded - loaded[0], setting.dead) + history.sums[:, GIVEN]
    strain = growth * np.einsum("ki,ij,kj->k", states.e, setting.body.K, states.e) / 2
    stored = ((moving + turning) / 2, strain, spring_energies(setting.law, history.normal, history.shear), load)
    total = np.sum(stored, axis=0)
    damped, switching, friction = history.sums[1:, SWITCHING - 1 : FRICTION + 1].T
    algorithmic = total[0] - total[1:] - damped - switching - friction
    values = (*(part[1:] for part in stored), algorithmic, damped, switching, friction)
    return dict(zip(ENERGIES, values, strict=True))


@dataclass(frozen=True, eq=False)
class RollingResult(ContactResult):
    """Histories of a block that turns; the contacts are all corners of its outline, `base_contacts` M and N."""

    body: Body
    motion: RollingMotion  # from t = 0 on
    history: History  # from t = 0 on

    @property
    def angle(self) -> Array:
        """Sum of the steps' rotations, (steps,) [rad]."""
        return self.motion.r[1:]

    @property
    def spin(self) -> Array:
        """Rate of rotation [rad/s]."""
        return self.motion.V[1:, 2]

    @property
    def impulse(self) -> Array:
        """Integral of the sum of N from t = 0 on, as the scheme takes it, (steps,) [N s]."""
        return self.history.sums[1:, IMPULSE]

    @cached_property
    def slip(self) -> Array:
        """Largest movement of the shear reference of any corner by slip, summed while it was closed, (steps,) [m]."""
        return np.asarray(np.cumsum(self.slipped, axis=1).max(axis=0))

    @cached_property
    def outline(self) -> Array:
        """Corners in the frame of the base, (steps, corners, 2) [m]."""
        return self.motion.points(self.body.xi)[1:]

    @cached_property
    def area(self) -> Array:
        """Area of the outline over that of the start, (steps,) [-]."""
        e = self.motion.e[1:]
        strained = (1 + e[:, 0]) * (1 + e[:, 1]) - e[:, 2] ** 2 / 4
        return np.asarray(np.linalg.det(self.motion.Q[1:]) * strained)
