r"""Soft constraints of physics engines as what they are: a spring and a dashpot on the contact's effective mass.

An engine states a contact by numbers of its own; with the effective mass m of the contact, w = sqrt(k/m) and
zeta = c / (2 sqrt(k m)) all of them are the law N = max(0, -(k x + c x')) at a penetration -x:

    Box2D    (hertz, damping ratio)            w = 2 pi hertz, zeta = damping ratio (``b2MakeSoft``)
    Bullet   (erp, cfm) at a step h            erp = h k / (h k + c), cfm = 1 / (h k + c)
    MuJoCo   (timeconst, dampratio), impedance d   a1 + d (b v + r x) = (1 - d) a0 with
             b = 2 / (dmax timeconst), r = d / (dmax^2 timeconst^2 dampratio^2);
             at d = dmax: w = 1 / (timeconst dampratio), zeta = dampratio, under the share 1 - d of the load

The first two step implicitly (x1 = x + h v1, force at the end of the step), the third with the force of the step's
start. So the stiffness follows the mass: an engine's block of twice the mass stands on springs twice as stiff.

Several points share a flat body. Where k and c are those of a point (Bullet) they add up. n points of MuJoCo are one
of the impedance n d / (1 + (n - 1) d). Box2D's k follows the mass that a point feels, m / (1 + r^2 m / I).

Yade has no dashpot but damps the sum f of all forces on a body by its share alpha, f (1 - alpha sign(f v)): an
unloaded landing returns e = sqrt((1 - alpha) / (1 + alpha)) and a free vibration decays by (1 - alpha) / (1 + alpha)
a cycle, both at any stiffness, mass and speed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.runs.history import Array

Mask = NDArray[np.bool_]
PYBULLET_SLOP = 1e-5
"""Overlap [m] that PyBullet lets bodies have before a contact pushes."""
PHASES = 200
"""Landings within a step that a rebound is taken over, any as likely as another."""
LONGEST = 100_000
"""Steps after which a landing counts as stuck."""
REST = 1e-9
"""Speed below which a landing leaves nothing, over that of the impact."""
QUARTER = 0.25
"""Effective over whole mass at the base of a block of one strain whose springs are much stiffer than itself."""


def effective_mass(*inverse_masses: float) -> float:
    """Return the mass that a contact feels, m with 1/m the sum of what resists it [kg].

    Parameters
    ----------
    inverse_masses
        1/m_i of each body and r_i^2/I_i of its rotation, r_i the arm of the contact's normal about the centre of mass;
        a strain counts as a rotation does, with inertia m h^2/12 and arm h/2 for the height h.

    Examples
    --------
    >>> m, h = 10800.0, 2.0
    >>> effective_mass(1 / m, (h / 2) ** 2 / (m * h**2 / 12)) / m
    0.25
    """
    return 1 / math.fsum(inverse_masses)


def shared_impedance(impedance: float, points: int) -> float:
    """Return the impedance that n contact points of MuJoCo have together."""
    return points * impedance / (1 + (points - 1) * impedance)


def local_damping_restitution(alpha: float) -> float:
    """Return what Yade's damping leaves of the speed of an unloaded landing, e = sqrt((1 - alpha) / (1 + alpha))."""
    return math.sqrt((1 - alpha) / (1 + alpha))


def local_damping_ratio(alpha: float) -> float:
    """Return the damping ratio with which a free vibration decays as under Yade's damping, artanh(alpha) / pi."""
    return math.atanh(alpha) / math.pi


def implicit_ratio(W: float) -> float:
    """Return the damping ratio of implicit Euler on an undamped spring: z = 1 / (1 +- i W)."""
    decay = math.log1p(W * W) / 2
    return decay / math.hypot(decay, math.atan(W))


def implicit_step(ratio: float) -> float:
    """Return the W at which implicit Euler has a damping ratio, the way back from `implicit_ratio`."""
    from scipy.optimize import brentq

    return float(brentq(lambda W: implicit_ratio(W) - ratio, 1e-12, 1e9, xtol=1e-15))


@dataclass(frozen=True)
class Impedance:
    """MuJoCo's ``solimp``: the impedance d over the penetration, from dmin on the surface to dmax at the width."""

    least: float = 0.9  # dmin [-]
    greatest: float = 0.95  # dmax [-]
    width: float = 0.001  # [m]
    midpoint: float = 0.5  # of the width, where the curve turns [-]
    power: float = 2.0  # [-]

    def __call__(self, penetration: float) -> float:
        """Return d at a penetration [m]."""
        x = min(abs(penetration) / self.width, 1.0)
        if x <= self.midpoint:
            y = x**self.power / self.midpoint ** (self.power - 1)
        else:
            y = 1 - (1 - x) ** self.power / (1 - self.midpoint) ** (self.power - 1)
        return float(self.least + y * (self.greatest - self.least))

    def at_rest(self, frequency: float, acceleration: float) -> float:
        """Return d where a mass stands: (d/dmax)^2 w^2 r = (1 - d) g.

        Parameters
        ----------
        frequency
            w = 1 / (timeconst dampratio) [rad/s].
        acceleration
            Weight over effective mass, g of a single body [m/s^2].
        """
        from scipy.optimize import brentq

        def excess(penetration: float) -> float:
            d = self(penetration)
            return (d / self.greatest * frequency) ** 2 * penetration - (1 - d) * acceleration

        deepest = (1 - self.least) * acceleration / (self.least / self.greatest * frequency) ** 2
        return self(brentq(excess, 0.0, 1.01 * deepest, xtol=1e-15))


