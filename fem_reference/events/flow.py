"""The motion of few unknowns as one linear flow, z' = G z, in floats, and the norm in which it is bounded.

z = (x, x', r, 1) holds the six unknowns of a block, their rates, the references of both corners and a one. With x in
units of 1/omega, omega^2 the norm of the scaled stiffness, the four blocks of G have the norms 0, omega, omega and d,
that of the scaled dashpots, so that G has at most the norm d/2 + sqrt(d^2/4 + omega^2), the rate w of the motion. The
k-th term of a function g z over a length L is g G^k z L^k / k!, and at most |g| |z| (w L)^k / k!.
"""

from __future__ import annotations

import math

import numpy as np

from fem_reference.events.contacts import States, Watch
from fem_reference.events.series import INFLATION, System, floats
from fem_reference.problem.problem import Array

SIZE = 15
"""Entries of z: 6 unknowns, their rates, 2 references and a one."""
UNIT = np.eye(SIZE)
EXPONENTIAL_ERROR = 1e-13
"""Part of the greatest entry of exp(G s), in the units of the flow, by which floats of it may be wrong."""
EXPONENTIAL_TERMS = 14
"""Terms of its series: what follows is below 0.5^15 / 15!, 2e-17."""


class Flow:
    """The matrix of the block's motion in one state of its corners, in floats, and the norm in which it is bounded."""

    def __init__(self, model: System, states: States) -> None:
        self.rows = floats(model.rows)
        self.angle = model.angle  # of the longest step [rad]
        motion = model.motion(states)
        self.G = np.zeros((SIZE, SIZE))
        self.G[:6, 6:12] = np.eye(6)
        self.G[6:12, :6] = floats(motion.A)
        if motion.D is not None:
            self.G[6:12, 6:12] = floats(motion.D)
        self.G[6:12, 12:14] = floats(motion.R)
        self.G[6:12, 14:] = floats(motion.f)
        scale = np.diag(model.root[0])
        omega, self.rate = model.bounds_of(states)
        # unknowns and rates of norm one, in which G has the norm `rate`; references and the one change them as slowly
        self.units = np.array([*(1 / (scale * omega)), *(1 / scale), *[1 / (scale[0] * omega)] * 2, 1.0])
        load = np.abs(self.G[6:12, 14] * scale).max() / self.rate
        self.units[14] = 1 / load if load else 1.0
        self.tables: dict[tuple[int, int], Array] = {}

    def function(self, watch: Watch) -> Array:
        """A watched function over z, shape (15,)."""
        weights = np.zeros(SIZE)
        for row, factor, dashpot in watch.parts:
            place = 6 if watch.rates else 0
            weights[place : place + 6] += float(factor) * self.rows[row]
            if dashpot is not None:
                weights[6:12] += float(dashpot) * self.rows[row]
        weights[12 + watch.contact] += float(watch.pull)
        return weights

    def terms(self, watch: Watch, count: int) -> Array:
        """Rows of the first terms of a function over the longest step, shape (count, 15)."""
        key = watch.contact, watch.side
        table = self.tables.get(key, np.empty((0, SIZE)))
        if len(table) < count:
            rows = [self.function(watch)]
            for k in range(1, count):
                rows.append(rows[-1] @ self.G * (self.angle / (self.rate * k)))
            table = self.tables[key] = np.array(rows)
        return table[:count]

    def norm(self, z: Array) -> float:
        """Norm of the unknowns and their rates."""
        scaled = z[:12] / self.units[:12]
        return math.sqrt(scaled @ scaled) * INFLATION

    def exponential(self, seconds: float) -> Array:
        """exp(G s) in floats, see `EXPONENTIAL_ERROR`."""
        J = matrix_exponential(self.G * self.units / self.units[:, None] * seconds, self.rate * seconds)
        return np.vstack([(J / self.units * self.units[:, None])[:12], UNIT[12:]])

    def exponential_error(self, J: Array, hull: Array) -> Array:
        """How far the floats of exp(G s) may move a set that reaches so far from zero; references and the one rest."""
        largest = np.abs(J * self.units / self.units[:, None]).max()
        moving = np.array([*self.units[:12], 0.0, 0.0, 0.0])
        return np.asarray(EXPONENTIAL_ERROR * largest * (hull / self.units)[:14].sum() * moving)

    def growth(self, radius: Array, angle: Array) -> Array:
        """How far the unknowns may be off after angles, where z is off by a radius; shape (6, angles)."""
        apart = (radius[:12] / self.units[:12]).sum()
        pull = (np.abs(self.G[6:12, 12:14]) @ radius[12:14] / self.units[6:12]).sum() / self.rate
        return np.asarray(self.units[:6, None] * np.exp(angle) * (apart + angle * pull))


def matrix_exponential(matrix: Array, angle: float) -> Array:
    """exp(A) in floats, ||A|| <= angle: the series of a part of at most half a radian, squared; numpy has no such."""
    squarings = max(0, math.ceil(math.log2(2 * angle))) if angle > 0 else 0
    part = matrix / 2.0**squarings
    one = np.eye(len(matrix))
    power = one
    for k in range(EXPONENTIAL_TERMS, 0, -1):
        power = one + part @ power / k
    for _ in range(squarings):
        power = power @ power
    return power
