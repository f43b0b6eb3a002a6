"""A block on springs stepped with what other programs add: weight, a softer base, moving geometry, opening.

The two-block model is linear with a locked contact. Other programs differ from it in known ways, and to recognise them
their histories have to be computed, many variants at a time: here every quantity is an array over the variants, and
one pass through the steps serves them all.

An upright rectangle of width a and height h has the unknowns (v, ey, ex); both corner springs carry the same. The
increments x of a step solve, with the area S = a h and the base's gap g = v - (h/2) ey - b (accumulated),

    (M + alpha dt^2 K) x = M x* + alpha dt^2 (F - internal),     x* = gg dt V + dt^2 (1/2 - alpha) A

    M = diag(m, m h^2/12, m a^2/12, m_b),    m = rho S,    K = S C + k c c' + kx + kb,    c = (1, -h/2, 0, -1)

for (v, ey, ex, b), b the motion of a base of mass m_b on a spring kb. A base without mass stands in series with the
contact: b is held then, and k is the stiffness of both together; kx = p_s a^2/2. Where the contact may open, the
springs are on in a step if the base penetrates at its end, which the open-close iteration decides. Where the
geometry moves, a, h and with them S and m follow the strain after each step.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
GRAVITY = 9.81  # m/s2
OPEN_CLOSE_ITERATIONS = 6  # as in the programs of the trade


@dataclass(frozen=True)
class Variant:
    """One way to compute the scene: a scheme, what the program adds, and slips."""

    alpha: float  # [-]
    delta: float  # [-]
    gg: float  # share of the velocity that a step starts with [-]
    start: Literal["zero", "consistent"] = "zero"
    softness: float = 0.0  # ln of the scene's spring stiffness over that in effect [-]
    base: float = 0.0  # mass of the yielding base over that of the block; 0 is a spring in series [-]
    weight: float = 0.0  # own weight, as a share of 9.81 m/s2 [-]
    load: float = 1.0  # load over the scene's load [-]
    updated: bool = False  # geometry follows the strain
    opens: bool = False  # the contact carries no tension
    discounted: Literal["both", "velocity", "displacement"] = "both"  # formulas in which gg stands
    shift: int = 0  # steps by which the rows come late


@dataclass(frozen=True, eq=False)
class Histories:
    """Histories of all variants, one column each."""

    displacement: Array  # (steps, variants) of the centroid [m]
    pressure: Array  # (steps, variants), positive in compression [Pa]
    open: Flags  # (steps, variants), at the end of the step
    area: Array  # (steps, variants), at the start of the step over that at rest: so much mass is moved


@dataclass(frozen=True)
class Column:
    """The data of the scene's block that the stepping needs."""

    width: float  # a [m]
    height: float  # h [m]
    density: float  # [kg/m3]
    c11: float  # elasticity along the axes [Pa]
    c12: float  # elasticity across [Pa]
    normal: float  # stiffness of both normal springs [N/m]
    shear: float  # stiffness of both shear springs [N/m]
    pressure: float  # q [Pa]
    gravity: float = 0.0  # of the scene [m/s2]

    @property
    def force(self) -> float:
        """Static force on the base [N]."""
        return self.width * (self.pressure + self.density * self.height * self.gravity)

    @property
    def static(self) -> float:
        """Static displacement of the centroid in the locked linear model [m]."""
        h, a = self.height, self.width
        across = self.c12 / (self.c11 + self.shear * a / (4 * h))
        stress = self.pressure + self.density * h * self.gravity / 2
        return -self.force / self.normal - stress / (self.c11 - self.c12 * across) * h / 2


def histories(column: Column, variants: Sequence[Variant], steps: Array) -> Histories:
    """Return the histories of all variants from rest.

    Parameters
    ----------
    column
        The block, its springs and its load.
    variants
        What is computed.
    steps
        Length of each time step [s], shape (n,).
    """
    early = max(0, *(-v.shift for v in variants))
    longer = np.concatenate([steps, np.repeat(steps[-1:], early)])
    with np.errstate(all="ignore"):
        rows = list(_Stepping(column, variants).run(longer))
    found = [np.array(part) for part in zip(*rows, strict=True)]
    for j in [j for j, variant in enumerate(variants) if variant.shift]:
        for part in found:
            part[:, j] = _shifted(part[:, j], variants[j].shift)
    n = len(steps)
    return Histories(found[0][:n], found[1][:n], found[2][:n].astype(bool), found[3][:n])


def _shifted(values: Array, late: int) -> Array:
    """Return the rows some steps late (the first rows at rest) or early."""
    shifted = np.roll(values, late)
    shifted[: max(late, 0)] = 0
    return shifted