@dataclass(frozen=True)
class SoftContact:
    """A spring and a dashpot that push only, on the effective mass of a contact, and how they are stepped."""

    mass: float  # effective, m [kg]
    stiffness: float  # k [N/m]
    damping: float  # c [N s/m]
    load_share: float = 1.0  # of a load that the spring carries at rest, 1 - d of MuJoCo [-]
    implicit: bool = True  # force at the end of the step; else at its start (MuJoCo, Yade)
    stops_ahead: bool = False  # a body that would pass the surface in the step is braked as if it were there (Bullet)
    starts_inside: bool = False  # the first force is that of a step which begins in the contact (Bullet's boxes)
    local_damping: float = 0.0  # Yade's alpha [-]
    slop: float = 0.0  # overlap below which nothing pushes (PyBullet) [m]

    @classmethod
    def of_ratio(cls, mass: float, frequency: float, ratio: float) -> SoftContact:
        """Return the contact of a frequency w [rad/s] and a damping ratio zeta."""
        return cls(mass, mass * frequency**2, 2 * ratio * mass * frequency)

    @classmethod
    def of_box2d(
        cls, mass: float, hertz: float, damping_ratio: float, points: int = 1, lever: float = 0.0
    ) -> SoftContact:
        """Return the contact of ``b2MakeSoft(hertz, damping_ratio, h)``, which is the same at each h.

        A point at the arm r of a mass m feels m / (1 + lever), lever = r^2 m / I.
        """
        share = points / (1 + lever)
        w = 2 * math.pi * hertz
        return cls(mass, share * mass * w**2, 2 * damping_ratio * share * mass * w)

    @classmethod
    def of_bullet(cls, mass: float, erp: float, cfm: float, step: float) -> SoftContact:
        """Return the contact of an error reduction and a constraint force mixing [m/(N s)] at a step h [s]."""
        return cls(mass, erp / (step * cfm), (1 - erp) / cfm, stops_ahead=True)

    @classmethod
    def of_pybullet(cls, mass: float, stiffness: float, damping: float, is_box: bool) -> SoftContact:
        """Return the contact of contactStiffness and contactDamping; a ball is braked ahead, a box once it overlaps."""
        return cls(mass, stiffness, damping, stops_ahead=not is_box, starts_inside=is_box, slop=PYBULLET_SLOP)

    @classmethod
    def of_yade(cls, mass: float, stiffness: float, local_damping: float) -> SoftContact:
        """Return the contact of a normal stiffness, and the damping of all forces."""
        return cls(mass, stiffness, 0.0, implicit=False, local_damping=local_damping)

    @classmethod
    def of_mujoco(
        cls, mass: float, timeconst: float, dampratio: float, impedance: float, share: float, points: int = 1
    ) -> SoftContact:
        """Return the contact of ``solref = (timeconst [s], dampratio)`` at an impedance d, which is `share` of dmax.

        Where both are not above 0 they are MuJoCo's direct format, (-k/m [1/s2], -c/m [1/s]).
        """
        together = shared_impedance(impedance, points)
        gain = together / impedance
        if timeconst <= 0:
            stiffness = -timeconst * mass * gain * share**2
            damping = -dampratio * mass * gain * share
        else:
            stiffness = mass * gain * (share / (timeconst * dampratio)) ** 2
            damping = 2 * mass * gain * share / timeconst
        return cls(mass, stiffness, damping, load_share=1 - together, implicit=False)

    @property
    def frequency(self) -> float:
        """Undamped frequency w [rad/s]."""
        return math.sqrt(self.stiffness / self.mass)

    @property
    def ratio(self) -> float:
        """Damping ratio zeta [-]."""
        return self.damping / (2 * math.sqrt(self.stiffness * self.mass))

    def numerical_ratio(self, step: float) -> float:
        """Return the damping ratio that the steps add to a free vibration of the spring: about W/2 where implicit."""
        if self.local_damping:
            return local_damping_ratio(self.local_damping)
        return implicit_ratio(self.frequency * step) if self.implicit else 0.0

    def rest_penetration(self, weight: float) -> float:
        """Return how deep a weight [N] stands in the contact [m]."""
        return self.slop + self.load_share * weight / self.stiffness

    def step_matrix(self, step: float) -> Array:
        """Return the map (x, h v) -> (x1, h v1) of a closed step, shape (2, 2).

        Implicit: (1 + 2 zeta W + W^2) h v1 = h v - W^2 x. Explicit: h v1 = h v - W^2 x - 2 zeta W h v. x1 = x + h v1.
        """
        W = self.frequency * step
        loss = 2 * self.ratio * W
        explicit = np.array([-(W**2), 1.0 - loss])
        velocity = np.array([-(W**2), 1.0]) / (1 + loss + W**2) if self.implicit else explicit
        return np.array([np.array([1.0, 0.0]) + velocity, velocity])

    def determinant(self, step: float) -> float:
        """Return det of a closed step: 1 / (1 + 2 zeta W + W^2), or 1 - 2 zeta W where it is explicit."""
        return float(np.linalg.det(self.step_matrix(step)))

    def spectral_radius(self, step: float) -> float:
        """Return max |lambda| of a closed step."""
        return float(np.abs(np.linalg.eigvals(self.step_matrix(step))).max())

    def rebounds(self, step: float, load: float = 0.0) -> Array:
        """Return the restitution of a landing by steps, one for each phase, shape (PHASES,); 0 where it does not leave.

        The force is clipped, N >= 0, and acts where the free step ends in the contact (implicit) or where the step
        begins in it (explicit).

        Parameters
        ----------
        step
            h [s].
        load
            g h / V, by what share of its landing speed a free step of fall changes the speed; 0 without weight.
        """
        W2 = (self.frequency * step) ** 2
        loss = 2 * self.ratio * self.frequency * step

        def implicit(x: Array, v: Array) -> tuple[Array, Mask]:
            free = v - load
            end = x + free
            resisted = W2 * end + loss * free
            if self.stops_ahead:
                resisted = np.where(x > 0, (W2 + loss) * end, resisted)
            force = np.maximum(-resisted / (1 + loss + W2), 0.0)
            return force, x < 0 if self.starts_inside else end < 0

        def explicit(x: Array, v: Array) -> tuple[Array, Mask]:
            return np.maximum((1 - self.load_share) * load - W2 * x - loss * v, 0.0), x < 0

        return _landings(implicit if self.implicit else explicit, load, self.local_damping)


