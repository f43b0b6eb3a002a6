"""An independent solution of a layered column at one frequency: exact dynamic stiffnesses, solved at once.

A piece of length d between two levels has E k / sin(kd) [[cos(kd), -1], [-1, cos(kd)]], k = w (rho / E)^(1/2); where a
joint lies a level has two displacements.
"""

import itertools

import numpy as np

DIGITS = 9  # of a level [m]: what is nearer is one


def assembled(ground, w, heights, base):
    """Return the displacements at the heights (at a joint of its lower face) and the base's pressure.

    The base, or the wave that comes up, has a unit velocity; else 1 Pa presses on the top.
    """
    levels = np.unique(np.round([0.0, *ground.tops, *(h for h, _ in ground.joints), *heights], DIGITS))
    springs = {round(h, DIGITS): k for h, k in ground.joints}
    above, below, n = {}, {}, 0
    for level in levels:
        below[level], above[level] = n, n + (level in springs)
        n = above[level] + 1
    K, F = np.zeros((n, n), complex), np.zeros(n, complex)
    for low, high in itertools.pairwise(levels):
        stratum = ground.strata[int(np.searchsorted(ground.tops - 1e-7, (low + high) / 2))]
        E = stratum.modulus(ground.motion)
        k = w * np.sqrt(stratum.density / E)
        c, s = np.cos(k * (high - low)), np.sin(k * (high - low))
        K[np.ix_([above[low], below[high]], [above[low], below[high]])] += E * k / s * np.array([[c, -1], [-1, c]])
    for level, k in springs.items():
        pair = [below[level], above[level]]
        K[np.ix_(pair, pair)] += k * np.array([[1, -1], [-1, 1]])
    top, z = above[levels[-1]], ground.impedance
    F[top] -= not base
    x = np.zeros(n, complex)
    if z is None:
        x[0] = base / (1j * w)
        x[1:] = np.linalg.solve(K[1:, 1:], F[1:] - K[1:, 0] * x[0])
        pressure = (K @ x)[0]
    else:
        dashed = K.copy()
        dashed[0, 0] += 1j * w * z
        F[0] += 2 * z * base
        x = np.linalg.solve(dashed, F)
        pressure = z * (2 * base - 1j * w * x[0])
    places = [round(height, DIGITS) for height in heights]
    return [x[below[place] if place > 0 else above[place]] for place in places], pressure
