"""The block of one strain on two corner springs: its data, and its matrices in decimal arithmetic.

The block is a rectangle of width a and height b whose displacement is linear, with X, Y from the centroid::

    u(X, Y) = u + ux X + uy Y,    v(X, Y) = v + vx X + vy Y

The usual unknowns (u, v, r, ex, ey, gxy) are ex = ux, ey = vy, gxy = uy + vx and r = (vx - uy) / 2. In
(u, v, ux, uy, vx, vy) the mass matrix is diagonal: m (1, 1, a^2/12, b^2/12, a^2/12, b^2/12), m = rho a b.
The corners M = (0, 0) and N = (a, 0) have the normal gap w = g0 + v(X, -b/2) - y(t), positive when open, and
slide by s = u(X, -b/2) - x(t), where (x, y) is the motion of the base.

On the block act N = -p w upwards and T towards +x. A corner that sticks has T = -p_s (s - r); one that slips has
T = sigma (tan(phi) N + C), with sigma against the direction of its sliding, and moves its reference, r = s + T / p_s.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass, fields, replace
from decimal import Decimal

from fem_reference.events.decimals import HALF, ONE, TWO, ZERO, Matrix, Vector
from fem_reference.problem.motion import Motion

CORNERS = ("M", "N")
HYPOTHESES = ("plane stress", "plane strain")
POSITIVE = ("width", "height", "density", "young", "stiffness")
UNSIGNED = ("shear_stiffness", "gap", "cohesion")
OPEN, STICKS, RIGHT, LEFT = 0, 1, 2, -2
"""States of a corner; `RIGHT` and `LEFT` slip towards +x and -x."""
States = tuple[int, int]


def sigma(state: int) -> int:
    """Sign of the shear force of a corner that slips."""
    return -1 if state == RIGHT else 1


@dataclass(frozen=True)
class BlockProblem:
    """A block of one strain that is dropped on or pressed against two no-tension corner springs.

    At t = 0 the block is unstrained, its base a gap above the springs, and all loads are switched on.
    A closed corner carries the normal force N = -p w >= 0 and the shear force T = -p_s (s - r), where the
    reference r is the slide at which it closed; an open corner carries nothing. With friction |T| is at most
    tan(phi) N + C, where C is half of cohesion times width, and a corner at this limit moves its reference. Cohesion
    is lost while a corner is open, and acts again once it has closed.

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
    slope: float = 0.0  # angle by which gravity is turned towards +x, as on an incline [deg]
    friction: float | None = None  # angle phi of friction [deg]; None: a closed corner never slips
    cohesion: float = 0.0  # shear strength without normal force over the whole base [Pa]
    base: Motion | None = None  # motion of the base; None: at rest
    locked: bool = False  # whether the springs of the corners also pull and nothing opens or slips

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, int | float) and not math.isfinite(value):
                raise ValueError(f"{field.name}: must be a finite number, got {value!r}")
        for name in POSITIVE:
            if getattr(self, name) <= 0:
                raise ValueError(f"{name}: must be positive, got {getattr(self, name)!r}")
        for name in UNSIGNED:
            if getattr(self, name) < 0:
                raise ValueError(f"{name}: must not be negative, got {getattr(self, name)!r}")
        self._check_material()
        self._check_friction()
        if self.locked and (self.friction is not None or self.gap or self.velocity):
            raise ValueError("locked: must be without friction, gap and velocity, got one of them")
        if 2 * abs(self.eccentricity) >= self.width:
            rule = f"must be below half the width {self.width / 2:g}"
            raise ValueError(f"eccentricity: {rule}, got {self.eccentricity!r}")

    def _check_friction(self) -> None:
        if not -90 < self.slope < 90:
            raise ValueError(f"slope: must be between -90 and 90, got {self.slope!r}")
        if self.friction is None and self.cohesion > 0:
            raise ValueError(f"cohesion: must be 0 without friction, got {self.cohesion!r}")
        if self.friction is not None and not 0 <= self.friction < 90:
            raise ValueError(f"friction: must be at least 0 and below 90, got {self.friction!r}")
        if self.friction is not None and self.shear_stiffness == 0:
            raise ValueError("shear_stiffness: must be positive with friction, got 0.0")

    def _check_material(self) -> None:
        if self.hypothesis not in HYPOTHESES:
            raise ValueError(f"hypothesis: must be one of {HYPOTHESES}, got {self.hypothesis!r}")
        highest = 1.0 if self.hypothesis == "plane stress" else 0.5
        if not -1 < self.poisson < highest:
            rule = f"must be above -1 and below {highest:g} in {self.hypothesis}"
            raise ValueError(f"poisson: {rule}, got {self.poisson!r}")


