"""Random blocks on no-tension corners, and an integration of their motion that shares nothing with the exact one."""

import numpy as np
from numpy.typing import NDArray

from fem_reference.events.block_model import BlockProblem


def random_problem(seed: int) -> BlockProblem:
    rng = np.random.default_rng(seed)
    young = 1e9 * 10 ** rng.uniform(-1, 1)
    width = rng.uniform(0.5, 3.0)
    p = young * 10 ** rng.uniform(-1, 1.5)
    strain = bool(rng.integers(2))
    return BlockProblem(
        width=width,
        height=width * rng.uniform(0.6, 1.8),
        density=rng.uniform(2000, 3000),
        young=young,
        stiffness=p,
        pressure=young * rng.uniform(0.001, 0.01),
        shear_stiffness=p * rng.uniform(0.2, 1.0) * int(rng.integers(2)),
        poisson=rng.uniform(-0.2, 0.4),
        hypothesis="plane strain" if strain else "plane stress",
        eccentricity=width * rng.uniform(-0.2, 0.2),
        traction=young * rng.uniform(-5e-4, 5e-4),
        gravity=rng.uniform(0, 20),
        gap=width * rng.uniform(0, 1e-3) * int(rng.integers(2)),
        velocity=rng.uniform(-2, 2),
    )


class Integrated:
    """The same block in (u, v, r, ex, ey, gxy), by Gauss quadrature and DOP853 with events."""

    def __init__(self, problem: BlockProblem) -> None:
        self.problem = q = problem
        x, weight = np.polynomial.legendre.leggauss(3)
        X, Y = (z.ravel() * side / 2 for z, side in zip(np.meshgrid(x, x), (q.width, q.height), strict=True))
        area = np.outer(weight, weight).ravel() * q.width * q.height / 4
        self.M = sum(q.density * w * T.T @ T for w, T in zip(area, map(self.T, X, Y), strict=True))
        E, mu = q.young, q.poisson
        lame = E * mu / ((1 + mu) * (1 - 2 * mu)) if q.hypothesis == "plane strain" else E * mu / (1 - mu**2)
        G = E / (2 * (1 + mu))
        self.K0 = np.zeros((6, 6))
        elastic = np.array([[lame + 2 * G, lame, 0], [lame, lame + 2 * G, 0], [0, 0, G]])
        self.K0[3:, 3:] = q.width * q.height * elastic
        self.corners = [self.T(s * q.width / 2, -q.height / 2) for s in (-1, 1)]
        middle = self.T(q.eccentricity, q.height / 2)[1] * (q.width - 2 * abs(q.eccentricity))
        self.F = -q.pressure * middle + q.traction * q.width * self.T(0, q.height / 2)[0]
        self.F -= q.density * q.width * q.height * q.gravity * self.T(0, 0)[1]

    @staticmethod
    def T(x: float, y: float) -> NDArray[np.float64]:
        return np.array([[1, 0, -y, x, 0, y / 2], [0, 1, x, 0, y, x / 2]])

    def gap(self, D: NDArray[np.float64], corner: int) -> float:
        return float(self.problem.gap + self.corners[corner][1] @ D)

    def run(self, closed: list[bool], end: float) -> tuple[list[float], NDArray[np.float64]]:
        from scipy.integrate import solve_ivp

        y, t = np.zeros(12), 0.0
        y[7] = self.problem.velocity
        times: list[float] = []
        references = [0.0, 0.0]
        while t < end:
            events = [self.event(c, closed[c]) for c in (0, 1)]
            done = solve_ivp(
                self.rate(closed, references), (t, end), y, method="DOP853", rtol=1e-13, atol=1e-16, events=events
            )
            t, y = done.t[-1], done.y[:, -1]
            for c in (0, 1):
                if len(done.t_events[c]):
                    closed[c] = not closed[c]
                    references[c] = float(self.corners[c][0] @ y[:6])
                    times.append(t)
        return times, y

    def event(self, corner: int, closed: bool):
        def event(t, y):
            return self.gap(y[:6], corner)

        event.terminal, event.direction = True, 1 if closed else -1
        return event

    def rate(self, closed: list[bool], references: list[float]):
        q = self.problem

        def rate(t, y):
            force = self.F - self.K0 @ y[:6]
            for T, shut, r in zip(self.corners, closed, references, strict=True):
                if shut:
                    force -= q.stiffness * (q.gap + T[1] @ y[:6]) * T[1]
                    force -= q.shear_stiffness * (T[0] @ y[:6] - r) * T[0]
            return np.concatenate([y[6:], np.linalg.solve(self.M, force)])

        return rate
