"""The printed recursion, eq. (6)-(9), (31), (32), for upright rectangles.

It is kept as printed, to show what it costs: unknowns are the increments of (v, ex, ey), stress
and spring stretch are accumulated, f2 of eq. (32) lacks the shear springs' stretch, and with stiff
springs the contact force is a small difference of large numbers. Only the printed square is
generalised to a width and a height, and the shear springs may have their own stiffness.
"""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter

import numpy as np

from dda.bodies.two_block import TwoBlockModel
from dda.model.arrays import Array
from dda.result.result import Result, check_request, linear_result
from dda.scheme.newmark import Scheme

_STATE = {"displacement": 0, "strain_x": 1, "strain_y": 2, "contact_pressure": 3}


def textbook_applicable(model: TwoBlockModel, scheme: Scheme) -> str | None:
    """Return why the printed recursion does not apply, or None if it does."""
    if scheme.table is not None:
        return f"eq. (6), (7) are Newmark's, not those of {scheme.name}"
    if scheme.damped:
        return "eq. (8) has no viscous damping"
    if scheme.alpha * scheme.step**2 == 0:
        return "eq. (6) divides by alpha, which is zero" if scheme.alpha == 0 else "alpha dt^2 of eq. (9) vanishes"
    load = model.load
    if load.traction or load.gravity or load.eccentricity or load.ramp or load.motion is not None:
        return "eq. (31), (32) hold for a centred pressure only, switched on at once"
    corners = np.roll(model.block.corners, -model.base, axis=0)
    x, y = corners.T
    upright = len(x) == 4 and y[0] == y[1] and x[1] == x[2] and y[2] == y[3] and x[3] == x[0]
    if not (upright and x[1] > x[0]):
        return "eq. (31) holds for an upright rectangle on its lower edge only"
    if model.top != (model.base + 2) % 4:
        return "eq. (31) holds for a load on the edge opposite the base only"
    return None


def solve_textbook(
    model: TwoBlockModel, scheme: Scheme, steps: int, columns: Sequence[str] = ("displacement", "contact_pressure")
) -> Result:
    """Step the printed recursion from rest and return the asked columns.

    Raises
    ------
    ValueError
        If it does not apply (`textbook_applicable` says why), or a request is out of range.
    """
    check_request(steps, columns)
    reason = textbook_applicable(model, scheme)
    if reason is not None:
        raise ValueError(f"model: the printed recursion does not apply: {reason}")
    began = perf_counter()
    with np.errstate(all="ignore"):
        recursion = _Recursion(model, scheme)
        ready = perf_counter()
        states = recursion.run(steps)
    still = np.zeros(steps)
    observed = np.array([states[:, _STATE[name]] if name in _STATE else still for name in columns])
    return linear_result(
        scheme,
        (began, ready),
        columns,
        observed,
        model.load.pressure,
        unknowns=3,
        nonzeros=int(np.count_nonzero(recursion.K)),
        factorisations=1,
        solves=steps,
    )


class _Recursion:
    """Eq. (31), (32) in (dv, dex, dey)."""

    def __init__(self, model: TwoBlockModel, scheme: Scheme) -> None:
        """Form the matrix of eq. (31) and its inverse."""
        self.scheme = scheme
        self.q = model.load.pressure
        self.p = model.contact.normal
        p = self.p
        b, h = np.ptp(model.block.corners, axis=0).tolist()
        self.width = b
        self.height = h
        self.area = b * h
        self.C = model.block.material.elasticity()[:2, :2]
        self.M = model.block.material.density * self.area * np.array([1.0, b**2 / 12, h**2 / 12])
        self.K = np.diag(self.M / (scheme.alpha * scheme.step**2))
        shear = model.contact.shear * b * b / 2
        self.K += np.array([[2 * p, 0.0, -p * h], [0.0, shear, 0.0], [-p * h, 0.0, p * h * h / 2]])
        self.K[1:, 1:] += self.area * self.C
        self.inverse = np.linalg.inv(self.K)

    def _force(self, stretch: float, stress: Array) -> Array:
        """Return load, spring and initial-stress parts of eq. (32); stretch is v_M + v_N [m]."""
        force = np.array([-self.width * self.q, 0.0, -self.area * self.q / 2])
        force += self.p * stretch * np.array([-1.0, 0.0, self.height / 2])
        force[1:] -= self.area * stress
        return force

    def run(self, steps: int) -> Array:
        """Return v, ex, ey and the contact pressure of every step, (steps, 4)."""
        s = self.scheme
        dt = s.step
        stretch = 0.0
        stress = np.zeros(2)
        D, V, A = np.zeros((3, 3))
        if s.start == "consistent":
            A = self._force(0.0, stress) / self.M
        states = np.empty((steps, 4))
        for n in range(steps):
            inertia = s.gg * V / (s.alpha * dt) + (1 / (2 * s.alpha) - 1) * A
            dD = self.inverse @ (self._force(stretch, stress) + self.M * inertia)
            # eq. (7)
            V = s.delta / (s.alpha * dt) * dD + s.gg * (1 - s.delta / s.alpha) * V
            V = V + (1 - s.delta / (2 * s.alpha)) * dt * A
            A = dD / (s.alpha * dt**2) - inertia
            D = D + dD
            stress = stress + self.C @ dD[1:]
            stretch += 2 * dD[0] - self.height * dD[2]
            states[n, :3] = D
            states[n, 3] = -self.p * stretch / self.width
        return states
