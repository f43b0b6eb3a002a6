"""The landing of a block of one strain on springs without tension: its own, exact in time, and that of a time step.

An unloaded, unstrained rectangle comes down at the speed V. With the height h, the mass m, the strain e and
c = sqrt(E'/rho), in units of h, h/c, m and V, its base is at w = x - e/2 and

    x'' = N,    e''/12 + e = -N/2,    N = max(0, -k w),    k = 2 p h / (E' a),

so that everything depends on k alone. Two limits are those of a rigid mass on the springs 2p:

    k >> 1 (p >> E)    a quarter of the mass, w_c = sqrt(8 p / m): the base lands, the strain rings, it lands again
    k << 1 (p << E)    the whole mass, w_c = sqrt(2 p / m)

Between them there is no rigid mass: at p = E (a square, k = 2) the gap opens at 0.44 of the rate at which it closed
while the centre of mass keeps 0.93 of its speed. Nor is the block's own restitution 1: strain keeps what the centre of
mass loses, up to a fifth of its speed (p = 3.2 E: 0.81), and 0.891 is left on a rigid stop. So a time step is compared
with the block's own landing, and its contact frequency is pi over the duration of the first contact, which has both
limits. All this is for Poisson's ratio 0 and for both corners at once.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from validation.runs.history import Array, ArrayPair
from validation.scenes.scene import Scene
from validation.theory import spectra, statics
from validation.theory.stepping import Stepping

PHASES = np.linspace(0.0, 1.0, 33)
"""Landings within a step: e is continuous in the phase and made of straight lines, so that ends and kinks count."""
SAMPLES = 60
"""Samples of the shorter period, between which the end of a contact or of a flight is looked for."""
PARTS = 100
"""Parts of what brackets such an end, of which one is divided again."""
REFINEMENTS = 9
"""Divisions: 1e-18 of a sample, below the rounding of a time."""
FLIGHT = 8.0
"""Transits h/c after the first contact, beyond which a contact is no part of the same landing."""
SOFTEST = 1e-6
"""k below which the block lands as a rigid mass, to k / 2; its strain would ring 1 / sqrt(k) times in the contact."""
STIFFEST = 1e18
"""k above which the landing is that on a rigid stop, to 0.6 / sqrt(k); from 1e20 on rounding hides the gap."""
FEWEST = 32
"""Steps that are made beyond those: a contact takes two or more however long they are."""
MOST = 20_000
"""Steps beyond which a landing is not stepped: a contact of so many is followed by every scheme."""

GAP = np.array([1.0, -0.5])  # w over (x, e)
MASS = np.array([1.0, 1 / 12])
STRAIN = np.array([0.0, 1.0])  # diagonal of the stiffness without springs


def stiffness_ratio(scene: Scene, stiffness: float | None = None) -> float:
    """Return k = 2 p h / (E' a) [-], or raise FloatingPointError where it is below the range of double precision."""
    modulus, _ = statics.moduli(scene)
    p = scene.contact.stiffness if stiffness is None else stiffness
    ratio = 2 * p * statics.height(scene) / (modulus * scene.block.base_length)
    if ratio == 0:
        raise FloatingPointError("stiffness of the springs over that of the block: 0")
    return ratio


# ---- the block's own landing ----


@dataclass(frozen=True)
class OwnLanding:
    """An unloaded landing of the block of one strain, exact in time, until it flies off for good."""

    restitution: float  # speed of the centre of mass after it over that before it [-]
    first_rate: float  # rate at which the gap opens after the first contact over that at which it closed [-]
    depth: float  # greatest penetration over V sqrt(m / (8 p)), and force over V sqrt(p m / 2), of a quarter of m [-]
    duration: float  # of the first contact, over h / c [-]
    contacts: int


@dataclass(frozen=True)
class _Motion:
    """Free vibration between two switches: a sum of modes, of which one may be a translation."""

    shapes: Array  # columns
    frequencies: Array
    cosines: Array
    sines: Array  # of sin(w t)/w, so that a translation has its speed there

    @classmethod
    def of(cls, stiffness: Array, position: Array, velocity: Array) -> _Motion:
        root = np.sqrt(MASS)
        squares, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
        frequencies = np.sqrt(np.maximum(squares, 0.0))  # rounding may make the square of a translation negative
        shapes = vectors / root[:, None]
        return cls(shapes, frequencies, shapes.T @ (MASS * position), shapes.T @ (MASS * velocity))

    def position(self, time: Array) -> Array:
        """Return x and e at times, shape (n, 2)."""
        phase = np.multiply.outer(time, self.frequencies)
        parts = self.cosines * np.cos(phase) + self.sines * np.multiply.outer(time, np.ones(2)) * np.sinc(phase / np.pi)
        return parts @ self.shapes.T

    def velocity(self, time: float) -> Array:
        """Return their rates at one time, shape (2,)."""
        phase = time * self.frequencies
        return self.shapes @ (self.sines * np.cos(phase) - self.cosines * self.frequencies * np.sin(phase))

    def gap(self, time: Array) -> Array:
        """Return w at times, shape (n,)."""
        return np.asarray(self.position(time) @ GAP)


@functools.lru_cache(maxsize=512)
def own_landing(ratio: float) -> OwnLanding:
    """Return the landing of the block of one strain on springs of the stiffness ratio k.

    Each stretch between two switches is a sum of two modes. A rigid stop is `rigid_stop`.
    """
    if ratio < SOFTEST:
        return OwnLanding(1.0, 1.0, 2 - ratio / 4, math.pi / math.sqrt(ratio) * (1 + ratio / 8), 1)
    if ratio > STIFFEST:
        *speeds, rebound = rigid_stop()
        return OwnLanding(rebound, 1.0, max(speeds), math.pi / (2 * math.sqrt(ratio)), len(speeds))
    closed = np.diag(STRAIN) + ratio * np.outer(GAP, GAP)
    position, velocity = np.zeros(2), np.array([-1.0, 0.0])
    depths = []
    duration, first_rate = 0.0, 0.0
    while True:
        contact = _Motion.of(closed, position, velocity)
        end, deepest = _end(contact, math.inf, opens=True)  # every contact ends
        depths.append(deepest)
        position, velocity = contact.position(np.array([end]))[0], contact.velocity(end)
        if len(depths) == 1:
            duration, first_rate = end, float(GAP @ velocity)
        landed = _after_flight(position, velocity)
        if landed is None:
            break
        position, velocity = landed
    depth = max(depths) * math.sqrt(4 * ratio)
    return OwnLanding(float(velocity[0]), first_rate, depth, duration, len(depths))


def _after_flight(position: Array, velocity: Array) -> ArrayPair | None:
    """Return position and velocity at the end of a flight; None of one that does not end."""
    strain = math.hypot(position[1], velocity[1] / math.sqrt(12))
    distance = strain / 2 - position[0] if velocity[0] > 0 else strain / 2 + position[0]
    # beyond this time the strain can no longer reach the springs, or has done so
    longest = max(distance, 0.0) / abs(velocity[0])
    flight = _Motion.of(np.diag(STRAIN), position, velocity)
    fall, _ = _end(flight, longest, opens=False)
    return None if math.isinf(fall) else (flight.position(np.array([fall]))[0], flight.velocity(fall))


def _end(motion: _Motion, longest: float, opens: bool) -> tuple[float, float]:
    """Return when a stretch ends, infinite where it does not, and its greatest penetration on the way."""
    sample = 2 * math.pi / float(motion.frequencies.max()) / SAMPLES
    depth = 0.0
    start = 0
    while start * sample <= longest:  # in parts: a stiff contact ends in the first of very many
        times = np.asarray(np.arange(start, start + 4 * SAMPLES + 1) * sample, dtype=np.float64)
        gaps = motion.gap(times)
        # The greatest penetration within samples, refined about the lowest of them before the gap opens.
        opened = np.flatnonzero(gaps[1:] > 0)
        within = gaps[: int(opened[0]) + 1] if opened.size else gaps
        i = int(np.argmin(within))
        step = times[1] - times[0]
        fine = np.linspace(max(times[i] - step, times[0]), min(times[i] + step, times[-1]), 401)
        depth = max(depth, float(-motion.gap(fine).min()))
        crossed = 1 + np.flatnonzero(gaps[1:] > 0 if opens else gaps[1:] < 0)
        if crossed.size:
            last = int(crossed[0])
            for _ in range(REFINEMENTS):
                times = np.linspace(times[last - 1], times[last], PARTS + 1)
                beyond = (motion.gap(times) > 0) == opens
                last = int(np.argmax(beyond[1:])) + 1 if beyond[1:].any() else PARTS
            return float(times[last]), max(depth, 0.0) if opens else 0.0
        start += 4 * SAMPLES
    return math.inf, depth


@functools.cache
def rigid_stop() -> tuple[float, ...]:
    """Return the speeds at which the base lands on a rigid stop, over V, and after them the restitution.

    Each impact is elastic for a quarter of the mass: J = m |w'|/2, x' += J/m, e' -= 6 J / (m h).
    """
    position, velocity = np.zeros(2), np.array([-1.0, 0.0])
    speeds = []
    while True:
        speed = float(-(GAP @ velocity))
        speeds.append(speed)
        velocity = velocity + np.array([speed / 2, -3 * speed])
        landed = _after_flight(position, velocity)
        if landed is None:
            return (*speeds, float(velocity[0]))
        position, velocity = landed


def contact_frequency(scene: Scene, stiffness: float | None = None) -> float:
    """Return w_c, pi over the duration of the block's first contact [rad/s]; infinite for a rigid stop."""
    ratio = stiffness_ratio(scene, stiffness)
    if math.isinf(ratio):
        return math.inf
    return math.pi / own_landing(ratio).duration / spectra.transit(scene)


def quarter_mass_force(scene: Scene, speed: float) -> float:
    """Return the force V sqrt(p m / 2) of a quarter of the mass that lands at a speed on the springs [N]."""
    return abs(speed) * math.sqrt(scene.contact.stiffness * scene.block.mass / 2)


def impact_force(scene: Scene, speed: float) -> float:
    """Return the greatest force of an unloaded landing of the block of one strain at a speed, exact in time [N].

    That of a quarter of the mass times 1.47 (p >> E, in the second contact of the landing) to 2 (p << E).
    """
    ratio = stiffness_ratio(scene)
    if math.isinf(ratio):
        return math.inf
    return own_landing(ratio).depth * quarter_mass_force(scene, speed)


def wave_force(scene: Scene, speed: float) -> float:
    """Return the force rho c V a with which a bar lands on a rigid wall [N]."""
    modulus, _ = statics.moduli(scene)
    return abs(speed) * math.sqrt(modulus * scene.block.density) * scene.block.base_length


def cannot_gain(scene: Scene) -> bool:
    """Return whether opening and closing can put no energy into the block.

    With delta >= 1 and 2 alpha >= delta the energy E + (alpha - delta/2) dt^2 A'MA/2 cannot rise, since the springs'
    energy is convex; implicit and conserving contact and the law of impact have no such condition. No other scheme has
    such an energy, however much it damps.
    """
    t = scene.time
    if t.scheme != "newmark":
        return False
    if scene.contact.rule in ("implicit", "energy-conserving", "impact"):
        return True
    return t.delta >= 1 and 2 * t.alpha >= t.delta


def hidden_from(scene: Scene) -> float | None:
    """Return the time step beyond which a block under a pressure that is switched on does not leave its springs [s].

    The free block's base rises in the first step, from A0 = 0, if

        dt^2 < h^2 / (6 alpha c^2) (1 - r/2) / (1 + r),   r = rho g h / q

    whatever p and gg. None where it does not rise at all, where a weight that lifts it makes it rise at every step
    (r <= -1), where it does not start on its springs at rest, and of schemes other than Newmark's.
    """
    t = scene.time
    if t.scheme != "newmark":
        return None
    load = scene.load
    height = statics.height(scene)
    weight = scene.block.density * load.gravity * height / load.pressure if load.pressure > 0 else 2.0
    from_zero = t.alpha > 0 and (t.start == "zero" or t.alpha == 0.5)
    if not (from_zero and scene.contact.gap == 0 == scene.block.velocity and -1 < weight < 2):
        return None
    free = spectra.transit(scene) / math.sqrt(6 * t.alpha)
    return free * math.sqrt((1 - weight / 2) / (1 + weight))


# ---- the landing of a time step ----


@dataclass(frozen=True)
class SteppedLanding:
    """Restitution of the centre of mass over the phase, where in a step the block lands [-]."""

    mean: float
    low: float
    high: float
    own: float  # the block's own restitution

    @property
    def error(self) -> float:
        """Greatest difference from the block's own restitution at any phase."""
        return max(abs(self.low - self.own), abs(self.high - self.own))


def stepped_landing(stepping: Stepping, ratio: float, step: float, transit: float) -> SteppedLanding | None:
    """Return what a time step makes of the block's landing at the stiffness ratio k, infinite for a rigid stop.

    The scheme has alpha > 0 or an implicit contact force; step and transit are dt and h / c [s]. None where the
    landing takes more than `MOST` steps.
    """
    is_rigid = math.isinf(ratio)
    if _steps(0.0 if is_rigid else own_landing(ratio).duration, step / transit) > MOST:
        return None
    values = restitutions(stepping, ratio, step, transit, PHASES)
    own_restitution = rigid_stop()[-1] if is_rigid else own_landing(ratio).restitution
    # any phase is as likely: its ends are half an interval each
    mean = np.trapezoid(values, PHASES)
    return SteppedLanding(float(mean), float(values.min()), float(values.max()), own_restitution)


def restitutions(stepping: Stepping, ratio: float, step: float, transit: float, phases: Array) -> Array:
    """Return the greatest speed of the centre of mass in flight after the landing, over V, for each phase.

    The step in which the springs are first pressed begins above them by (1 - phase) of the distance of that step. A
    step is linear in (D, V, A) while the contact state stays; the free gap, f (D, V, A), decides on its state.
    """
    tau = step / transit
    gg = stepping.at(step).gg
    duration = 0.0 if math.isinf(ratio) else own_landing(ratio).duration
    greatest_speed = np.zeros(len(phases))
    if (1 - gg) * duration / (4 * math.pi * tau) > 1:
        return greatest_speed  # the discount damps the contact at twice the critical rate: it does not rebound
    opened, closed, free_gap = _step_matrices(stepping, gg, tau, ratio)
    state = np.zeros((len(phases), 6))
    state[:, 0] = gg * tau * (1 - phases)
    state[:, 2] = -1.0
    was_pressed = np.zeros(len(phases), dtype=bool)
    for _ in range(_steps(duration, tau)):
        is_pressed = state @ free_gap < 0
        state = np.where(is_pressed[:, None], state @ closed.T, state @ opened.T)
        lifted = was_pressed & ~is_pressed  # the first step of a flight has the contact force of its start behind it
        greatest_speed[lifted] = np.maximum(greatest_speed[lifted], state[lifted, 2])
        was_pressed = is_pressed
    return greatest_speed


def _steps(duration: float, tau: float) -> int:
    """Return the steps after which a block has landed for the last time."""
    return FEWEST + math.ceil((2 * duration + FLIGHT) / tau)


def _step_matrices(stepping: Stepping, gg: float, tau: float, ratio: float) -> tuple[Array, Array, Array]:
    """Return the maps (D, V, A) -> (D1, V1, A1) of an open and of a closed step, and the row of the free gap.

    S A1 = B' N - K0 D*,  D1 = D* + alpha tau^2 A1,  V1 = gg V + tau ((1 - delta) A + delta A1),  N = -gap / (1/k + C).
    """
    alpha, delta = (0.25, 0.5) if stepping.implicit else (stepping.alpha, stepping.delta)
    identity, zero = np.eye(2), np.zeros((2, 2))
    predictor = np.hstack([identity, gg * tau * identity, (0.5 - alpha) * tau**2 * identity])
    S = MASS + alpha * tau**2 * STRAIN
    A1 = -(STRAIN / S)[:, None] * predictor
    D1 = predictor + alpha * tau**2 * A1
    V1 = np.hstack([zero, gg * identity, (1 - delta) * tau * identity]) + delta * tau * A1
    opened = np.vstack([D1, V1, A1])
    free_gap = GAP @ D1
    if stepping.implicit:  # one force of the step: 1/2 of it in the displacement, all of it in the momentum
        by_displacement = tau**2 / 2 * GAP / S
        # A stays the block's own acceleration, -K0 D1 / M
        by_acceleration = -STRAIN / MASS * by_displacement
        by_velocity = tau * GAP / MASS + delta * tau * by_acceleration
    else:
        by_acceleration = GAP / S
        by_displacement = alpha * tau**2 * by_acceleration
        by_velocity = delta * tau * by_acceleration
    force = -free_gap / (1 / ratio + GAP @ by_displacement)
    closed = opened + np.outer(np.concatenate([by_displacement, by_velocity, by_acceleration]), force)
    return opened, closed, free_gap


def springs_for(scene: Scene, speed: float, penetration: float) -> float:
    """Return the p at which an unloaded landing at a speed goes as deep as a penetration [N/m].

    x = D V sqrt(m / (8 p)), with the D of `OwnLanding.depth`, from 2 (p << E) to 1.47 (p >> E).
    """
    quarter = speed**2 * scene.block.mass / (8 * penetration**2)
    p = 4 * quarter  # the whole mass
    for _ in range(60):
        before = p
        p = own_landing(stiffness_ratio(scene, p)).depth ** 2 * quarter
        if abs(p - before) <= 1e-9 * p:
            break
    return p
