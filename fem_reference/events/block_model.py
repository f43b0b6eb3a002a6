"""The block of one strain on two corner springs: its data, and its matrices in ball arithmetic.

The block is a rectangle of width a and height b whose displacement is linear, with X, Y from the centroid::

    u(X, Y) = u + ux X + uy Y,    v(X, Y) = v + vx X + vy Y

The usual unknowns (u, v, r, ex, ey, gxy) are ex = ux, ey = vy, gxy = uy + vx and r = (vx - uy) / 2. In
(u, v, ux, uy, vx, vy) the mass matrix is diagonal: m (1, 1, a^2/12, b^2/12, a^2/12, b^2/12), m = rho a b.

All motion is seen from the base, which is at (x, y) and moves evenly between the rows of its record, and v is counted
from where the corners touch: u and v stand for u - x and v - y + g0. The corners M = (0, 0) and N = (a, 0) have the
normal gap w = v(X, -b/2), positive when open, and slide by s = u(X, -b/2).

On the block act N = -p w >= 0 upwards and T towards +x while a corner is closed. One that sticks has T = -p_s (s - r);
one that slips has T = sigma (tan(phi) N + C), with sigma against the direction of its sliding, and moves its reference,
r = s + T / p_s.

**Dashpots.** A corner with a dashpot c beside its spring presses with N = max(0, -(p w + c w')) while w < 0, and with
nothing above. So the force jumps to -c w' as the gap closes, and reaches zero on the way back while w is still
negative: from there on the corner is *released*, and carries nothing. It presses again if p w + c w' falls to zero, at
the rate w' = -p w / c > 0, and is open once its gap is positive.

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
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from fem_reference.events.contacts import NORMAL, OPEN, STICKS, Contact, Part, States, Watch
from fem_reference.events.enclosure import ZERO
from fem_reference.events.series import Start, System, column, diagonal
from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.motion import Motion

CORNERS = ("M", "N")
HYPOTHESES = ("plane stress", "plane strain")
# Length of a step times the greatest rate [rad]: e^12 is how far the terms of its series may cancel, 18 bits.
ANGLE = 12.0
Vector = list[arb]


@dataclass(frozen=True)
class BlockProblem:
    """A block of one strain that is dropped on or pressed against two no-tension corner springs.

    At t = 0 the block is unstrained, its base a gap above the springs, and all loads are switched on. The reference r
    of a corner is the slide at which it closed. C is half of cohesion times width; it is lost while a corner is open,
    and acts again once it has closed.
    """

    width: float  # a [m], unit thickness
    height: float  # b [m]
    density: float  # rho [kg/m3]
    young: float  # E [Pa]; `math.inf`: a rigid block
    stiffness: float  # p of one corner [N/m]; `math.inf`: rigid contact, which needs `restitution`
    pressure: float = 0.0  # q on the top edge [Pa], downwards, from t = 0 on
    shear_stiffness: float = 0.0  # p_s of a closed corner [N/m]; 0: frictionless, else glued in shear
    poisson: float = 0.0  # mu [-]
    hypothesis: str = "plane stress"  # ``"plane stress"`` or ``"plane strain"``
    eccentricity: float = 0.0  # shift e towards +x of the middle of the pressed part of the top, a - 2 |e| long [m]
    traction: float = 0.0  # towards +x on the whole top edge [Pa]
    gravity: float = 0.0  # downwards [m/s2]
    gap: float = 0.0  # g0 under both corners at t = 0 [m]
    velocity: float = 0.0  # at t = 0 [m/s], upwards positive
    slope: float = 0.0  # angle by which gravity is turned towards +x, as on an incline [deg]
    friction: float | None = None  # angle phi [deg]; None: a closed corner never slips
    cohesion: float = 0.0  # shear strength without normal force over the whole base [Pa]
    base: Motion | None = None  # None: at rest
    locked: bool = False  # whether the springs of the corners also pull and nothing opens or slips
    damping: float = 0.0  # dashpot c beside the normal spring of one corner, which never pulls [N s/m]
    restitution: float | None = None  # e of the impact law of rigid contact [-], from 0, plastic, to 1, elastic

    def __post_init__(self) -> None:
        require_numbers(
            self,
            positive=("width", "height", "density", "young", "stiffness"),
            unsigned=("shear_stiffness", "gap", "cohesion", "damping"),
            infinite=("young", "stiffness"),
        )
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
        # Rigid contact is solved for where both its corners do the same, and nothing acts sideways.
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


class BlockModel(System):
    """A block in the unknowns x = (u, v, ux, uy, vx, vy), in the precision of the current context.

    Its rows are the gaps of M and N, their slides, and with rigid contact the force of both corners that keeps them
    closed.
    """

    angle = ANGLE

    def __init__(self, problem: BlockProblem) -> None:
        super().__init__()
        a = arb(problem.width)
        b = arb(problem.height)
        m = arb(problem.density) * a * b
        self.locked = problem.locked  # whether the corners never change their state
        masses = [m, m, *(m * a * a / 12, m * b * b / 12) * 2]  # diagonal of the mass matrix [kg, kg m2]
        self.mass = diagonal(masses)
        self.stiffness = arb_mat(_elastic(problem, a * b))  # of the strained block [N/m, N m]
        self.load = column(_load(problem, a, b, m))  # of pressure, traction and weight [N, N m]
        self.mobility = diagonal([1 / mass for mass in masses])  # [1/kg, 1/(kg m2)]
        if problem.rigid:
            self.mobility = arb_mat(6, 6)
            self.mobility[0, 0] = self.mobility[1, 1] = 1 / m
            # a rotation has uy = -r and vx = r
            turning = 1 / (masses[3] + masses[4])
            self.mobility[3, 3] = self.mobility[4, 4] = turning
            self.mobility[3, 4] = self.mobility[4, 3] = -turning
        zero = ZERO
        ends = -a / 2, a / 2
        gaps = [[zero, arb(1), zero, zero, x, -b / 2] for x in ends]
        slides = [[arb(1), zero, x, -b / 2, zero, zero] for x in ends]
        self.rows = arb_mat([*gaps, *slides])
        self.offsets = arb_mat(4, 1)
        self.contact = None
        if problem.restitution is not None:
            self.contact = RigidContact(
                self, (arb_mat([gaps[0]]) + arb_mat([gaps[1]])) * (arb(1) / 2), arb(problem.restitution)
            )
            # the force of both corners that keeps w'' = 0 against strain and loads, -n W (F - K x) / C [N]
            push = self.contact.mobility.transpose() * (1 / self.contact.compliance)
            self.rows = arb_mat([*self.rows.tolist(), *(push * self.stiffness).tolist()])
            self.offsets = column([zero] * 4 + (push * self.load * -1).entries())
        self.on_base = arb_mat(self.rows.nrows(), 1)
        self.inputs = arb_mat(6, 4)  # nothing: the block is seen from its base
        friction = zero
        cohesion = None
        if problem.friction is not None and not problem.locked:
            # tan(phi) of the doubles that DDA computes with too
            friction = arb(math.tan(math.radians(problem.friction)))
            cohesion = a * arb(problem.cohesion) / 2
        ps = arb(problem.shear_stiffness)
        p = zero if problem.rigid_contact else arb(problem.stiffness)
        force = 4 if problem.rigid_contact else None
        self.contacts = [
            Contact(c, name, c, 2 + c if ps > 0 else None, p, arb(problem.damping), ps, friction, cohesion, force)
            for c, name in enumerate(CORNERS)
        ]

    def watches(self, states: States, references: Sequence[arb]) -> Iterable[Watch]:
        """As of `System`; both corners of a rigid contact have one function."""
        if self.contact is None:
            return () if self.locked else super().watches(states, references)
        row, becomes, order = (0, STICKS, 0) if states[0] == OPEN else (4, OPEN, 2)
        return [Watch(0, NORMAL, (Part(row, arb(1)),), becomes, order=order)]

    def changed(self, states: States, watch: Watch) -> States:
        """As of `System`; both corners of a rigid contact are one."""
        return super().changed(states, watch) if self.contact is None else (watch.becomes,) * 2

    def energy(self, states: States, start: Start) -> arb:
        """Kinetic energy, that of the strain and of the springs, and the loads' as seen from the base [J].

        A released spring has what its stretch says: it gives it to its dashpot, and nothing to the block.
        """
        u = start.u
        twice = (u.transpose() * (self.stiffness * u - self.load * 2))[0, 0]
        twice += (start.v.transpose() * self.mass * start.v)[0, 0]
        rows, forces = self.forces(states, start, ())
        for c, (contact, state) in enumerate(zip(self.contacts, states, strict=True)):
            if state != OPEN:
                twice += contact.stiffness * rows[c] * rows[c]
            if contact.slide is not None:
                T = forces[contact.slide]
                twice += T * T / contact.shear_stiffness
        return twice / 2


class RigidContact:
    """The contact of both corners with a rigid base, and its impact law.

    An impulse J on both corners changes x' by W n' J, W the mobility, and their gap's rate by C J.
    """

    def __init__(self, model: BlockModel, row: arb_mat, restitution: arb) -> None:
        self.restitution = restitution  # e [-]
        self.row = row  # n
        self.mobility = model.mobility * row.transpose()  # W n' [1/kg]
        self.compliance = self.closing(self.mobility)  # C [1/kg]
        # what changes the gap's rate, or the gap, by one [-]
        self.direction = self.mobility * (1 / self.compliance)
        # from rates to those after an impact, and from displacements or rates to those without any of the gap
        unit = diagonal([arb(1)] * 6)
        self.impact = unit - self.direction * row * (1 + restitution)
        self.rest = unit - self.direction * row

    def closing(self, x: arb_mat) -> arb:
        """The gap n x of both corners, or its rate or acceleration."""
        return (self.row * x)[0, 0]

    def impulse(self, approach: arb) -> arb:
        """Impulse on both corners of an impact at which the gap closes at a speed, (1 + e) |w'| / C [N s]."""
        return (1 + self.restitution) * approach / self.compliance


def _elastic(problem: BlockProblem, area: arb) -> list[Vector]:
    """Area times the elastic matrix: ex = ux (2), ey = vy (5), gxy = uy + vx (3, 4); zero if there is no strain."""
    K = [[ZERO] * 6 for _ in range(6)]
    if problem.rigid:
        return K
    E = arb(problem.young)
    mu = arb(problem.poisson)
    shear = area * E / (2 * (1 + mu))
    if problem.hypothesis == "plane strain":
        E /= 1 - mu * mu
        mu /= 1 - mu
    direct = area * E / (1 - mu * mu)
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
    return [t * a + along, -push - down, ZERO, t * a * b / 2, -push * e, -push * b / 2]
