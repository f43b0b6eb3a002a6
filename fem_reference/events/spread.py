"""How far a motion may be off its centre: a box in turned axes, Lohner's method.

Rounding, and the radii of the instants of the switches, separate the true motion from the computed one. Each step turns
the axes of the box by its own matrix, so that the box does not grow by being wrapped into the axes of the unknowns
step after step.
"""

from __future__ import annotations

import numpy as np

from fem_reference.events.block_model import STICKS
from fem_reference.events.block_switching import Flows
from fem_reference.problem.problem import Array

REGULAR = 4
"""Steps after which the axes of the box are made orthogonal again."""
INFLATION = 1 + 1e-9
"""What covers the rounding of the floats that bound radii."""


class Spread:
    """A set that holds (x, v, r) less its centre: axes times a box, plus a box."""

    def __init__(self, flows: Flows) -> None:
        # In the metric of the energy of the closed block the motion of most states is nearly a rotation.
        model, closed = flows.model, flows[STICKS, STICKS]
        mass = np.array([float(m) for m in model.mass])
        stiffness = mass[:, None] * closed.B_floats + np.diag(mass) * 1e-4 * closed.rate**2
        self.metric = np.zeros((14, 14))
        self.metric[:6, :6] = np.linalg.cholesky((stiffness + stiffness.T) / 2).T
        self.metric[6:12, 6:12] = np.diag(np.sqrt(mass))
        self.metric[12:, 12:] = np.eye(2) * np.sqrt(float(model.ps) + float(model.p) * 1e-4)
        self.inverse = np.linalg.inv(self.metric)
        self.axes, self.radii, self.box = self.inverse.copy(), np.zeros(14), np.zeros(14)
        self.count = 0

    def hull(self) -> Array:
        """Greatest distances from the centre, shape (14,)."""
        return np.asarray((np.abs(self.axes) @ self.radii + self.box) * INFLATION)

    def transport(self, J: Array, added: Array) -> None:
        """Turn the set by a matrix that is exact to 1e-12 of its entries, and add a box."""
        size = np.abs(J)
        self.box = (size @ (self.box + 1e-11 * (np.abs(self.axes) @ self.radii)) + added) * INFLATION
        self.axes = J @ self.axes
        self.count += 1
        if self.count % REGULAR == 0:
            self.make_orthogonal()

    def make_orthogonal(self) -> None:
        """Put the box into the axes, and make these orthogonal, the longest one first."""
        scaled = self.metric @ self.axes * self.radii
        order = np.argsort(-np.linalg.norm(scaled, axis=0))
        largest = np.abs(scaled).max()
        if largest > 0:
            Q, R = np.linalg.qr(scaled[:, order] / largest)
        else:
            Q, R = np.eye(14), np.zeros((14, 14))
        radii = np.abs(R).sum(axis=1) * largest + np.abs(Q.T) @ (np.abs(self.metric) @ self.box)
        self.radii = radii * INFLATION + 1e-11 * radii.sum()
        self.axes, self.box = self.inverse @ Q, np.zeros(14)