@dataclass(frozen=True)
class Base:
    """Where the base is at an instant, and how it goes on until the next row of its record."""

    x: Decimal = ZERO  # displacement along the base [m]
    y: Decimal = ZERO  # displacement upwards [m]
    vx: Decimal = ZERO  # rate of x [m/s]
    vy: Decimal = ZERO  # rate of y [m/s]

    def after(self, s: Decimal) -> Base:
        """The base a time s later."""
        return replace(self, x=self.x + self.vx * s, y=self.y + self.vy * s)


@dataclass(frozen=True)
class Course:
    """The path of the base from row to row of its record, held beyond its ends."""

    rows: tuple[tuple[Decimal, Decimal, Decimal], ...]  # instants [s] with x and y [m]

    @classmethod
    def of(cls, motion: Motion | None) -> Course:
        """The path of a record; a base at rest without one."""
        if motion is None:
            return cls(((ZERO, ZERO, ZERO),))
        rows = zip(motion.time, motion.x, motion.y, strict=True)
        return cls(tuple((Decimal(t), Decimal(x), Decimal(y)) for t, x, y in rows))

    def base(self, time: Decimal) -> Base:
        """The base from an instant on."""
        later = bisect_right(self.rows, time, key=lambda row: row[0])
        if later in (0, len(self.rows)):
            return Base(*self.rows[min(later, len(self.rows) - 1)][1:])
        (t0, x0, y0), (t1, x1, y1) = self.rows[later - 1 : later + 1]
        vx, vy = (x1 - x0) / (t1 - t0), (y1 - y0) / (t1 - t0)
        return Base(x0 + vx * (time - t0), y0 + vy * (time - t0), vx, vy)

    def following(self, time: Decimal) -> Decimal | None:
        """The first instant of the record after an instant, None after the last one."""
        later = bisect_right(self.rows, time, key=lambda row: row[0])
        return self.rows[later][0] if later < len(self.rows) else None


Pair = tuple[Decimal, Decimal]


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
    tan: Decimal | None  # tan(phi) [-]; None: a closed corner never slips
    C: Decimal  # cohesion of a corner [N]
    locked: bool = False  # whether the corners never change their state

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
            tan=None if problem.friction is None else Decimal(math.tan(math.radians(problem.friction))),
            C=a * Decimal(problem.cohesion) / 2,
            locked=problem.locked,
        )

    def stiffness(self, states: States) -> Matrix:
        """Stiffness with the springs of the closed corners; not symmetric where one slips."""
        K = [list(row) for row in self.elastic]
        for c, state in enumerate(states):
            for left, right, k in self._springs(c, state):
                for i in range(6):
                    K[i] = [K[i][j] + k * left[i] * right[j] for j in range(6)]
        return K

    def _springs(self, corner: int, state: int) -> list[tuple[Vector, Vector, Decimal]]:
        """Stiffnesses k of a corner with the direction of their force and that of what they feel."""
        n, s = self.normal[corner], self.shear[corner]
        if state == OPEN:
            return []
        if state == STICKS:
            return [(n, n, self.p), (s, s, self.ps)]
        return [(n, n, self.p), (s, n, sigma(state) * self.friction * self.p)]

    @property
    def friction(self) -> Decimal:
        """tan(phi) of a corner that can slip."""
        return ZERO if self.tan is None else self.tan

    def forces(self, states: States, references: Pair, base: Base) -> tuple[Vector, Vector]:
        """Loads and the parts of the spring forces that do not depend on the block, at a time s: F0 + F1 s."""
        F0, F1 = list(self.load), [ZERO] * 6
        for c, state in enumerate(states):
            if state != OPEN:
                (N0, N1), (T0, T1) = self._pushes(state, references[c], base)
                both = list(zip(self.normal[c], self.shear[c], strict=True))
                F0 = [f + N0 * n + T0 * s for f, (n, s) in zip(F0, both, strict=True)]
                F1 = [f + N1 * n + T1 * s for f, (n, s) in zip(F1, both, strict=True)]
        return F0, F1

    def _pushes(self, state: int, reference: Decimal, base: Base) -> tuple[Pair, Pair]:
        """Normal and shear force of a closed corner, less what the block's displacement adds, and their rates."""
        N = self.p * (base.y - self.gap), self.p * base.vy
        if state == STICKS:
            return N, (self.ps * (base.x + reference), self.ps * base.vx)
        sign = sigma(state)
        return N, (sign * (self.friction * N[0] + self.C), sign * self.friction * N[1])


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
    turn, weight = math.radians(problem.slope), m * Decimal(problem.gravity)
    along, down = weight * Decimal(math.sin(turn)), weight * Decimal(math.cos(turn))
    return [t * a + along, -push - down, ZERO, t * a * b * HALF, -push * e, -push * b * HALF]
