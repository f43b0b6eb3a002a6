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
        K = recursion_matrix(model, scheme)
        ready = perf_counter()
        states = recursion(model, scheme, K, steps)
    observed = np.array([states[_STATE[name]] if name in _STATE else np.zeros(steps) for name in columns])
    return linear_result(
        scheme,
        (began, ready),
        columns,
        observed,
        model.load.pressure,
        unknowns=3,
        nonzeros=int(np.count_nonzero(K)),
        factorisations=1,
        solves=steps,
    )


def inertia(model: TwoBlockModel) -> Array:
    """Return that of (v, ex, ey)."""
    width, height = np.ptp(model.block.corners, axis=0)
    return model.block.total_mass * np.array([1.0, width**2 / 12, height**2 / 12])


def recursion_matrix(model: TwoBlockModel, scheme: Scheme) -> Array:
    """Return the matrix of eq. (31) in (dv, dex, dey)."""
    width, height = np.ptp(model.block.corners, axis=0)
    p = model.contact.normal
    K = np.diag(inertia(model) / (scheme.alpha * scheme.step**2))
    shear = model.contact.shear * width * width / 2
    K += np.array([[2 * p, 0.0, -p * height], [0.0, shear, 0.0], [-p * height, 0.0, p * height * height / 2]])
    K[1:, 1:] += model.block.section.area * model.block.material.elasticity()[:2, :2]
    return K


def recursion(model: TwoBlockModel, scheme: Scheme, K: Array, steps: int) -> Array:
    """Return v, ex, ey and the contact pressure of every step, (4, steps)."""
    width, height = np.ptp(model.block.corners, axis=0)
    area = model.block.section.area
    C = model.block.material.elasticity()[:2, :2]
    M = inertia(model)
    q = model.load.pressure
    p = model.contact.normal
    inverse = np.linalg.inv(K)
    alpha = scheme.alpha
    delta = scheme.delta
    dt = scheme.step
    stretch = 0.0  # v_M + v_N [m]
    D, V, A, stress = np.zeros((4, 3))
    states = np.empty((4, steps))
    for n in range(steps):
        # load, spring and initial-stress parts of eq. (32)
        force = np.array([-width * q, 0.0, -area * q / 2]) + p * stretch * np.array([-1.0, 0.0, height / 2])
        force -= area * stress
        if n == 0 and scheme.start == "consistent":
            A = force / M
        held = scheme.gg * V / (alpha * dt) + (1 / (2 * alpha) - 1) * A
        dD = inverse @ (force + M * held)
        # eq. (7)
        V = delta / (alpha * dt) * dD + scheme.gg * (1 - delta / alpha) * V + (1 - delta / (2 * alpha)) * dt * A
        A = dD / (alpha * dt**2) - held
        D = D + dD
        stress[1:] += C @ dD[1:]
        stretch += 2 * dD[0] - height * dD[2]
        states[:3, n] = D
        states[3, n] = -p * stretch / width
    return states
