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
from numpy.typing import NDArray

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory import spectra, statics
from validation.theory.stepping import Stepping

PHASES = np.linspace(0.0, 1.0, 33)
"""Landings within a step: e is continuous in the phase and made of straight lines, so that ends and kinks count."""
SAMPLES = 60
"""Samples of the shorter period, between which the end of a contact or of a flight is looked for."""
WINDOW = 128
"""Steps, or strides, that are looked at together for the first that changes the contact state; a power of two."""
REST = 1e-6
"""Speed in flight, over V, below which nothing of the landing is left."""
FLIGHT = 8.0
"""Transits h/c after the first contact, beyond which a contact is no part of the same landing."""
SOFTEST = 1e-6
"""k below which the block lands as a rigid mass, to k / 2; its strain would ring 1 / sqrt(k) times in the contact."""
FEWEST = 32
"""Steps that are made beyond those: a contact takes two or more however long they are."""

GAP = np.array([1.0, -0.5])  # w over (x, e)
MASS = np.array([1.0, 1 / 12])
STRAIN = np.array([0.0, 1.0])  # diagonal of the stiffness without springs


def stiffness_ratio(scene: Scene, stiffness: float | None = None) -> float:
    """Return k = 2 p h / (E' a), the stiffness of the springs over that of the block [-]."""
    modulus, _ = statics.moduli(scene)
    p = scene.contact.stiffness if stiffness is None else stiffness
    return 2 * p * statics.height(scene) / (modulus * scene.block.base_length)


# ---- the block's own landing --------------------------------------------------------------------------------------


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
        return np.asarray(parts @ self.shapes.T)

    def velocity(self, time: float) -> Array:
        """Return their rates at one time, shape (2,)."""
        phase = time * self.frequencies
        return np.asarray(self.shapes @ (self.sines * np.cos(phase) - self.cosines * self.frequencies * np.sin(phase)))

    def gap(self, time: Array) -> Array:
        """Return w at times, shape (n,)."""
        return np.asarray(self.position(time) @ GAP)


@functools.lru_cache(maxsize=512)
def own_landing(ratio: float) -> OwnLanding:
    """Return the landing of the block of one strain on springs of the stiffness ratio k = 2 p h / (E' a).

    Each stretch between two switches is a sum of two modes; its end is bracketed on a grid of sixtieths of the
    shorter period and found by bisection.

    Raises
    ------
    ValueError
        k is not positive or not finite; a rigid stop is `rigid_stop`.
    """
    if not (math.isfinite(ratio) and ratio > 0):
        raise ValueError(f"ratio: must be positive and finite, got {ratio!r}")
    if ratio < SOFTEST:
        return OwnLanding(1.0, 1.0, 2 - ratio / 4, math.pi / math.sqrt(ratio) * (1 + ratio / 8), 1)
    closed = np.diag(STRAIN) + ratio * np.outer(GAP, GAP)
    position, velocity = np.zeros(2), np.array([-1.0, 0.0])
    depths: list[float] = []
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


def _after_flight(position: Array, velocity: Array) -> tuple[Array, Array] | None:
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
        depth = max(depth, _deepest(motion, times, gaps))
        crossed = 1 + np.flatnonzero(gaps[1:] > 0 if opens else gaps[1:] < 0)
        if crossed.size:
            last = int(crossed[0])
            low, high = times[last - 1], times[last]
            for _ in range(60):
                middle = (low + high) / 2
                if (motion.gap(np.array([middle]))[0] > 0) == opens:
                    high = middle
                else:
                    low = middle
            return float(high), max(depth, 0.0) if opens else 0.0
        start += 4 * SAMPLES
    return math.inf, depth


def _deepest(motion: _Motion, times: Array, gaps: Array) -> float:
    """Return the greatest penetration within samples, refined about the lowest of them before the gap opens."""
    opened = np.flatnonzero(gaps[1:] > 0)
    within = gaps[: int(opened[0]) + 1] if opened.size else gaps
    i = int(np.argmin(within))
    step = times[1] - times[0]
    fine = np.linspace(max(times[i] - step, times[0]), min(times[i] + step, times[-1]), 401)
    return float(-motion.gap(fine).min())


@functools.cache
def rigid_stop() -> tuple[float, ...]:
    """Return the speeds at which the base lands on a rigid stop, over V, and after them the restitution.

    Each impact is elastic for a quarter of the mass: J = m |w'|/2, x' += J/m, e' -= 6 J / (m h).
    """
    position, velocity = np.zeros(2), np.array([-1.0, 0.0])
    speeds: list[float] = []
    while True:
        speed = float(-(GAP @ velocity))
        speeds.append(speed)
        velocity = velocity + np.array([speed / 2, -3 * speed])
        landed = _after_flight(position, velocity)
        if landed is None:
            return (*speeds, float(velocity[0]))
        position, velocity = landed


