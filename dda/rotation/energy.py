r"""Energy of a block that turns, and what takes it away.

Over a step the total energy, kinetic + strain + springs + that of the loads, falls by

    kinetic damping    (1 - gg^2) V' M V / 2 of the velocity it begins with,
    friction           |T| |slip| of the corners that slip,
    switching          U0 - U1 - (N dw + T ds), less friction, of every corner that opens or closes,
                       U = N^2/(2 p) + T^2/(2 p_s), with N = (1 - delta) N0 + delta N1 and T alike,
    algorithmic        the rest; at delta = 1 and alpha >= 1/2 none of them is negative, however far the block turns.

A base that moves gives N dy + T dx, which counts as energy of the loads.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dda.one_block.unilateral_energy import ENERGIES
from dda.rotation.body import EXACT
from dda.rotation.step import RollingHistory, RollingState, Setting

Array = NDArray[np.float64]


def with_start(history: RollingHistory, start: RollingState) -> RollingHistory:
    """Return the states of a history behind that at t = 0."""
    n = history.normal.shape[1]
    own = start.contacts
    first = [np.ravel(part)[None] for part in start[:5]] + [np.zeros((1, 1))]
    first += [np.asarray(part)[None, :n] for part in (own.normal, own.shear, own.gap, own.slipped, own.state)]
    both: list[Any] = [np.concatenate([row, rows]) for row, rows in zip(first, history, strict=True)]
    return RollingHistory(*both)


def outlines(history: RollingHistory, points: Array) -> Array:
    """Return points of the block after every step, (steps, points, 2) [m]."""
    e, Q = history.e, history.Q.reshape(-1, 2, 2)
    E = np.array([[e[:, 0], e[:, 2] / 2], [e[:, 2] / 2, e[:, 1]]])
    local = points + np.einsum("mi,ijk->kmj", points, E)
    placed: Array = history.c[:, None] + np.einsum("kij,kmj->kmi", Q, local)
    return placed


def energies(setting: Setting, start: RollingState, history: RollingHistory, losses: Array) -> dict[str, Array]:
    """Return the energies [J] after every step, the losses summed from t = 0 on.

    Parameters
    ----------
    losses : (steps, 5) array
        Those of `dda.stepping.driver.Counts`; the algorithmic ones follow from the balance.
    """
    states, law, M = with_start(history, start), setting.law, setting.body.M
    growth = np.ones(len(states.c)) if setting.rotation == EXACT else np.linalg.det(states.Q.reshape(-1, 2, 2))
    V = states.V
    moving = growth * np.einsum("ki,ij,kj->k", V[:, :2], M[:2, :2], V[:, :2])
    turning = growth**2 * np.einsum("ki,ij,kj->k", V[:, 2:], M[2:, 2:], V[:, 2:])
    springs = states.normal**2 * law.compliance + (states.shear**2 / law.shear if law.shear else 0.0)
    load = -(M[0, 0] * growth) * ((states.c - states.c[0]) @ setting.weight)
    loaded = outlines(states, setting.where)
    load -= np.einsum("kma,ma->k", loaded - loaded[0], setting.dead)
    load[1:] -= losses[:, 4]
    strain = growth * np.einsum("ki,ij,kj->k", states.e, setting.body.K, states.e) / 2
    stored = ((moving + turning) / 2, strain, springs.sum(axis=1) / 2, load)
    total = np.sum(stored, axis=0)
    damped, switching, friction = losses[:, 1:4].T
    algorithmic = total[0] - total[1:] - damped - switching - friction
    values = (*(part[1:] for part in stored), algorithmic, damped, switching, friction)
    return dict(zip(ENERGIES, values, strict=True))
