"""A block of one strain that turns: integrated by DOP853 with nothing of `dda`, and random ones for `dda`."""

import numpy as np
from scipy.integrate import solve_ivp

from dda import Block, Load, Material, Unilateral
from dda.bodies.turning_block import RollingModel


class RollingBlock:
    """Unknowns q = (x + iy of the centroid, angle, ex, ey, gxy), axes of the strains turning with the block."""

    def __init__(self, outline, density, elasticity, p, ps, weight):
        """`outline` is complex and counter-clockwise, `elasticity` 3 x 3, `weight` a complex acceleration."""
        z = np.asarray(outline)
        parts = [(z[0], z[i], z[i + 1]) for i in range(1, len(z) - 1)]
        areas = np.array([((b - a).conjugate() * (c - a)).imag / 2 for a, b, c in parts])
        self.centroid = sum(s * sum(t) / 3 for s, t in zip(areas, parts, strict=True)) / sum(areas)
        self.zeta = z - self.centroid
        self.mass = density * sum(areas)
        self.M = np.zeros((6, 6))
        for s, (a, b, c) in zip(areas, parts, strict=True):
            for middle in ((a + b) / 2, (b + c) / 2, (c + a) / 2):  # exact for the square of a linear field
                d = self.derivatives(middle - self.centroid, 0.0, np.zeros(3))
                self.M += density * s / 3 * np.real(np.outer(d.conjugate(), d))
        self.K = sum(areas) * np.asarray(elasticity)
        self.p, self.ps, self.weight = p, ps, weight

    @staticmethod
    def strained(zeta, e):
        return zeta.real * (1 + e[0]) + zeta.imag * e[2] / 2 + 1j * (zeta.imag * (1 + e[1]) + zeta.real * e[2] / 2)

    def derivatives(self, zeta, angle, e):
        """Return dz/dq of a point."""
        own = np.array([1j * self.strained(zeta, e), zeta.real, 1j * zeta.imag, (zeta.imag + 1j * zeta.real) / 2])
        return np.array([1.0, 1j, *(np.exp(1j * angle) * own)])

    def corner(self, q, i):
        return q[0] + 1j * q[1] + np.exp(1j * q[2]) * self.strained(self.zeta[i], q[3:6])

    def force(self, q, reference):
        """Return the generalised force; corners are glued to their references, and None is frictionless."""
        total = np.zeros(6)
        total[:2] = self.mass * self.weight.real, self.mass * self.weight.imag
        total[3:] = -self.K @ q[3:]
        for i, zeta in enumerate(self.zeta):
            z = self.corner(q, i)
            if z.imag < 0:
                T = 0.0 if reference[i] is None else -self.ps * (z.real - reference[i])
                acting = T - 1j * self.p * z.imag
                total += np.real(np.conj(acting) * self.derivatives(zeta, q[2], q[3:6]))
        return total

    def motion(self, q0, v0, times, reference):
        """Return q and velocities at times, (len(times), 12)."""
        inverse = np.linalg.inv(self.M)

        def rate(_, y):
            return np.concatenate([y[6:], inverse @ self.force(y[:6], reference)])

        found = solve_ivp(rate, (0, times[-1]), [*q0, *v0], "DOP853", t_eval=times, rtol=1e-11, atol=1e-13)
        return found.y.T


def convex(rng):
    """Return a random convex outline of three to seven corners."""
    while True:
        angles = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 8)))
        sides = np.diff([*angles, angles[0] + 2 * np.pi])
        if np.max(sides) < 2.9 and np.min(sides) > 0.25:
            return np.column_stack([np.cos(angles), 0.8 * np.sin(angles)]) * (1 + rng.random())


def random_rolling(seed):
    """Return a block thrown with a spin at a slope, frictionless, glued or rubbing, and a time step of 0.3 to 30 ms."""
    rng = np.random.default_rng(seed)
    material = Material(2700.0, 10 ** rng.uniform(8, 10), rng.uniform(0, 0.4))
    outline = convex(rng)
    if seed % 2:
        a, h = rng.uniform(1, 2), rng.uniform(1, 3)
        outline = [[0, 0], [a, 0], [a, h], [0, h]]
    p, kind = 10 ** rng.uniform(7.5, 10), seed % 3
    rubbing = {"friction": rng.uniform(0, 1.2), "cohesion": 1e3 * rng.random()} if kind == 2 else {}
    law = Unilateral(p, p / 2.5 if kind else 0.0, rng.random(), **rubbing)
    load = Load(rng.choice([0, 2e3]), 0.0, rng.choice([0, 5e3]), gravity=9.81, slope=rng.uniform(-40, 40))
    thrown = {"tilt": rng.uniform(-1, 1), "velocity": (rng.normal(), -rng.random()), "spin": 4 * rng.normal()}
    return RollingModel(Block(outline, material), law, load, **thrown), 10 ** rng.uniform(-3.5, -1.5)
