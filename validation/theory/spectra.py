"""First frequencies of block, bar and mesh, and what one step of Newmark's scheme makes of them.

They hold for the paper's block, an upright rectangle on its lower edge under vertical pressure.
"""

from __future__ import annotations

import cmath
import math

import numpy as np

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory.stages import step_end
from validation.theory.statics import height, moduli, size
from validation.theory.stepping import Stepping

EPS = 2.0**-52


def dda_frequency(scene: Scene) -> float:
    """First axial frequency of the DDA block for mu = 0 [rad/s].

    Smaller root of (2p - w^2 m) (E h w + ...) - (p h)^2: M = diag(m, m h^2/12), K = [[2p, -p h], [-p h, E w h +
    p h^2/2]], the two-unknown form of equations (17) and (27).
    """
    E, _ = moduli(scene)
    w, h = size(scene)
    p, m = scene.contact.stiffness, scene.block.density * w * h
    a, c = 2 * p / m, 12 * (E * w * h + p * h * h / 2) / (m * h * h)
    determinant = 2 * p / m * 12 * E * w * h / (m * h * h)
    half = (a + c) / 2
    return math.sqrt(determinant / (half + math.sqrt(half * half - determinant)))


def bar_frequency(scene: Scene) -> float:
    """First frequency of the bar on its base spring [rad/s]: w = (b / h) sqrt(E/rho), b tan b = 2 p h / (E w)."""
    E, _ = moduli(scene)
    return float(bar_modes(scene, 1)[0]) / size(scene)[1] * math.sqrt(E / scene.block.density)


def roots(scene: Scene, frequency: float) -> tuple[complex, complex]:
    """Principal eigenvalues of one step of a mode."""
    first, second = Stepping.of(scene).roots(frequency * scene.time.step)[:2]
    return complex(first), complex(second)


def damping_ratio(scene: Scene, frequency: float) -> float:
    """Damping ratio xi = -Re(ln lambda) / |ln lambda| of a mode that oscillates."""
    logarithm = cmath.log(roots(scene, frequency)[0])
    return -logarithm.real / abs(logarithm)


def contact_frequency(scene: Scene) -> float:
    """Second (contact) frequency of the DDA block for mu = 0 [rad/s], from det(K) / det(M) = w1^2 w2^2."""
    E, _ = moduli(scene)
    w, h = size(scene)
    m = scene.block.density * w * h
    return math.sqrt(2 * scene.contact.stiffness / m) * math.sqrt(12 * E * w / (m * h)) / dda_frequency(scene)


def critical_omega(scene: Scene) -> float:
    """Limit of w dt beyond which a root leaves the unit circle, infinite where none does."""
    return Stepping.of(scene).critical_omega


def spectral_radius(scene: Scene, frequency: float) -> float:
    """Largest |lambda| of one step of a mode."""
    return Stepping.of(scene).spectral_radius(frequency * scene.time.step)


def remaining_motion(scene: Scene) -> float:
    """Largest |lambda|^steps over the two modes: what damping has left of the DDA block's motion at the last step."""
    both = (dda_frequency(scene), contact_frequency(scene))
    return float(max(spectral_radius(scene, frequency) for frequency in both) ** scene.time.steps)


def mesh_frequency_error(scene: Scene) -> float:
    """Leading relative error of a bar's first frequency on n elements a side, consistent mass.

    Linear: (b/n)^2 / 24. Quadratic: (b/n)^4 / 1440 times the mean of sin^2 over that of cos^2 along the bar: the
    interpolation error's energy is h^4 / 720 times the integral of EA (d3 phi / dy3)^2, phi = cos(b (1 - y/h)).
    """
    b = float(bar_modes(scene, 1)[0])
    wave, turn = b / scene.fem.per_side, math.sin(2 * b) / (2 * b)
    return wave**2 / 24 if scene.fem.degree == 1 else wave**4 / 1440 * (1 - turn) / (1 + turn)


def transit(scene: Scene) -> float:
    """Return the time h / c of a wave through the height of the block [s]."""
    modulus, _ = moduli(scene)
    return height(scene) * math.sqrt(scene.block.density / modulus)


