"""What claims of the literature are tested on beside runs: recursions and closed forms, written apart from the solvers.

Everything is in SI units; a spring of a rigid mass has w = sqrt(k/m), W = w dt.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory import friction, statics
from validation.theory.stepping import Complex, Stepping

GRAVITY = 9.81
TOLERANCE = 1e-12  # of times, which are multiples of a step, and of roots that are zero
FINE = 1e-5  # s: a step at which a sliding block is exact to four digits


# ---- one mode -------------------------------------------------------------------------------------------------------


def newmark_step(stepping: Stepping, omega: float) -> Array:
    """Return the map (x, dt v, dt^2 a) of a step of Newmark's scheme on one mode without load, shape (3, 3)."""
    alpha = stepping.alpha
    delta = stepping.delta
    predictor = np.array([1.0, stepping.gg, 0.5 - alpha])
    acceleration = -(omega**2) / (1 + alpha * omega**2) * predictor
    velocity = np.array([0.0, stepping.gg, 1 - delta]) + delta * acceleration
    return np.array([predictor + alpha * acceleration, velocity, acceleration])


def damped_roots(stepping: Stepping, mass: Array, damping: Array, stiffness: Array) -> Array:
    """Return the damping ratios of the oscillating modes of a damped system under Newmark's scheme, by frequency.

    M a1 + C v1 + K x1 = 0 on the state (x, dt v, dt^2 a), gg in front of v as everywhere.
    """
    size = len(mass)
    dt = stepping.step
    unit = np.eye(size)
    none = np.zeros((size, size))
    alpha = stepping.alpha
    delta = stepping.delta
    position = np.hstack([unit, stepping.gg * unit, (0.5 - alpha) * unit])
    velocity = np.hstack([none, stepping.gg * unit, (1 - delta) * unit])
    S = mass / dt**2 + delta * damping / dt + alpha * stiffness
    acceleration = -np.linalg.solve(S, stiffness @ position + damping @ velocity / dt)
    step = np.vstack([position + alpha * acceleration, velocity + delta * acceleration, acceleration])
    roots = np.linalg.eigvals(step).astype(complex)
    return _ratios(np.log(roots[np.abs(roots) > TOLERANCE]))


def exact_damped_roots(mass: Array, damping: Array, stiffness: Array) -> Array:
    """Return the damping ratios of the oscillating modes of a damped system, exact in time, by frequency."""
    size = len(mass)
    rates = np.block(
        [[np.zeros((size, size)), np.eye(size)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]]
    )
    return _ratios(np.linalg.eigvals(rates).astype(complex))


def _ratios(logarithms: Array) -> Array:
    """Return -Re/|.| of the logarithms above the real axis, by size."""
    above = logarithms[logarithms.imag > 1e-9]
    ordered = above[np.argsort(np.abs(above))]
    return np.asarray(-ordered.real / np.abs(ordered), dtype=np.float64)


def two_unknowns(scene: Scene) -> tuple[Array, Array, Array]:
    """Return M and K of the block of one strain in (v, ey), and the row b of the gap at its base, for mu = 0."""
    width, height = statics.size(scene)
    modulus, _ = statics.moduli(scene)
    p = scene.contact.stiffness
    m = scene.block.mass
    gap = np.array([1.0, -height / 2])
    mass = np.diag([m, m * height**2 / 12])
    stiffness = np.diag([0.0, modulus * width * height]) + 2 * p * np.outer(gap, gap)
    return mass, stiffness, gap


def exact_locked(scene: Scene, time: Array) -> Array:
    """Return the displacement of the centroid of the locked block under a suddenly applied pressure, from rest [m]."""
    mass, stiffness, _ = two_unknowns(scene)
    width, height = statics.size(scene)
    load = scene.load.pressure * width * np.array([-1.0, -height / 2])
    root = np.sqrt(np.diag(mass))
    squares, vectors = np.linalg.eigh(stiffness / np.outer(root, root))
    shapes = vectors / root[:, None]
    static = (shapes.T @ load) / squares
    swings = static * (1 - np.cos(np.multiply.outer(time, np.sqrt(squares))))
    return np.asarray(swings @ shapes.T[:, 0], dtype=np.float64)


# ---- a free mass under a sine ---------------------------------------------------------------------------------------


def forced_mass_error(step: Callable[[Array, float, float], Array], dt: float, frequency: float = 1.0) -> float:
    """Return the largest error of x'' = sin(2 pi f t) over one period from rest, over the largest displacement.

    Parameters
    ----------
    step
        Function of the state (x, v, a), of t and of dt that returns the state at t + dt.
    dt
        Step [s].
    frequency
        f [Hz].
    """
    w = 2 * math.pi * frequency
    count = round(1 / frequency / dt)
    state = np.zeros(3)
    error = 0.0
    largest = 0.0
    for n in range(count):
        state = step(state, n * dt, dt)
        t = (n + 1) * dt
        exact = t / w - math.sin(w * t) / w**2
        error = max(error, abs(float(state[0]) - exact))
        largest = max(largest, abs(exact))
    return error / largest


def newmark_on_sine(alpha: float, delta: float, frequency: float = 1.0) -> Callable[[Array, float, float], Array]:
    """Return the step of Newmark's scheme on a free mass under a sine."""

    def step(state: Array, t: float, dt: float) -> Array:
        x, v, a = state
        new = math.sin(2 * math.pi * frequency * (t + dt))
        x1 = x + dt * v + dt**2 * ((0.5 - alpha) * a + alpha * new)
        return np.array([x1, v + dt * ((1 - delta) * a + delta * new), new])

    return step


