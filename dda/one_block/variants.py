"""A block on springs stepped with what other programs add, and with the slips that people make in a code of their own.

The two-block model is linear with a locked contact. Other programs differ from it in known ways, and to recognise them
their histories have to be computed, many variants at a time: here every quantity is an array over the variants, and
one pass through the steps serves them all. A contact that opens is stepped here only together with what
`dda.UnilateralModel` does not have: moving geometry, a base with mass, a slip, unequal time steps.

An upright rectangle of width a and height h has the unknowns (v, ey, ex); both corner springs carry the same. The
increments x of a step solve, with the area S = a h and the base's gap g = v - (h/2) ey - b (accumulated),

    (M + alpha dt^2 K) x = M x* + alpha dt^2 (F - internal),     x* = gg dt V + dt^2 (1/2 - alpha) A

    M = diag(m, m h^2/12, m a^2/12, m_b),    m = rho S,    K = S C + k c c' + kx + kb,    c = (1, -h/2, 0, -1)

for (v, ey, ex, b), b the motion of a base of mass m_b on a spring kb. A base without mass stands in series with the
contact: b is held then, and k is the stiffness of both together; kx = p_s a^2/2. Where the contact may open, the
springs are on in a step if the base penetrates at its end, by more than the band if they were off before, which the
open-close iteration decides. Where the geometry moves, a, h and with them S and m follow the strain after each step.

Viscous damping c M V of the mass, if there is any, stands at the end of the step: M (1 + c delta dt) for M, and
-c M (gg V + dt (1 - delta) A) among the forces. Of the slips, a coupling s in place of 1 makes the springs' matrix
k (1, -s h/2; -s h/2, h^2/4), and what is not kept is left out of the internal forces: the stress of the block, or the
force of the springs.
"""

from __future__ import annotations

import math
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
    tied: bool = True  # the shear springs share the softness
    base: float = 0.0  # mass of the yielding base over that of the block; 0 is a spring in series [-]
    weight: float = 0.0  # own weight, as a share of 9.81 m/s2 [-]
    load: float = 1.0  # load over the scene's load [-]
    density: float = 1.0  # over the scene's [-]
    young: float = 1.0  # Young's modulus over the scene's [-]
    poisson: float = 0.0  # added to the scene's Poisson's ratio [-]
    other_plane: bool = False  # plane strain for plane stress, or the reverse
    side: float = 1.0  # width and height over the scene's [-]
    tall: float = 1.0  # height alone, in addition [-]
    viscous: float = 0.0  # damping of the mass [1/s]
    updated: bool = False  # geometry follows the strain
    opens: bool = False  # the contact carries no tension
    band: float = 0.0  # penetration beyond which an open contact closes [m]
    reopening: float = 0.0  # gap beyond which a closed one opens, over the band [-]
    reset: bool = False  # a closing contact is sheared from the start of the step on, not from where it touched
    discounted: Literal["both", "velocity", "displacement"] = "both"  # formulas in which gg stands
    strain_load: float = 1.0  # share of the load in the row of ey [-]
    coupling: float = 1.0  # share of the springs' stiffness between v and ey [-]
    kept: Literal["both", "springs", "stress"] = "both"  # forces that are carried from step to step
    shift: int = 0  # steps by which the rows come late
    point: float = 0.0  # height of the reported point above the centroid, over half the block's height [-]
    late: float = 0.0  # steps by which the pressure comes late; 1/2 is the mean of two steps
    pressure_factor: float = 1.0  # reported over true pressure [-]
    displacement_factor: float = 1.0  # reported over true displacement [-]


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
    young: float  # [Pa]
    poisson: float  # [-]
    plane_strain: bool
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
        c11, c12 = self.elasticity()
        across = c12 / (c11 + self.shear * a / (4 * h))
        stress = self.pressure + self.density * h * self.gravity / 2
        return float(-self.force / self.normal - stress / (c11 - c12 * across) * h / 2)

    def elasticity(self, variants: Sequence[Variant] = ()) -> tuple[Array, Array]:
        """Return the elasticity along and across the axes [Pa], of each variant or of the scene."""
        strain = np.array([self.plane_strain != v.other_plane for v in variants] or self.plane_strain)
        young = self.young * np.array([v.young for v in variants] or 1.0)
        mu = self.poisson + np.array([v.poisson for v in variants] or 0.0)
        modulus, ratio = np.where(strain, young / (1 - mu**2), young), np.where(strain, mu / (1 - mu), mu)
        c11 = modulus / (1 - ratio**2)
        return c11, ratio * c11


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
    longer = np.concatenate([steps, np.repeat(steps[-1:], further_steps(variants))])
    with np.errstate(all="ignore"):
        rows = list(_Stepping(column, variants).run(longer))
        displacement, pressure, opened, area = (np.array(part) for part in zip(*rows, strict=True))
        return reported(Histories(displacement, pressure, opened.astype(bool), area), variants, len(steps))