class _Stepping:
    """The stepping of all variants at once; every attribute is an array over them."""

    def __init__(self, column: Column, variants: Sequence[Variant]) -> None:
        self.column = column
        self.alpha, self.delta, gg, softness, base, weight, load = (
            np.array([getattr(v, name) for v in variants])
            for name in ("alpha", "delta", "gg", "softness", "base", "weight", "load")
        )
        formulas = np.array([v.discounted for v in variants])
        self.gg_displacement = np.where(formulas == "velocity", 1.0, gg)
        self.gg_velocity = np.where(formulas == "displacement", 1.0, gg)
        self.consistent = np.array([v.start == "consistent" for v in variants], dtype=float)
        self.updated = np.array([v.updated for v in variants], dtype=float)
        self.opens = np.array([v.opens for v in variants])
        heavy = (base > 0) & (softness > 0)
        self.normal = column.normal * np.exp(-np.where(heavy, 0.0, softness))
        self.held = np.where(heavy, 0.0, 1.0)
        self.base = np.where(heavy, base, 1.0) * column.density * column.width * column.height
        self.kb = column.normal / np.expm1(np.where(heavy, softness, 1.0))
        self.gravity = column.gravity + weight * GRAVITY
        self.force = load * column.pressure * column.width
        zero = np.zeros(len(variants))
        self.a, self.h = zero + column.width, zero + column.height
        self.D, self.B, self.gap, self.sheared, self.sx, self.sy = zero, zero, zero, zero, zero, zero
        self.V, self.A = np.zeros((4, len(variants))), np.zeros((4, len(variants)))
        self.on = np.ones(len(variants), dtype=bool)

    def run(self, steps: Array) -> Iterator[tuple[Array, Array, Flags, Array]]:
        """Yield displacement, pressure, the open flags and the area of every step."""
        inertia, h = self._inertia(), self.h
        weights = (-self.force - inertia[0] * self.gravity, -self.force * h / 2)
        load = np.stack([*weights, np.zeros_like(h), np.zeros_like(h)])
        self.A = self.consistent * load / inertia
        for dt in steps.tolist():
            area = self.a * self.h / (self.column.width * self.column.height)
            self._step(dt)
            yield self.D, np.where(self.on, -self.normal * self.gap, 0.0) / self.column.width, ~self.on, area

    def _inertia(self) -> Array:
        """Return the diagonal of M in (v, ey, ex, b), shape (4, variants)."""
        m = self.column.density * self.a * self.h
        return np.stack([m, m * self.h**2 / 12, m * self.a**2 / 12, self.base])

    def _step(self, dt: float) -> None:
        inertia = self._inertia()
        star = self.gg_displacement * dt * self.V + dt * dt * (0.5 - self.alpha) * self.A
        for _ in range(OPEN_CLOSE_ITERATIONS):
            x, acceleration = self._solve(dt, inertia, star)
            gap = self.gap + x[0] - self.h / 2 * x[1] - x[3]
            on = np.where(self.opens, gap < 0, True)
            if np.array_equal(on, self.on):
                break
            self.on = on
        self._accept(dt, x, acceleration, gap)

    def _solve(self, dt: float, inertia: Array, star: Array) -> tuple[Array, Array]:
        """Return the increments (v, ey, ex, b) and the accelerations at the end for the present contact state."""
        c, S, half, free = self.column, self.a * self.h, self.h / 2, 1 - self.held
        k = np.where(self.on, self.normal, 0.0)
        kx = np.where(self.on, c.shear * self.a**2 / 4, 0.0)
        Kvy, Kyy = -k * half, S * c.c11 + k * half**2
        Kxy, Kxx = S * c.c12, S * c.c11 + kx
        Kvb, Kyb, Kbb = -k * free, k * half * free, k + self.kb
        F = np.stack(
            [
                -self.force - inertia[0] * self.gravity - k * self.gap,
                (k * self.gap - self.force) * half - S * self.sy,
                -S * self.sx - kx * self.sheared,
                free * (k * self.gap - self.kb * self.B - inertia[3] * self.gravity),
            ]
        )
        e = self.alpha * dt * dt
        rv, ry, rx, rb = inertia * star + e * F
        # the base and ex are eliminated first, then (v, ey) remain
        tb, tx = e / (inertia[3] + e * Kbb), e / (inertia[2] + e * Kxx)
        Svv, Svy = inertia[0] + e * (k - tb * Kvb**2), e * (Kvy - tb * Kvb * Kyb)
        Syy = inertia[1] + e * (Kyy - tb * Kyb**2 - tx * Kxy**2)
        rv, ry = rv - tb * Kvb * rb, ry - tb * Kyb * rb - tx * Kxy * rx
        y = (ry - Svy * rv / Svv) / (Syy - Svy**2 / Svv)
        v = (rv - Svy * y) / Svv
        x = (rx - e * Kxy * y) / (inertia[2] + e * Kxx)
        b = (rb - e * (Kvb * v + Kyb * y)) / (inertia[3] + e * Kbb)
        internal = np.stack(
            [
                k * v + Kvy * y + Kvb * b,
                Kvy * v + Kyy * y + Kxy * x + Kyb * b,
                Kxy * y + Kxx * x,
                free * (Kvb * v + Kyb * y + Kbb * b),
            ]
        )
        return np.stack([v, y, x, b]), (F - internal) / inertia

    def _accept(self, dt: float, x: Array, acceleration: Array, gap: Array) -> None:
        """Move to the end of the step."""
        c = self.column
        self.V = self.gg_velocity * self.V + dt * ((1 - self.delta) * self.A + self.delta * acceleration)
        self.A, self.gap, self.D, self.B = acceleration, gap, self.D + x[0], self.B + x[3]
        self.sy = self.sy + c.c11 * x[1] + c.c12 * x[2]
        self.sx = self.sx + c.c11 * x[2] + c.c12 * x[1]
        self.sheared = np.where(self.on, self.sheared + x[2], 0.0)
        self.h = self.h * (1 + self.updated * x[1])
        self.a = self.a * (1 + self.updated * x[2])
