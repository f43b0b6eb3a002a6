"""The block of one strain on two corner springs: its data, and its matrices in ball arithmetic.

The block is a rectangle of width a and height b whose displacement is linear, with X, Y from the centroid::

    u(X, Y) = u + ux X + uy Y,    v(X, Y) = v + vx X + vy Y

The usual unknowns (u, v, r, ex, ey, gxy) are ex = ux, ey = vy, gxy = uy + vx and r = (vx - uy) / 2. In
(u, v, ux, uy, vx, vy) the mass matrix is diagonal: m (1, 1, a^2/12, b^2/12, a^2/12, b^2/12), m = rho a b.

All motion is seen from the base, which is at (x, y) and moves evenly between the rows of its record, and v is counted
from where the corners touch: u and v stand for u - x and v - y + g0. The corners M = (0, 0) and N = (a, 0) have the
normal gap w = v(X, -b/2), positive when open, and slide by s = u(X, -b/2).

On the block act N = -p w upwards and T towards +x. A corner that sticks has T = -p_s (s - r); one that slips has
T = sigma (tan(phi) N + C), with sigma against the direction of its sliding, and moves its reference, r = s + T / p_s.

**Dashpots.** A corner with a dashpot c beside its spring presses with N = max(0, -(p w + c w')) while w < 0, and with
nothing above. So the force jumps to -c w' as the gap closes, and it reaches zero on the way back while w is still
negative: the spring has not come back, and from there on the corner is *released*. A released corner carries nothing.
It presses again if p w + c w' falls to zero, which is at the rate w' = -p w / c > 0 and not at w' = 0, and it
is open once its gap is positive.

**Rigid contact** (p infinite) has an impact law: a gap of both corners that closes at the rate w' < 0 has the rate
-e w' right after. The impulse of both corners together is::

    J = -(1 + e) w' / C,    C = n M^-1 n',    n x = v - (b/2) vy the gap of both corners

with C = 4/m for a block of one strain and 1/m for a rigid one, and the energy (1 - e^2) w'^2 / (2 C) is lost. What
rests on a rigid contact keeps w'' = 0 by the force N = -n M^-1 (F - K x) / C >= 0 until this would have to pull.

**A rigid block** (E infinite) has no strain: forces change only its velocities of translation and its rotation, so that
M^-1 becomes the sum of d d' / (d' M d) over its three rigid motions d.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from flint import arb, arb_mat

from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.motion import Motion

CORNERS = ("M", "N")
HYPOTHESES = ("plane stress", "plane strain")
POSITIVE = ("width", "height", "density", "young", "stiffness")
UNSIGNED = ("shear_stiffness", "gap", "cohesion", "damping")
INFINITE = ("young", "stiffness")
"""Fields that may be infinite: of a rigid block and of a rigid contact."""
OPEN = 0
STICKS = 1
RIGHT = 2
LEFT = -2
RELEASED = 3
"""States of a corner; `RIGHT` and `LEFT` slip towards +x and -x; see above on a released one, which carries nothing."""
CARRIES_NOTHING = (OPEN, RELEASED)
States = tuple[int, int]
Vector = list[arb]


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
    young: float  # Young's modulus E [Pa]; `math.inf`: a rigid block
    stiffness: float  # normal stiffness p of one corner [N/m]; `math.inf`: rigid contact, which needs `restitution`
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
    damping: float = 0.0  # dashpot c beside the normal spring of one corner, which never pulls [N s/m]
    restitution: float | None = None  # e of the impact law of rigid contact [-], from 0, plastic, to 1, elastic

    def __post_init__(self) -> None:
        require_numbers(self, POSITIVE, UNSIGNED, INFINITE)
        require(self.hypothesis in HYPOTHESES, "hypothesis", f"must be one of {HYPOTHESES}", self.hypothesis)
        highest = 1.0 if self.hypothesis == "plane stress" else 0.5
        rule = f"must be above -1 and below {highest:g} in {self.hypothesis}"
        require(-1 < self.poisson < highest, "poisson", rule, self.poisson)
        rule = f"must be below half the width {self.width / 2:g}"
        require(2 * abs(self.eccentricity) < self.width, "eccentricity", rule, self.eccentricity)
        require(-90 < self.slope < 90, "slope", "must be between -90 and 90", self.slope)
        if self.friction is None:
            require(self.cohesion == 0, "cohesion", "must be 0 without friction", self.cohesion)
        else:
            require(0 <= self.friction < 90, "friction", "must be at least 0 and below 90", self.friction)
            require(self.shear_stiffness > 0, "shear_stiffness", "must be positive with friction", self.shear_stiffness)
        free = self.friction is None and not self.gap and not self.velocity
        require(free or not self.locked, "locked", "must be without friction, gap and velocity", self.locked)
        springs = self.friction is None and not self.locked and not self.rigid_contact
        rule = "must be 0 with friction, locked contact or rigid contact, whose loss is set by restitution"
        require(springs or self.damping == 0, "damping", rule, self.damping)
        self._check_impact_law()

    def _check_impact_law(self) -> None:
        """Raise for what rigid contact is not solved for: both its corners do the same, and nothing acts sideways."""
        e = self.restitution
        if e is None:
            rule = "must be finite, or rigid contact needs a restitution"
            require(not self.rigid_contact, "stiffness", rule, self.stiffness)
            return
        require(0 <= e <= 1, "restitution", "must be from 0 to 1", e)
        require(self.rigid_contact, "stiffness", "must be infinite with restitution", self.stiffness)
        alone = self.friction is None and not self.locked
        require(alone, "restitution", "must be without friction and locked", e)
        centred = not (self.eccentricity or self.traction or self.slope) and self.base is None
        rule = "must be without eccentricity, traction, slope and base, so that both corners do the same"
        require(centred, "restitution", rule, e)

    @property
    def rigid_contact(self) -> bool:
        """Whether the contact has no springs."""
        return math.isinf(self.stiffness)

    @property
    def rigid(self) -> bool:
        """Whether the block has no strain."""
        return math.isinf(self.young)


@dataclass(frozen=True)
class Base:
    """Where the base is at an instant, and how it goes on until the next row of its record."""

    x: arb  # displacement along the base [m]
    y: arb  # displacement upwards [m]
    vx: arb  # rate of x [m/s]
    vy: arb  # rate of y [m/s]


class Course:
    """The path of the base from row to row of its record; it stays where it is beyond the ends."""

    def __init__(self, motion: Motion | None) -> None:
        self.motion = motion or Motion((0.0,), (0.0,), (0.0,))

    def from_row(self, index: int) -> Base:
        """The base at a row of its record, and its velocity from then on; before the first row it is there at rest."""
        motion = self.motion
        still = arb(0)
        x = arb(motion.x[max(index, 0)])
        y = arb(motion.y[max(index, 0)])
        if index < 0 or index + 1 == len(motion.time):
            return Base(x, y, still, still)
        spacing = arb(motion.time[index + 1]) - arb(motion.time[index])
        return Base(x, y, (arb(motion.x[index + 1]) - x) / spacing, (arb(motion.y[index + 1]) - y) / spacing)

    def at_start(self) -> tuple[int, Base]:
        """The last row up to t = 0 (-1: there is none), and the base then."""
        index = bisect_right(self.motion.time, 0.0) - 1
        row = self.from_row(index)
        passed = -arb(self.motion.time[max(index, 0)])
        return index, Base(row.x + row.vx * passed, row.y + row.vy * passed, row.vx, row.vy)


def row(x: Sequence[arb | int] = (0,) * 6, one: arb | int = 0) -> arb_mat:
    """A function of z = (x, x', r, 1), see `BlockModel`, from its weights over the unknowns and its constant part."""
    return arb_mat([[arb(entry) for entry in (*x, *[0] * 8, one)]])


def rate_row(x: Sequence[arb | int]) -> arb_mat:
    """A function of z from its weights over the rates of the unknowns."""
    return arb_mat([[arb(entry) for entry in (*[0] * 6, *x, *[0] * 3)]])


class BlockModel:
    """A block in the unknowns x = (u, v, ux, uy, vx, vy), in the precision of the current context.

    Functions are rows over z = (x, x', r, 1), r being the references of both corners.
    """

    def __init__(self, problem: BlockProblem) -> None:
        a = arb(problem.width)
        b = arb(problem.height)
        m = arb(problem.density) * a * b
        self.locked = problem.locked  # whether the corners never change their state
        self.mass = [m, m, *(m * a * a / 12, m * b * b / 12) * 2]  # diagonal of the mass matrix [kg, kg m2]
        # gap and slide of each corner over the unknowns [-, m]
        self.normal = [[arb(0), arb(1), arb(0), arb(0), x, -b / 2] for x in (-a / 2, a / 2)]
        self.shear = [[arb(1), arb(0), x, -b / 2, arb(0), arb(0)] for x in (-a / 2, a / 2)]
        self.gaps = [row(weights) for weights in self.normal]  # w [m]
        self.gap_rates = [rate_row(weights) for weights in self.normal]  # w' [m/s]
        self.slides = [row(weights) for weights in self.shear]  # s [m]
        references = [arb_mat([[arb(int(j == 12 + c)) for j in range(15)]]) for c in (0, 1)]
        self.stuck = [slide - r for slide, r in zip(self.slides, references, strict=True)]  # s - r [m]
        # normal stiffness of a corner [N/m]; a rigid contact has no springs, and its force is that of its constraint
        self.p = arb(0) if problem.rigid_contact else arb(problem.stiffness)
        self.damping = arb(problem.damping)  # of the dashpot of a corner [N s/m]
        self.ps = arb(problem.shear_stiffness)  # shear stiffness of a corner [N/m]
        # tan(phi) of the doubles that DDA computes with too; None: a closed corner never slips
        self.tan = None if problem.friction is None else arb(math.tan(math.radians(problem.friction)))
        self.cohesion = a * arb(problem.cohesion) / 2  # of a corner [N]
        self.elastic = _elastic(problem, a * b)  # stiffness of the strained block [N/m, N m]
        self.load = _load(problem, a, b, m)  # loads of pressure, traction and weight [N, N m]
        self.mobility = self._mobility(problem.rigid)  # M^-1, of a rigid block over its rigid motions [1/kg, 1/(kg m2)]
        self.contact = None if problem.restitution is None else RigidContact(self, arb(problem.restitution))
        self.readings, self.readings_inverse = self._readings()
        self.reading_sizes = np.array([[float(abs(entry)) for entry in line] for line in self.readings.tolist()])
        self.reading_sizes *= 1 + 1e-9

    @property
    def friction(self) -> arb:
        """tan(phi) of a corner that can slip, else 0."""
        return arb(0) if self.tan is None else self.tan

    @cached_property
    def reserves(self) -> dict[tuple[int, int], arb_mat]:
        """What a corner that sticks can carry before it slips, tan(phi) N + C - sign T, by corner and sign [N]."""
        limits = [gap * (-self.friction * self.p) + row(one=self.cohesion) for gap in self.gaps]
        return {(c, sign): limits[c] + self.stuck[c] * (sign * self.ps) for c in (0, 1) for sign in (1, -1)}

    def base_work(self, base: Base, z: arb_mat, later: arb_mat, time: arb) -> arb:
        """Work of an evenly moving base from one state to a later one: what the springs add to the momentum [J]."""
        if base.vx == 0 and base.vy == 0:
            return arb(0)
        m = self.mass[0]
        load = self.load
        along, upwards = (m * (later[6 + i, 0] - z[6 + i, 0]) - load[i] * time for i in (0, 1))
        return base.vx * along + base.vy * upwards

    def generator(self, states: States) -> arb_mat:
        """The G of z' = G z with the springs and dashpots of the closed corners, shape (15, 15).

        x'' = W (f + R r - B x - D x') with W the mobility, where B need not be symmetric; the reference of a corner
        counts where it sticks.
        """
        zero = arb(0)
        B = [list(line) for line in self.elastic]
        D = [[zero] * 6 for _ in range(6)]
        f = list(self.load)
        R = [[zero, zero] for _ in range(6)]
        for c, state in enumerate(states):
            n = self.normal[c]
            s = self.shear[c]
            for i in range(6):
                if state == STICKS:
                    B[i] = [B[i][j] + self.p * n[i] * n[j] + self.ps * s[i] * s[j] for j in range(6)]
                    D[i] = [D[i][j] + self.damping * n[i] * n[j] for j in range(6)]
                    R[i][c] = self.ps * s[i]
                elif state not in CARRIES_NOTHING:
                    direction = n[i] + sigma(state) * self.friction * s[i]
                    B[i] = [B[i][j] + self.p * direction * n[j] for j in range(6)]
                    f[i] = f[i] + sigma(state) * self.cohesion * s[i]
        forces = [[-x for x in B[i]] + [-x for x in D[i]] + [*R[i], f[i]] for i in range(6)]
        accelerations = self.mobility * arb_mat(forces)
        if self.contact is not None and states[0] == STICKS:
            accelerations = accelerations + self.contact.acceleration * self.contact.force
        G = [[zero] * 15 for _ in range(15)]
        for i, line in enumerate(accelerations.tolist()):
            G[i][6 + i] = arb(1)
            G[6 + i] = line
        return arb_mat(G)

    def _mobility(self, rigid: bool) -> arb_mat:
        """M^-1, or the sum of d d' / (d' M d) over the rigid motions d, shape (6, 6)."""
        zero = arb(0)
        W = [[zero] * 6 for _ in range(6)]
        if not rigid:
            for i, m in enumerate(self.mass):
                W[i][i] = 1 / m
            return arb_mat(W)
        W[0][0] = W[1][1] = 1 / self.mass[0]
        # a rotation has uy = -r and vx = r
        turning = 1 / (self.mass[3] + self.mass[4])
        W[3][3] = W[4][4] = turning
        W[3][4] = W[4][3] = -turning
        return arb_mat(W)

    def _readings(self) -> tuple[arb_mat, arb_mat]:
        """Z as gaps, stretches s - r, uy, vy, the rates of these, r and 1, and back.

        They hold what the forces of stiff corners depend on, which floats of the unknowns would lose.
        """
        over = [*self.normal, *self.shear, *([arb(int(i == j)) for j in range(6)] for i in (3, 5))]
        lines = [row(weights).entries() for weights in over]
        lines += [[arb(0)] * 6 + line[:9] for line in lines]
        lines += [[arb(int(i == j)) for j in range(15)] for i in (12, 13, 14)]
        lines[2], lines[3] = (stuck.entries() for stuck in self.stuck)
        readings = arb_mat(lines)
        return readings, readings.inv()


class RigidContact:
    """The contact of both corners with a rigid base, and its impact law; rows and columns are over z.

    With n the row of the gap of both corners and W the mobility: an impulse J on both corners changes x' by W n' J, and
    the gap's rate by C J.
    """

    def __init__(self, model: BlockModel, restitution: arb) -> None:
        self.restitution = restitution  # e [-]
        n = [(one + other) / 2 for one, other in zip(*model.normal, strict=True)]
        self.gap = row(n)  # w [m]
        self.rate = rate_row(n)  # w' [m/s]
        self.acceleration = model.mobility * arb_mat([n]).transpose()  # W n', shape (6, 1) [1/kg]
        self.compliance = (arb_mat([n]) * self.acceleration)[0, 0]  # C [1/kg]
        # the force of both corners that keeps w'' = 0 over z: -n W (F - K x) / C [N]; springs aside do not move the gap
        loads = [[-x for x in line] + [arb(0)] * 8 + [f] for line, f in zip(model.elastic, model.load, strict=True)]
        self.force = self.acceleration.transpose() * arb_mat(loads) * (-1 / self.compliance)
        # what changes the gap's rate by one [-]
        direction = [entry / self.compliance for entry in self.acceleration.entries()]
        self.direction = arb_mat(15, 1, [*[arb(0)] * 6, *direction, *[arb(0)] * 3])

        # what changes the gap by one
        self.lift = arb_mat(15, 1, [*direction, *[arb(0)] * 9])

    def impulse(self, approach: arb) -> arb:
        """Impulse on both corners of an impact at which the gap closes at a speed, (1 + e) |w'| / C [N s]."""
        return (1 + self.restitution) * approach / self.compliance

    def loss(self, approach: arb) -> arb:
        """Energy that an impact loses, (1 - e^2) w'^2 / (2 C) [J]."""
        return (1 - self.restitution * self.restitution) * approach * approach / (2 * self.compliance)

    def impact(self) -> arb_mat:
        """From z before an impact to z after it, shape (15, 15)."""
        return _identity() - self.direction * self.rate * (1 + self.restitution)

    def rest(self) -> arb_mat:
        """The projection of z to no gap and no rate of it, along the direction of impulses, shape (15, 15)."""
        return _identity() - self.direction * self.rate - self.lift * self.gap


def _identity() -> arb_mat:
    return arb_mat(15, 15, [int(i == j) for i in range(15) for j in range(15)])


def _elastic(problem: BlockProblem, area: arb) -> list[Vector]:
    """Area times the elastic matrix: ex = ux (2), ey = vy (5), gxy = uy + vx (3, 4); zero if there is no strain."""
    if problem.rigid:
        return [[arb(0)] * 6 for _ in range(6)]
    E = arb(problem.young)
    mu = arb(problem.poisson)
    shear = area * E / (2 * (1 + mu))
    if problem.hypothesis == "plane strain":
        E = E / (1 - mu * mu)
        mu = mu / (1 - mu)
    direct = area * E / (1 - mu * mu)
    K = [[arb(0)] * 6 for _ in range(6)]
    K[2][2] = K[5][5] = direct
    K[2][5] = K[5][2] = mu * direct
    K[3][3] = K[4][4] = K[3][4] = K[4][3] = shear
    return K


def _load(problem: BlockProblem, a: arb, b: arb, m: arb) -> Vector:
    """Virtual work of the pressure on its part of the top, of the traction and of the weight."""
    q = arb(problem.pressure)
    e = arb(problem.eccentricity)
    t = arb(problem.traction)
    push = q * (a - 2 * abs(e))
    turn = math.radians(problem.slope)
    weight = m * arb(problem.gravity)
    along = weight * arb(math.sin(turn))
    down = weight * arb(math.cos(turn))
    return [t * a + along, -push - down, arb(0), t * a * b / 2, -push * e, -push * b / 2]