def further_steps(variants: Sequence[Variant]) -> int:
    """Return how many steps beyond the last row the variants report of."""
    return max(0, *(-v.shift - min(0, math.floor(v.late)) for v in variants))


def reported(found: Histories, variants: Sequence[Variant], n: int) -> Histories:
    """Return the n rows that the variants write of what they computed: shifted, late, by a factor."""
    displacement, pressure, opened, area = found.displacement, found.pressure, found.open, found.area
    for j, v in enumerate(variants):
        if v.late:
            whole, part = math.floor(v.late), v.late - math.floor(v.late)
            P = pressure[:, j]
            pressure[:, j] = (1 - part) * _shifted(P, whole) + (part * _shifted(P, whole + 1) if part else 0.0)
        if v.shift:
            for values in (displacement, pressure, area):
                values[:, j] = _shifted(values[:, j], v.shift)
            opened[:, j] = _shifted(opened[:, j].astype(float), v.shift) > 0
    scale = np.array([v.displacement_factor for v in variants]), np.array([v.pressure_factor for v in variants])
    return Histories(scale[0] * displacement[:n], scale[1] * pressure[:n], opened[:n], area[:n])


def _shifted(values: Array, late: int) -> Array:
    """Return the rows some steps late (the first rows at rest) or early."""
    shifted = np.roll(values, late)
    shifted[: max(late, 0)] = 0
    return shifted


@dataclass(frozen=True, eq=False)
class _Equations:
    """What the equations of a step hold apart from the motion; every array is one over the variants."""

    ahead: tuple[Array, Array]  # what V and A add to x*: gg dt [s] and (1/2 - alpha) dt^2 [s2]
    e: Array  # alpha dt^2 [s2]
    half: Array  # h / 2 [m]
    free: Array  # 1 where the base has a mass of its own, 0 where it is held
    inertia: Array  # diagonal of M in (v, ey, ex, b), with the viscous damping of the step, shape (4, variants)
    drag: tuple[Array, Array] | None  # c M, and (1 - delta) dt [s]; None where nothing is damped
    load: Array  # load and weight in the row of v [N]
    base_load: Array  # weight of the base [N]
    strain_load: Array  # load in the row of ey, over h/2 [N]
    kept: Array  # stiffness by which the gap is carried on [N/m]
    lost: tuple[Array, Array]  # stiffness that a slip leaves out of the coupling [N/m], and h/2 of it [N]
    area: Array  # S by which the stress is carried on [m2]
    kx: Array  # stiffness of the shear springs by which ex is carried on [N m]
    k: tuple[Array, Array, Array, Array, Array]  # K without the base: (v, v), (v, ey), (ey, ey), (ex, ey), (ex, ex)
    across: Array  # e K of (ex, ey)
    kb: tuple[Array, Array, Array]  # K of the base: (v, b), (ey, b), (b, b)
    ends: tuple[Array, Array]  # M + e K of ex and of b, which are eliminated first
    onto: tuple[Array, Array, Array]  # by which b goes into the row of v and of ey, and ex into that of ey
    left: tuple[Array, Array, Array]  # what remains: (v, v), (v, ey) and the pivot of ey


