"""The block of one strain on two corner springs: its data, and its matrices in decimal arithmetic.

The block is a rectangle of width a and height b whose displacement is linear, with X, Y from the centroid::

    u(X, Y) = u + ux X + uy Y,    v(X, Y) = v + vx X + vy Y

The usual unknowns (u, v, r, ex, ey, gxy) are ex = ux, ey = vy, gxy = uy + vx and r = (vx - uy) / 2. In
(u, v, ux, uy, vx, vy) the mass matrix is diagonal: m (1, 1, a^2/12, b^2/12, a^2/12, b^2/12), m = rho a b.
The corners M = (0, 0) and N = (a, 0) have the normal gap w = g0 + v(X, -b/2), positive when open, and the
shear stretch s = u(X, -b/2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from decimal import Decimal

from fem_reference.events.decimals import HALF, ONE, TWO, ZERO, Matrix, Vector

CORNERS = ("M", "N")
HYPOTHESES = ("plane stress", "plane strain")
POSITIVE = ("width", "height", "density", "young", "stiffness")
UNSIGNED = ("shear_stiffness", "gap")


@dataclass(frozen=True)
class BlockProblem:
    """A block of one strain that is dropped on or pressed against two no-tension corner springs.

    At t = 0 the block is unstrained, its base a gap above the springs, and all loads are switched on.
    A closed corner carries the normal force N = -p w >= 0 and the shear force T = -p_s (s - r), where the
    reference r is the shear stretch at which it closed; an open corner carries nothing.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    width: float  # width a of the block [m], unit thickness
    height: float  # height b [m]
    density: float  # mass density rho [kg/m3]
    young: float  # Young's modulus E [Pa]
    stiffness: float  # normal stiffness p of one corner [N/m]
    pressure: float = 0.0  # pressure q on the top edge [Pa], downwards, from t = 0 on
    shear_stiffness: float = 0.0  # shear stiffness p_s of a closed corner [N/m]; 0: frictionless, else glued in shear
    poisson: float = 0.0  # Poisson's ratio mu [-]
    hypothesis: str = "plane stress"  # ``"plane stress"`` or ``"plane strain"``
    eccentricity: float = 0.0  # shift e towards +x of the middle of the pressed part of the top, a - 2 |e| long [m]
    traction: float = 0.0  # traction towards +x on the whole top edge [Pa]
    gravity: float = 0.0  # acceleration of gravity, downwards [m/s2]
    gap: float = 0.0  # gap g0 under both corners at t = 0 [m]
    velocity: float = 0.0  # velocity of the block at t = 0 [m/s], upwards positive: an impact has a negative one

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name != "hypothesis" and not math.isfinite(value):
                raise ValueError(f"{field.name}: must be a finite number, got {value!r}")
        for name in POSITIVE:
            if getattr(self, name) <= 0:
                raise ValueError(f"{name}: must be positive, got {getattr(self, name)!r}")
        for name in UNSIGNED:
            if getattr(self, name) < 0:
                raise ValueError(f"{name}: must not be negative, got {getattr(self, name)!r}")
        self._check_material()
        if 2 * abs(self.eccentricity) >= self.width:
            rule = f"must be below half the width {self.width / 2:g}"
            raise ValueError(f"eccentricity: {rule}, got {self.eccentricity!r}")

    def _check_material(self) -> None:
        if self.hypothesis not in HYPOTHESES:
            raise ValueError(f"hypothesis: must be one of {HYPOTHESES}, got {self.hypothesis!r}")
        highest = 1.0 if self.hypothesis == "plane stress" else 0.5
        if not -1 < self.poisson < highest:
            rule = f"must be above -1 and below {highest:g} in {self.hypothesis}"
            raise ValueError(f"poisson: {rule}, got {self.poisson!r}")