def elements_per_front(scene: Scene) -> float:
    """Elements per distance c dt that the wave runs in one step."""
    E, _ = moduli(scene)
    return math.sqrt(E / scene.block.density) * scene.time.step * scene.fem.per_side / size(scene)[1]


def bar_modes(scene: Scene, count: int) -> Array:
    """Lowest roots of b tan b = 2 p h / (E w), shape (count,): bisection on each branch [n pi, n pi + pi/2]."""
    E, _ = moduli(scene)
    w, h = size(scene)
    ratio = 2 * scene.contact.stiffness * h / (E * w)
    low = np.pi * np.arange(count)
    high = low + np.pi / 2
    sign = np.where(np.arange(count) % 2, -1.0, 1.0)
    while True:
        b = (low + high) / 2
        if np.all((b == low) | (b == high)):  # neighbours, also of the small root of a soft spring
            return b
        below = sign * (b * np.sin(b) - ratio * np.cos(b)) < 0
        low, high = np.where(below, b, low), np.where(below, high, b)


def bar_shares(scene: Scene, quantity: str, b: Array) -> Array:
    """Share of each mode cos(b (1 - y/h)) in the static displacement of the centroid or in the static pressure."""
    E, _ = moduli(scene)
    w, h = size(scene)
    ratio = 2 * scene.contact.stiffness * h / (E * w)
    modal = 2 / (b**2 * (1 + np.sin(2 * b) / (2 * b)))  # response of the mode to a unit of q h / E, in phi
    if quantity == "displacement":
        return modal * np.cos(b / 2) / (1 / ratio + 0.5)
    return modal * np.cos(b) * ratio


def bar_response(scene: Scene, omega: Array) -> Array:
    """Response of modes w dt to a step load over their static values, from rest, shape (steps, modes)."""
    t = scene.time
    stages = Stepping.of(scene).stages
    displacement, velocity, acceleration = np.eye(3)
    end = step_end(stages, displacement, t.discount * velocity, acceleration, omega[:, None] ** 2)
    # a step of a mode's (x - 1, v, a), from the right; as many steps at once as are known
    power = np.stack(end, axis=2)
    states = np.zeros((len(omega), t.steps + 1, 3))
    states[:, 0, 0] = -1.0
    states[:, 0, 2] = omega**2 * (t.start == "consistent")
    known = 1
    while known <= t.steps:
        more = min(known, t.steps + 1 - known)
        states[:, known : known + more] = states[:, :more] @ power
        power = power @ power
        known += more
    return np.asarray(1 + states[:, 1:, 0].T)


def mesh_error(scene: Scene) -> dict[str, float]:
    """Relative L2 errors of quadratic elements against the bar, by quantity, predicted from their dispersion alone.

    Each mode's frequency is high by (b/n)^4 / 1440 (with the first factor of `mesh_frequency_error`), its share right;
    compared are the histories of all modes that the mesh can hold, with and without that shift.
    """
    E, _ = moduli(scene)
    b = bar_modes(scene, 2 * scene.fem.per_side)
    turn = np.sin(2 * b) / (2 * b)
    shift = (b / scene.fem.per_side) ** 4 / 1440 * (1 - turn) / (1 + turn)
    omega = b / size(scene)[1] * math.sqrt(E / scene.block.density) * scene.time.step
    quantities = ("displacement", "pressure")
    shares = np.column_stack([bar_shares(scene, quantity, b) for quantity in quantities])
    both = bar_response(scene, np.concatenate([omega, (1 + shift) * omega]))  # one loop over the steps for the two
    exact, shifted = both[:, : len(b)] @ shares, both[:, len(b) :] @ shares
    errors = np.linalg.norm(shifted - exact, axis=0) / np.linalg.norm(exact + (1 - shares.sum(axis=0)), axis=0)
    return dict(zip(quantities, errors.tolist(), strict=True))


def rounding(scene: Scene) -> float:
    """Relative distance of two sound programs' histories for mu = 0."""
    omega2 = (dda_frequency(scene) * scene.time.step) ** 2
    soft = 1 + 2 * scene.contact.stiffness / scene.block.young
    return 10 * EPS * scene.time.steps * soft * max(1.0, 1 / omega2)