def contact_frequency(scene: Scene, stiffness: float | None = None) -> float:
    """Return w_c, pi over the duration of the block's first contact [rad/s]; infinite for a rigid stop.

    It tends to sqrt(8 p / m) for p >> E and to sqrt(2 p / m) for p << E.
    """
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

    whatever p and gg. None where it does not rise at all, or does not start on its springs at rest, and of schemes
    other than Newmark's.
    """
    t = scene.time
    if t.scheme != "newmark":
        return None
    load = scene.load
    height = statics.height(scene)
    weight = scene.block.density * load.gravity * height / load.pressure if load.pressure > 0 else 2.0
    from_zero = t.alpha > 0 and (t.start == "zero" or t.alpha == 0.5)
    if not (from_zero and scene.contact.gap == 0 == scene.block.velocity and weight < 2):
        return None
    free = spectra.transit(scene) / math.sqrt(6 * t.alpha)
    return free * math.sqrt((1 - weight / 2) / (1 + weight))


# ---- the landing of a time step ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SteppedLanding:
    """Restitution of the centre of mass over the phase, where in a step the block lands [-]."""

    mean: float
    low: float
    high: float
    energy: float  # mean of e^2, the share of the kinetic energy that is left to the centre of mass
    own: float  # the block's own restitution

    @property
    def error(self) -> float:
        """Greatest difference from the block's own restitution at any phase."""
        return max(abs(self.low - self.own), abs(self.high - self.own))


def stepped_landing(stepping: Stepping, ratio: float, step: float, transit: float) -> SteppedLanding:
    """Return what a time step makes of the block's landing on springs of the stiffness ratio k.

    Parameters
    ----------
    stepping
        The scheme, with alpha > 0 or an implicit contact force.
    ratio
        k = 2 p h / (E' a), infinite for a rigid stop.
    step, transit
        dt and h / c [s].
    """
    values = restitutions(stepping, ratio, step, transit, PHASES)
    own_restitution = rigid_stop()[-1] if math.isinf(ratio) else own_landing(ratio).restitution
    # any phase is as likely: its ends are half an interval each
    mean = np.trapezoid(values, PHASES)
    energy = np.trapezoid(values**2, PHASES)
    return SteppedLanding(float(mean), float(values.min()), float(values.max()), float(energy), own_restitution)


def restitutions(stepping: Stepping, ratio: float, step: float, transit: float, phases: Array) -> Array:
    """Return the greatest speed of the centre of mass in flight after the landing, over V, for each phase.

    The step in which the springs are first pressed begins above them by (1 - phase) of the distance of that step. A
    step is linear in (D, V, A) while the contact state stays; the free gap of the next step, f (D, V, A), decides on
    its state. So the rows f T^n of many steps are applied at once, and the first that changes its sign ends a stretch.
    """
    tau = step / transit
    gg = stepping.at(step).gg
    if not math.isinf(ratio) and (1 - gg) * own_landing(ratio).duration / (4 * math.pi * tau) > 1:
        return np.zeros(len(phases))  # the discount damps the contact at twice the critical rate: it does not rebound
    opened, closed, free_gap = _step_matrices(stepping, gg, tau, ratio)
    state = np.zeros((len(phases), 6))
    state[:, 0] = gg * tau * (1 - phases)
    state[:, 2] = -1.0
    duration = 0.0 if math.isinf(ratio) else own_landing(ratio).duration
    limit = FEWEST + math.ceil((2 * duration + FLIGHT) / tau)
    # the highest frequencies of the two states, over c/h: that of the closed block is below the sum of its parts
    flight = _Stretch.of(opened, free_gap, math.sqrt(12) * tau, contact=False)
    contact = _Stretch.of(closed, free_gap, math.sqrt(12 + 4 * ratio) * tau, contact=True)

    passed = np.zeros(len(phases))
    greatest_speed = np.zeros(len(phases))
    active = np.arange(len(phases), dtype=np.intp)
    while active.size:
        contact.advance(state, passed, active, limit)
        active = active[passed[active] < limit]
        # the first step of a flight has the contact force of its start behind it
        greatest_speed[active] = np.maximum(greatest_speed[active], state[active] @ opened[2])
        flight.advance(state, passed, active, limit)
        active = active[passed[active] < limit]
    return greatest_speed


def _is_over(state: Array) -> Array:
    """Return which flights are the last: clear of the springs by more than their strain, or at rest by a discount."""
    strain = 1.05 * np.hypot(state[:, 1], state[:, 3] / math.sqrt(12))
    clear = (state[:, 2] > 0) & (state[:, 0] > strain / 2)
    return np.asarray(clear | (np.abs(state[:, 2]) < REST))


