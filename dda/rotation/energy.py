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

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dda.rotation.body import EXACT, positions
from dda.rotation.step import Part, Setting

Array = NDArray[np.float64]
STORED = ("kinetic", "strain", "springs", "load")
LOST = ("algorithmic", "kinetic damping", "switching", "friction")
ENERGIES = STORED + LOST


class Ledger:
    """What the parts of a history keep and lose; the first part is the state at t = 0."""

    def __init__(self, setting: Setting, parts: Sequence[Part]) -> None:
        self.setting = setting
        states = [part.state for part in parts]
        self.delta, self.gg = np.array([(part.scheme.delta, part.scheme.gg) for part in parts[1:]]).reshape(-1, 2).T
        self.c, self.e, self.V = (np.array([getattr(s, name) for s in states]) for name in ("c", "e", "V"))
        self.base = np.array([part.base for part in parts])
        own = setting.body.xi
        self.corners = np.array([positions(s.c, s.Q, s.e, own) for s in states])
        self.loaded = np.array([positions(s.c, s.Q, s.e, setting.where) for s in states])
        names = ("gap", "normal", "shear", "slipped")
        self.closed = np.array([s.touch.closed for s in states])
        self.points: dict[str, Array] = {name: np.array([getattr(s.touch, name) for s in states]) for name in names}
        grown = np.array([1.0 if setting.rotation == EXACT else float(np.linalg.det(s.Q)) for s in states])
        self.mass, self.growth = setting.body.M[0, 0] * grown, grown

    def energies(self, ends: Sequence[int]) -> dict[str, Array]:
        """Return the energies [J] at the ends of steps, the losses summed from t = 0 on."""
        kept = np.column_stack([self._kinetic(), self._strain(), self._springs().sum(axis=1), self._load()])
        lost = np.cumsum(self._losses(kept.sum(axis=1)), axis=0)
        at = np.array(ends, dtype=int) - 1
        return dict(zip(ENERGIES, np.column_stack([kept[1:], lost])[at].T, strict=True))

    def _kinetic(self) -> Array:
        M, V, g = self.setting.body.M, self.V, self.growth
        moving = g * np.einsum("ki,ij,kj->k", V[:, :2], M[:2, :2], V[:, :2])
        turning = g * g * np.einsum("ki,ij,kj->k", V[:, 2:], M[2:, 2:], V[:, 2:])
        return np.asarray((moving + turning) / 2, dtype=np.float64)

    def _strain(self) -> Array:
        strain: Array = self.growth * np.einsum("ki,ij,kj->k", self.e, self.setting.body.K, self.e) / 2
        return strain

    def _springs(self) -> Array:
        """Return the energy of the springs of every corner, (parts + 1, n)."""
        law, N, T = self.setting.law, self.points["normal"], self.points["shear"]
        energy: Array = (N**2 * law.compliance + (T**2 / law.shear if law.shear else 0.0)) / 2
        return energy

    def _load(self) -> Array:
        """Return the potential of weight and dead loads, less what the base gave."""
        moved = self.loaded - self.loaded[0]
        potential: Array = -self.mass * ((self.c - self.c[0]) @ self.setting.weight)
        potential -= np.einsum("kma,am->k", moved, self.setting.dead[::-1])
        N, T = (self._during(name).sum(axis=1) for name in ("normal", "shear"))
        given = T * np.diff(self.base[:, 0]) + N * np.diff(self.base[:, 1])
        potential[1:] -= np.cumsum(given)
        return potential

    def _during(self, name: str) -> Array:
        """Return (1 - delta) times the forces before a part and delta times those after it, (parts, n)."""
        force: Array = self.points[name]
        late: Array = self.delta[:, None]
        during: Array = (1 - late) * force[:-1] + late * force[1:]
        return during

    def _losses(self, energy: Array) -> Array:
        """Return what every part loses, in the order of `LOST`."""
        damped = (1 - self.gg**2) * self._kinetic()[:-1]
        w = self.points["gap"]
        s = self.corners[:, :, 0] - self.base[:, :1]
        U = self._springs()
        work = self._during("normal") * np.diff(w, axis=0) + self._during("shear") * np.diff(s, axis=0)
        switched = self.closed[1:] != self.closed[:-1]
        rubbed = np.abs(self.points["shear"] * self.points["slipped"])[1:]
        switching = np.sum((U[:-1] - U[1:] - work - rubbed) * switched, axis=1)
        friction = np.sum(rubbed, axis=1)
        return np.column_stack([-np.diff(energy) - damped - switching - friction, damped, switching, friction])
