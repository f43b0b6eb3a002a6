"""Closed forms of an upright rectangle on its springs under a pressure that vibrates.

Each takes squared frequencies W2 [1/s^2], w^2 in exact time or what the steps make of it, for mu = 0, and returns the
complex amplitudes of displacement [m] and contact pressure [Pa], with a bound of their conditioning: how many times a
relative error of the data, or of an operation, can be larger in them. Next to a resonance it is large.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.theory.spectra import EPS
from validation.theory.statics import moduli, size
from validation.theory.stepping import Complex
from validation.theory.waves import Column

OPERATIONS = 100  # roundings of two programs in a row, of which none is larger than the conditioning times eps


@dataclass(frozen=True)
class Vibration:
    """Amplitudes of a steady vibration and their conditioning."""

    displacement: Complex  # of the centroid, upwards [m]
    contact_pressure: Complex  # [Pa]
    condition: Array  # of both, [-]

    @property
    def band(self) -> Array:
        """The relative difference that rounding can make between two programs."""
        return OPERATIONS * EPS * self.condition


def block(scene: Scene, w2: ArrayLike, base: bool = False) -> Vibration:
    """Return the answer of the two-block model in its two unknowns D = (v, ey).

    ([2p, -p h; -p h, E w h + p h^2/2] - W2 diag(m, m h^2/12)) D = -q w (1, h/2): the pressure acts on the upper edge.
    On a base that moves by 1 m, without a load, p (2, -h) stands there instead; amplitudes are per metre then. The
    conditioning is Skeel's, |A^-1| (|K| + |W2| |M|) |D|, over the smallest part.
    """
    w2 = np.atleast_1d(np.asarray(w2, complex))[:, None, None]
    E, _ = moduli(scene)
    w, h = size(scene)
    p = scene.contact.stiffness
    K = np.array([[2 * p, -p * h], [-p * h, E * w * h + p * h * h / 2]])
    M = scene.block.density * w * h * np.diag([1, h * h / 12])
    force = p * np.array([2, -h]) if base else -scene.load.pressure * w * np.array([1, h / 2])
    inverse = np.linalg.inv(K - w2 * M)
    motion = np.asarray(inverse @ force, complex)
    errors = np.einsum("nij,njk,nk->ni", abs(inverse), abs(K) + abs(w2) * M, abs(motion))
    below = np.array([1, -h / 2])  # of the springs, over v and ey
    spring = motion @ below - base
    condition = np.maximum(errors[:, 0] / abs(motion[:, 0]), errors @ abs(below) / abs(spring))
    return Vibration(motion[:, 0], -2 * p / w * spring, condition)


def bar(scene: Scene, w2: ArrayLike) -> Vibration:
    """Return the answer of the bar: a wave up and a wave down, v = a e^{-iky} + b e^{ik(y - h)}, k = sqrt(rho W2 / E).

    E w v' = 2 p v at its foot, E v' = -q at its head; k has Im k <= 0, so that neither wave grows on its way.
    """
    E, _ = moduli(scene)
    w, h = size(scene)
    spring, q = 2 * scene.contact.stiffness / w, scene.load.pressure
    k = -1j * np.sqrt(-scene.block.density / E * np.asarray(w2, complex))
    z, turn = 1j * k * E, np.exp(-1j * k * h)
    # (spring + z) a + (spring - z) turn b = 0 and -z turn a + z b = -q
    below = z * ((spring + z) + (spring - z) * turn**2)
    a, b = q * (spring - z) * turn / below, -q * (spring + z) / below
    middle, foot = (a + b) * np.exp(-0.5j * k * h), a + b * turn
    parts = abs(z) * (spring + abs(z)) * (1 + abs(turn) ** 2) * (1 + abs(k * h))
    condition = parts / abs(below) * (abs(a) + abs(b)) / np.minimum(abs(middle), abs(foot))
    return Vibration(middle, -spring * foot, condition)


def elements(scene: Scene, w2: ArrayLike, count: int) -> Vibration:
    """Return the answer of an even number of linear elements with consistent mass along the bar.

    v_j = a x^j + b x^(N-j), x = e^{-ikl} with the wavenumber k of welded blocks of the height l = h/N, (A, B) their
    dynamic stiffness: (A + 2p/w) v_0 + B v_1 = 0 and A v_N + B v_(N-1) = -q.
    """
    E, _ = moduli(scene)
    w, h = size(scene)
    spring, q = 2 * scene.contact.stiffness / w, scene.load.pressure
    column = Column(h / count, scene.block.density, E)
    A, B = column.ends(w2)
    x = np.exp(-1j * column.wavenumber(w2) * column.height)
    x = np.where(abs(x) > 1, 1 / x, x)
    rise, fall, turn = A + B * x, A + B / x, x**count
    below = (rise + spring) * rise - (fall + spring) * turn * fall * turn
    a, b = q * (fall + spring) * turn / below, -q * (rise + spring) / below
    middle, foot = (a + b) * x ** (count // 2), a + b * turn
    lost = (abs(A) + abs(B)) * (2 * (abs(A) + abs(B)) + spring) * 2 / abs(below)
    condition = count * lost * (abs(a) + abs(b)) / np.minimum(abs(middle), abs(foot))
    return Vibration(middle, -spring * foot, condition)