@dataclass(frozen=True)
class _Stretch:
    """Steps of one contact state, and how to find the first that no longer has it.

    Steps are looked at in strides, from about a sixtieth of the shortest period down to one step, so that the work of
    a stretch does not depend on the number of its steps.
    """

    contact: bool
    levels: tuple[tuple[int, Array, Array], ...]  # stride [steps]; f T^(stride n); T^(stride n), n = 0 to WINDOW
    settling: _Settling | None  # of a contact

    @classmethod
    def of(cls, matrix: Array, free_gap: Array, phase: float, contact: bool) -> _Stretch:
        """Return the tables; `phase` is the highest frequency times the step."""
        levels = []
        stride = 1
        first = matrix
        while True:
            powers = _powers(matrix, WINDOW)
            levels.append((stride, np.einsum("i,nij->nj", free_gap, powers), powers))
            if not stride * WINDOW * phase * SAMPLES < 2 * math.pi:
                break
            stride *= WINDOW
            matrix = powers[WINDOW]
        return cls(contact, tuple(reversed(levels)), _Settling.of(first, free_gap) if contact else None)

    def advance(self, state: Array, passed: Array, chosen: NDArray[np.intp], limit: float) -> None:
        """Advance the chosen rows of states to the last step of the stretch; `passed` is infinite where there is none.

        A flight has none where it is the last, a contact where it settles; one of more steps than the limit is none.
        """
        for stride, rows, powers in self.levels:
            pending = chosen[passed[chosen] < limit]
            while pending.size:
                stays = (rows @ state[pending].T < 0) == self.contact
                ends = ~stays.all(axis=0)
                count = np.where(ends, np.argmin(stays, axis=0), WINDOW)
                if stride > 1:  # the change lies before the first sample that shows it
                    count = np.where(ends, np.maximum(count - 1, 0), count)
                state[pending] = np.einsum("nij,nj->ni", powers[count], state[pending])
                passed[pending] += stride * count
                pending = pending[~ends]
                if not self.contact:
                    passed[pending[_is_over(state[pending])]] = math.inf
                elif self.settling is not None:
                    passed[pending[self.settling.stays(state[pending])]] = math.inf
                pending = pending[passed[pending] < limit]


@dataclass(frozen=True)
class _Settling:
    """Contacts that end no more: a discount takes the speed, and the block creeps back to the springs' ends.

    The free gap after n steps is a sum of terms c_j z_j^n. Where the z of greatest modulus is real and positive, and
    its c is negative and outweighs all others together, the gap keeps its sign for ever.
    """

    slowest: Array  # c of that z, over the state
    others: NDArray[np.complex128]  # c of the others, one a row

    @classmethod
    def of(cls, matrix: Array, free_gap: Array) -> _Settling | None:
        """Return the terms of a map; None where the greatest z is not real and positive, or there is no basis."""
        z, vectors = np.linalg.eig(matrix)
        top = int(np.argmax(np.abs(z)))
        if z[top].imag != 0 or z[top].real <= 0:
            return None
        try:
            terms = (free_gap @ vectors)[:, None] * np.linalg.inv(vectors)
        except np.linalg.LinAlgError:
            return None
        return cls(np.asarray(terms[top].real), np.asarray(np.delete(terms, top, axis=0)))

    def stays(self, state: Array) -> NDArray[np.bool_]:
        """Return which rows of states stay in contact for ever."""
        others = np.abs(state @ self.others.T).sum(axis=1)
        return np.asarray(state @ self.slowest < -1.01 * others)  # a little more than all others, for rounding


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


def _powers(matrix: Array, count: int) -> Array:
    """Return matrix^0 to matrix^count, a power of two, shape (count + 1, 6, 6)."""
    powers = np.eye(6)[None]
    top = matrix
    while len(powers) < count:
        powers = np.concatenate([powers, powers @ top])
        top = top @ top
    return np.concatenate([powers, top[None]])


def springs_for(scene: Scene, speed: float, penetration: float) -> float:
    """Return the p at which an unloaded landing at a speed goes as deep as a penetration [N/m].

    x = D V sqrt(m / (8 p)), with D from 2 (p << E) to 1.47 (p >> E, where the second contact in a row is the deepest).
    """
    quarter = speed**2 * scene.block.mass / (8 * penetration**2)
    p = 4 * quarter  # the whole mass
    for _ in range(60):
        before = p
        p = own_landing(stiffness_ratio(scene, p)).depth ** 2 * quarter
        if abs(p - before) <= 1e-9 * p:
            break
    return p