def composite_on_sine(split: float, frequency: float = 1.0) -> Callable[[Array, float, float], Array]:
    """Return the step of the composite scheme with rho_inf = 0: trapezoidal, then three-point backward Euler.

    y1 = (y_g - (1 - g)^2 y) / (g (2 - g)) + (1 - g)/(2 - g) dt y1', for x and for v.
    """
    trapezoidal = newmark_on_sine(0.25, 0.5, frequency)

    def step(state: Array, t: float, dt: float) -> Array:
        g = split
        middle = trapezoidal(state, t, g * dt)
        backward = (middle - (1 - g) ** 2 * state) / (g * (2 - g))
        share = (1 - g) / (2 - g) * dt
        new = math.sin(2 * math.pi * frequency * (t + dt))
        v1 = backward[1] + share * new
        return np.array([backward[0] + share * v1, v1, new])

    return step


# ---- sliding --------------------------------------------------------------------------------------------------------


def normal_ringing_error(scene: Scene, stiffness: float, step: float, start: float = 0.05, end: float = 0.2) -> float:
    """Return the largest error of a sliding block between two times, over its exact way, as its ringing makes it.

    The block does not turn and stays closed: u_t = a t^2/2 - tan(phi) u_n, with u_n the normal ringing of the rigid
    block on its springs under its weight by the scheme.
    """
    w = math.sqrt(2 * stiffness / scene.block.mass)
    rest = friction.across(scene) / w**2
    matrix = newmark_step(Stepping(step, scene.time.alpha, scene.time.delta), w * step)
    time = np.arange(1, round(end / step) + 1) * step
    state = np.array([rest, 0.0, -rest * (w * step) ** 2])
    ringing = np.empty(len(time))
    for n in range(len(time)):
        state = matrix @ state
        ringing[n] = state[0] - rest
    way = friction.sliding_acceleration(scene) * time**2 / 2
    within = time >= start - TOLERANCE
    return float(np.max(np.abs(friction.coefficient(scene) * ringing / way)[within]))


def lagging_friction_error(scene: Scene, step: float, time: float) -> float:
    """Return the relative error of a sliding block whose friction is that of the step before, none at first."""
    without_friction = friction.coefficient(scene) * friction.across(scene) * step
    return without_friction * time / (friction.sliding_acceleration(scene) * time**2 / 2)


def shaken_way(step: float, gg: float, slope: float = 20.0, angle: float = 30.0, duration: float = 5.0) -> float:
    """Return the way of a rigid block on a plane shaken along it at 2.66 Hz with 0.28 g, by steps with a discount [m].

    v1 = max(0, gg v + dt a1), x1 = x + dt (gg v + v1)/2; the block does not slide uphill.
    """
    b = math.radians(slope)
    time = np.arange(1, round(duration / step) + 1) * step
    drive = GRAVITY * (math.sin(b) + 0.28 * np.sin(2 * math.pi * 2.66 * time))
    gained = step * (drive - math.tan(math.radians(angle)) * GRAVITY * math.cos(b))
    v = 0.0
    way = 0.0
    for change in gained.tolist():
        u = gg * v
        v = max(0.0, u + change)
        way += step * (u + v) / 2
    return way


# ---- a viscous boundary under an oblique wave -----------------------------------------------------------------------


def returned_energy(angle: float, wave: str, poisson: float = 0.25) -> float:
    """Return the share of energy that dashpots rho cP and rho cS on a half space send back of a plane wave.

    Parameters
    ----------
    angle
        Of incidence, from the normal [deg].
    wave
        "P" or "S" (in the plane).
    poisson
        Poisson's ratio.

    Notes
    -----
    Of a wave A d e^{iw(t - s x - q z)} the boundary z = 0 has sigma_zz + rho cP v_z = 0 and sigma_xz + rho cS v_x = 0,
    linear in the two waves that come back; flux normal to the boundary goes as c^2 q |A|^2.
    """
    speeds = {"S": 1.0, "P": math.sqrt((2 - 2 * poisson) / (1 - 2 * poisson))}
    slowness = math.sin(math.radians(angle)) / speeds[wave]
    normal = {name: np.sqrt(complex(1 / c**2 - slowness**2)) for name, c in speeds.items()}
    if normal["P"].imag > 0:  # a surface wave that dies out into the half space
        normal["P"] = -normal["P"]
    lame = speeds["P"] ** 2 - 2

    def defect(name: str, sign: int) -> Complex:
        """Return the two residuals of the boundary over i w, of a wave that runs to it (1) or from it (-1)."""
        q = sign * normal[name]
        direction = np.array([slowness, q]) if name == "P" else np.array([q, -slowness])
        x, z = speeds[name] * direction
        # the gradient over i w is -(s, q)
        stress = -np.array([lame * (slowness * x + q * z) + 2 * q * z, q * x + slowness * z])
        return np.asarray(stress + np.array([speeds["P"] * z, speeds["S"] * x]))

    back = np.linalg.solve(np.column_stack([defect("P", -1), defect("S", -1)]), -defect(wave, 1))
    flux = sum(abs(A) ** 2 * speeds[name] ** 2 * normal[name].real for A, name in zip(back, "PS", strict=True))
    return float(flux / (speeds[wave] ** 2 * normal[wave].real))
