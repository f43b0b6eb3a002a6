"""Bars of two sets of data, and the damped bar by a kernel of its own."""

import numpy as np
from scipy.special import i0e, i1e

from fem_reference.exact import continuum
from fem_reference.exact.bar import Bar

PAPER = Bar(2.0, 2.0, 2700.0, 1e9, 2e9, 5e6)


OTHER = Bar(3.1, 1.7, 1900.0, 4.2e9, 7.7e10, 3.3e5)


def damped_by_kernel(column, t, kappa, a):
    """Damped history at one instant: Bessel kernel on the undamped waves, panels graded towards the fronts."""
    first, gap = (1.0, 2.0) if column == "contact_pressure" else (0.5, 1.0)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    total = np.exp(-a * t) * continuum.undamped(column, np.array([t]), kappa)[0, 0]
    for front in np.arange(first, t, gap):
        length = min(gap, t - front)
        edges = np.unique(np.append(length * 2.0 ** -np.arange(0, 40, 0.5), np.linspace(0, length, 60)))
        half = np.diff(edges)[:, None] / 2
        u = (front + edges[:-1, None] + half * (1 + nodes)).ravel()
        z = np.sqrt((t - u) * (t + u))
        kernel = a * np.exp(-a * u * u / (t + z)) * (i0e(a * z) + t * i1e(a * z) / z)
        total += ((half * weights).ravel() * kernel) @ continuum.undamped(column, u, kappa)[0]
    return total
