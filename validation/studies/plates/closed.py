r"""A hole in a plate under tension, and a disc under two arcs of pressure: displacements and stresses in closed form.

Hole of radius a in an infinite plate, tension s along x (Kirsch), k = (3 - nu)/(1 + nu) in plane stress:

    8 G u_r/s = r (k - 1 + 2 cos 2t) + (2 a^2/r) (1 + (1 + k - a^2/r^2) cos 2t).

Disc of radius 1 under the pressure p on two arcs of half angle al about the poles (Hondros): with the pressure's
Fourier terms p_0 = 2 p al/pi, p_n = (4 p/n pi) sin(n al), n even, from the pole, Airy's function has for each n the
terms a_n r^n + b_n r^(n+2), b_n = -p_n/2(n + 1), a_n = p_n/2(n - 1), and b_0 = -p_0/2, so that

    2 G u_r = (k - 1) b_0 r + sum [ -n a_n r^(n-1) + (k - n - 1) b_n r^(n+1) ] cos(n t).
"""

from __future__ import annotations

import math

import numpy as np

TERMS = 20_000  # of the disc's series on its rim, which falls as 1/n^2 and alternates


def hole_displacement(radius: float, angle: float, tension: float, young: float, poisson: float) -> float:
    """Return the radial displacement at the rim of a hole [m]."""
    k = (3 - poisson) / (1 + poisson)
    shear = young / (2 * (1 + poisson))
    double = math.cos(2 * angle)
    sum_of_terms = radius * (k - 1 + 2 * double) + 2 * radius * (1 + k * double)
    return tension * sum_of_terms / (8 * shear)


def disc_widening(pressure: float, half_angle: float, young: float, poisson: float) -> float:
    """Return the radial displacement of a disc of radius 1 at its rim, a right angle from the loads [m]."""
    k = (3 - poisson) / (1 + poisson)
    shear = young / (2 * (1 + poisson))
    n = 2.0 * np.arange(1, TERMS + 1)
    p = 4 * pressure / (n * math.pi) * np.sin(n * half_angle)
    a = p / (2 * (n - 1))
    b = -p / (2 * (n + 1))
    terms = (-n * a + (k - n - 1) * b) * np.cos(n * math.pi / 2)
    whole = (k - 1) * -pressure * half_angle / math.pi + float(np.sum(terms)) - float(terms[-1]) / 2
    return whole / (2 * shear)


def disc_centre(pressure: float, half_angle: float) -> tuple[float, float]:
    """Return the stresses across and along the load in the middle of a disc [Pa]."""
    first = 2 * pressure / math.pi * math.sin(2 * half_angle)
    second = 2 * pressure / math.pi * half_angle
    return first - second, -first - second