class _Stepping:
    """The stepping of all variants at once; every attribute is an array over them."""

    def __init__(self, column: Column, variants: Sequence[Variant]) -> None:
        self.column = column

        def each(name: str) -> Array:
            return np.array([getattr(v, name) for v in variants], dtype=float)

        self.alpha, self.delta, gg, softness = each("alpha"), each("delta"), each("gg"), each("softness")
        formulas = np.array([v.discounted for v in variants])
        self.gg_displacement = np.where(formulas == "velocity", 1.0, gg)
        self.gg_velocity = np.where(formulas == "displacement", 1.0, gg)
        self.consistent = np.array([v.start == "consistent" for v in variants], dtype=float)
        self.updated, self.opens = each("updated"), each("opens").astype(bool)
        self.moves, self.locked = bool(np.any(self.updated)), not np.any(self.opens)
        self.kept: tuple[tuple[float, bytes], _Equations] | None = None
        self.closing, self.opening = each("band"), each("band") * each("reopening")
        self.strain_load, self.coupling, self.point = each("strain_load"), each("coupling"), each("point")
        self.keeps_stress = np.array([v.kept != "springs" for v in variants], dtype=float)
        self.keeps_springs = np.array([v.kept != "stress" for v in variants], dtype=float)
        heavy = (each("base") > 0) & (softness > 0)
        self.normal = column.normal * np.exp(-np.where(heavy, 0.0, softness))
        self.shear = column.shear * np.exp(-np.where(heavy, 0.0, softness) * each("tied"))
        self.held = np.where(heavy, 0.0, 1.0)
        self.density = column.density * each("density")
        self.c11, self.c12 = column.elasticity(variants)
        self.a, self.h = column.width * each("side"), column.height * each("side") * each("tall")
        self.base = np.where(heavy, each("base"), 1.0) * self.density * self.a * self.h
        self.kb = column.normal / np.expm1(np.where(heavy, softness, 1.0))
        self.viscous = each("viscous")
        self.gravity = column.gravity + each("weight") * GRAVITY
        self.force = each("load") * column.pressure * self.a
        zero = np.zeros(len(variants))
        self.D, self.Y, self.B, self.gap, self.sheared, self.sx, self.sy = (zero for _ in range(7))
        self.V, self.A = np.zeros((4, len(variants))), np.zeros((4, len(variants)))
        self.on = np.ones(len(variants), dtype=bool)

    def run(self, steps: Array) -> Iterator[tuple[Array, Array, Flags, Array]]:
        """Yield displacement, pressure, the open flags and the area of every step."""
        inertia, h, a = self._inertia(), self.h, self.a
        weights = (-self.force - inertia[0] * self.gravity, -self.strain_load * self.force * h / 2)
        load = np.array([*weights, np.zeros_like(h), np.zeros_like(h)])
        self.A = self.consistent * load / inertia
        area, height, stiffness = self.a * self.h / (a * h), self.point * h / 2, -self.normal
        for dt in steps.tolist():
            if self.moves:
                area = self.a * self.h / (a * h)
            self._step(dt)
            yield self.D + height * self.Y, np.where(self.on, stiffness * self.gap, 0.0) / a, ~self.on, area

    def _inertia(self) -> Array:
        """Return the diagonal of M in (v, ey, ex, b), shape (4, variants)."""
        m = self.density * self.a * self.h
        return np.array([m, m * self.h**2 / 12, m * self.a**2 / 12, self.base])

    def _step(self, dt: float) -> None:
        equations = self._equations(dt)
        star = equations.ahead[0] * self.V + equations.ahead[1] * self.A
        for _ in range(OPEN_CLOSE_ITERATIONS):
            x, acceleration = self._solve(equations, star)
            gap = self.gap + x[0] - equations.half * x[1] - x[3]
            if self.locked:
                break
            on = np.where(self.opens, gap < np.where(self.on, self.opening, -self.closing), True)
            if np.array_equal(on, self.on):
                break
            self.on = on
            equations = self._equations(dt)
        self._accept(dt, x, acceleration, gap)

    def _equations(self, dt: float) -> _Equations:
        """Return the equations of a step, kept as long as length of step, contact state and geometry stay."""
        key = (dt, self.on.tobytes())
        if self.kept is None or self.kept[0] != key:
            self.kept = key, self._made(dt)
        return self.kept[1]

    def _made(self, dt: float) -> _Equations:
        e, S, half, free = self.alpha * dt * dt, self.a * self.h, self.h / 2, 1 - self.held
        mass = self._inertia()
        M = mass * (1 + self.viscous * self.delta * dt)
        k = np.where(self.on, self.normal, 0.0)
        kx = np.where(self.on, self.shear * self.a**2 / 4, 0.0)
        Kvy, Kyy = -self.coupling * k * half, S * self.c11 + k * half**2
        Kxy, Kxx = S * self.c12, S * self.c11 + kx
        Kvb, Kyb, Kbb = -k * free, k * half * free, k + self.kb
        ends = M[2] + e * Kxx, M[3] + e * Kbb
        tx, tb = e / ends[0], e / ends[1]
        Svv, Svy = M[0] + e * (k - tb * Kvb**2), e * (Kvy - tb * Kvb * Kyb)
        Syy = M[1] + e * (Kyy - tb * Kyb**2 - tx * Kxy**2)
        lost = (1 - self.coupling) * k * self.keeps_springs
        return _Equations(
            ahead=(self.gg_displacement * dt, dt * dt * (0.5 - self.alpha)),
            e=e,
            half=half,
            free=free,
            inertia=M,
            drag=(self.viscous * mass, dt * (1 - self.delta)) if np.any(self.viscous) else None,
            load=-self.force - mass[0] * self.gravity,
            base_load=mass[3] * self.gravity,
            strain_load=self.strain_load * self.force,
            kept=k * self.keeps_springs,
            lost=(lost, lost * half),
            area=S * self.keeps_stress,
            kx=kx * self.keeps_springs,
            k=(k, Kvy, Kyy, Kxy, Kxx),
            across=e * Kxy,
            kb=(Kvb, Kyb, Kbb),
            ends=ends,
            onto=(tb * Kvb, tb * Kyb, tx * Kxy),
            left=(Svv, Svy, Syy - Svy**2 / Svv),
        )

    def _solve(self, q: _Equations, star: Array) -> tuple[Array, Array]:
        """Return the increments (v, ey, ex, b) and the accelerations at the end for the present contact state."""
        (k, Kvy, Kyy, Kxy, Kxx), (Kvb, Kyb, Kbb), e = q.k, q.kb, q.e
        pressed = q.kept * self.gap
        F = np.empty_like(star)
        F[0] = q.load - pressed - q.lost[1] * self.Y
        F[1] = (pressed - q.strain_load - q.lost[0] * self.D) * q.half - q.area * self.sy
        F[2] = -(q.area * self.sx) - q.kx * self.sheared
        F[3] = q.free * (pressed - self.kb * self.B - q.base_load)
        if q.drag is not None:
            F -= q.drag[0] * (self.gg_velocity * self.V + q.drag[1] * self.A)
        rv, ry, rx, rb = q.inertia * star + e * F
        (vb, yb, xy), (Svv, Svy, pivot) = q.onto, q.left
        rv, ry = rv - vb * rb, ry - yb * rb - xy * rx
        y = (ry - Svy * rv / Svv) / pivot
        v = (rv - Svy * y) / Svv
        x = (rx - q.across * y) / q.ends[0]
        coupled = Kvb * v + Kyb * y
        b = (rb - e * coupled) / q.ends[1]
        F[0] -= k * v + Kvy * y + Kvb * b
        F[1] -= Kvy * v + Kyy * y + Kxy * x + Kyb * b
        F[2] -= Kxy * y + Kxx * x
        F[3] -= q.free * (coupled + Kbb * b)
        return np.array([v, y, x, b]), F / q.inertia

    def _accept(self, dt: float, x: Array, acceleration: Array, gap: Array) -> None:
        """Move to the end of the step."""
        self.V = self.gg_velocity * self.V + dt * ((1 - self.delta) * self.A + self.delta * acceleration)
        self.A, self.gap, self.D, self.B = acceleration, gap, self.D + x[0], self.B + x[3]
        self.Y = self.Y + x[1]
        self.sy = self.sy + self.c11 * x[1] + self.c12 * x[2]
        self.sx = self.sx + self.c11 * x[2] + self.c12 * x[1]
        self.sheared = np.where(self.on, self.sheared + x[2], 0.0)
        if self.moves:
            self.h = self.h * (1 + self.updated * x[1])
            self.a = self.a * (1 + self.updated * x[2])
            self.kept = None