def curve_rebounds(
    curve: Impedance, timeconst: float, dampratio: float, points: int, step: float, speed: float, gravity: float
) -> Array:
    """Return the rebounds of MuJoCo's steps where the impedance follows the penetration, shape (PHASES,).

    Parameters
    ----------
    curve
        ``solimp``.
    timeconst, dampratio
        ``solref`` [s], [-].
    points
        Contact points that share the body.
    step
        h [s].
    speed
        At which it lands, V [m/s].
    gravity
        g [m/s2].
    """
    distance = speed * step  # the unit of x
    k = (step / (curve.greatest * timeconst * dampratio)) ** 2
    b = 2 * step / (curve.greatest * timeconst)
    load = gravity * step / speed

    def forces(x: Array, v: Array) -> tuple[Array, Mask]:
        d = np.array([curve(float(depth)) for depth in x * distance])
        together = points * d / (1 + (points - 1) * d)
        return np.maximum(together * (load - b * v - k * d * x), 0.0), x < 0

    return _landings(forces, load)


def _landings(forces: Callable[[Array, Array], tuple[Array, Mask]], load: float, local_damping: float = 0.0) -> Array:
    """Return the rebounds of all phases; `forces` are those of the contact, and whether it acts, before a step."""
    x = (np.arange(PHASES) + 0.5) / PHASES  # in V h, before the first step that ends at or below the contact
    v = np.full(PHASES, -1.0)
    e = np.zeros(PHASES)
    has_touched = np.zeros(PHASES, dtype=bool)
    has_turned = np.zeros(PHASES, dtype=bool)
    is_over = np.zeros(PHASES, dtype=bool)
    for _ in range(LONGEST):
        force, is_closed = forces(x, v)
        sum_of_forces = np.where(is_closed, force, 0.0) - load
        if local_damping:
            sum_of_forces *= 1 - local_damping * np.sign(sum_of_forces * (v + sum_of_forces / 2))
        has_touched |= is_closed
        v = v + sum_of_forces
        x = x + v
        has_turned |= has_touched & (v > REST)
        has_left = has_touched & (x >= 0) & (v >= 0)
        has_sunk_back = has_turned & (v <= 0)  # the weight holds it
        is_stuck = has_touched & (np.abs(v) < REST)
        e = np.where(has_left & ~is_over, v, e)
        is_over |= has_left | has_sunk_back | is_stuck
        if np.all(is_over):
            break
    return np.where(e < REST, 0.0, e)