@dataclass(frozen=True)
class BlockModel:
    """Matrices of a block in the unknowns (u, v, ux, uy, vx, vy)."""

    mass: Vector  # diagonal of the mass matrix [kg, kg m2]
    elastic: Matrix  # stiffness of the strained block [N/m, N m]
    load: Vector  # loads of pressure, traction and weight [N, N m]
    normal: Matrix  # gap of each corner less g0, as rows over the unknowns [-, m]
    shear: Matrix  # shear stretch of each corner, as rows over the unknowns [-, m]
    gap: Decimal  # gap g0 at t = 0 [m]
    p: Decimal  # normal stiffness of a corner [N/m]
    ps: Decimal  # shear stiffness of a corner [N/m]
    velocity: Vector  # velocities at t = 0 [m/s, 1/s]

    @classmethod
    def of(cls, problem: BlockProblem) -> BlockModel:
        """The matrices in the precision of the current decimal context."""
        a, b, rho = Decimal(problem.width), Decimal(problem.height), Decimal(problem.density)
        m = rho * a * b
        second = (m * a * a / 12, m * b * b / 12)
        half, down = a / 2, -(b / 2)  # rounded before signs are given: what is symmetric cancels to an exact zero
        return cls(
            mass=[m, m, *second, *second],
            elastic=_elastic(problem, a * b),
            load=_load(problem, a, b, m),
            normal=[[ZERO, ONE, ZERO, ZERO, x, down] for x in (-half, half)],
            shear=[[ONE, ZERO, x, down, ZERO, ZERO] for x in (-half, half)],
            gap=Decimal(problem.gap),
            p=Decimal(problem.stiffness),
            ps=Decimal(problem.shear_stiffness),
            velocity=[ZERO, Decimal(problem.velocity), ZERO, ZERO, ZERO, ZERO],
        )

    def stiffness(self, closed: tuple[bool, ...]) -> Matrix:
        """Stiffness with the springs of the closed corners."""
        K = [list(row) for row in self.elastic]
        for c, shut in enumerate(closed):
            for row, k in ((self.normal[c], self.p), (self.shear[c], self.ps)) if shut else ():
                for i in range(6):
                    K[i] = [K[i][j] + k * row[i] * row[j] for j in range(6)]
        return K

    def force(self, closed: tuple[bool, ...], references: tuple[Decimal, ...]) -> Vector:
        """Loads and the constant part of the spring forces of the closed corners."""
        F = list(self.load)
        for c, shut in enumerate(closed):
            if shut:
                pull = [
                    self.ps * references[c] * s - self.p * self.gap * n
                    for s, n in zip(self.shear[c], self.normal[c], strict=True)
                ]
                F = [f + x for f, x in zip(F, pull, strict=True)]
        return F


def _elastic(problem: BlockProblem, area: Decimal) -> Matrix:
    """Area times the elastic matrix: ex = ux (2), ey = vy (5), gxy = uy + vx (3, 4)."""
    E, mu = Decimal(problem.young), Decimal(problem.poisson)
    shear = area * E / (2 * (1 + mu))
    if problem.hypothesis == "plane strain":
        E, mu = E / (1 - mu * mu), mu / (1 - mu)
    direct = area * E / (1 - mu * mu)
    K = [[ZERO] * 6 for _ in range(6)]
    K[2][2] = K[5][5] = direct
    K[2][5] = K[5][2] = mu * direct
    K[3][3] = K[4][4] = K[3][4] = K[4][3] = shear
    return K


def _load(problem: BlockProblem, a: Decimal, b: Decimal, m: Decimal) -> Vector:
    """Virtual work of the pressure on its part of the top, of the traction and of the weight."""
    q, e, t = Decimal(problem.pressure), Decimal(problem.eccentricity), Decimal(problem.traction)
    push = q * (a - TWO * abs(e))
    weight = m * Decimal(problem.gravity)
    return [t * a, -push - weight, ZERO, t * a * b * HALF, -push * e, -push * b * HALF]
