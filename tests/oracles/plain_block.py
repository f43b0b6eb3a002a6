"""A plain DDA code of one block, as someone writes it from the paper in an afternoon, with the slips that one makes.

Six unknowns about the centroid, corner springs in a loop over the two corners, textbook recursion (increments of the
displacement, stress and spring stretch summed up), dense solves; the geometry may move with the block, and a base of
its own mass and springs may yield. It shares no line with the suite's own models.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

HEADER = "\n% Timestep, currenttime, deltat, xpos, ypos, dcum, vx, vy, v\n\nmeaspoint1=[\n"


@dataclass(frozen=True)
class Plain:
    """A run; the first lines are the scene, the others what was done wrong."""

    dt: float = 0.002
    steps: int = 100
    side: float = 2.0
    rho: float = 2700.0
    E: float = 1e9
    mu: float = 0.0
    strain: bool = False
    p: float = 1e9
    q: float = 5e6
    alpha: float = 0.5
    delta: float = 1.0
    gg: float = 1.0
    consistent: bool = False
    g: float = 0.0
    updated: bool = False  # all matrices are those of the moved corners
    base: tuple[float, float] | None = None  # a base that yields: its mass over the block's, its springs [N/m]

    formulas: str = "both"  # in which gg stands
    point: float = 0.0  # height of the reported point over h/2
    late: int = 0  # steps that the pressure is late
    averaged: bool = False  # pressure of two steps
    row_sign: float = 1.0  # of the load in the row of ey
    coupling: float = 1.0  # of v and ey by the springs
    keeps_stress: bool = True
    keeps_springs: bool = True
    opens: bool = False
    band: float = 0.0
    tension: float = 0.0  # N a corner, that a closed contact bears
    lags: str = ""  # "opening" or "switching": by the gap at the start of the step
    pressure_times: float = 1.0
    displacement_times: float = 1.0

    # what no catalogue holds
    height: float | None = None  # another geometry
    viscous: float = 0.0  # 1/s, damping of the mass
    structural: float = 0.0  # s, damping of the stiffness
    hardening: float = 0.0  # 1/m, springs stiffen with penetration
    creep: float = 0.0  # 1/s, block stress relaxes
    ramp: float = 0.0  # s, the load comes on slowly
    shaken: float = 0.0  # random part of the load of every step
    seed: int = 0
    filtered: float = 0.0  # share of the row before in every row
    hht: float = 0.0  # share of the stiffness of a step that is added to it, in the manner of Hilber, Hughes and Taylor
    friction: float = 0.0  # N, a constant force against the motion


@dataclass(frozen=True)
class History:
    """What a run gives at each step."""

    time: np.ndarray
    displacement: np.ndarray
    pressure: np.ndarray
    open: np.ndarray  # both corners open at the end of the step

    @property
    def opened(self):
        """The first and the last step with open corners."""
        steps = np.flatnonzero(self.open) + 1
        return (int(steps[0]), int(steps[-1])) if len(steps) else None


def run(P):
    """Return displacement and contact pressure of every step."""
    found = history(P)
    return found.displacement, found.pressure


def matrices(P, a, h):
    """Return mass, stiffness, load and weight of a rectangle, the motion of its lower corners, and its area."""
    n = 6 if P.base is None else 7
    S, s1, s2 = a * h, h * a**3 / 12, a * h**3 / 12
    M = np.zeros((n, n))
    M[0, 0] = M[1, 1] = S
    M[2, 2], M[3, 3], M[4, 4], M[5, 5] = s1 + s2, s1, s2, (s1 + s2) / 4
    M[2, 5] = M[5, 2] = (s1 - s2) / 2
    M *= P.rho
    E, mu = (P.E / (1 - P.mu**2), P.mu / (1 - P.mu)) if P.strain else (P.E, P.mu)
    elastic = np.zeros((n, n))
    elastic[3:6, 3:6] = S * E / (1 - mu**2) * np.array([[1, mu, 0], [mu, 1, 0], [0, 0, (1 - mu) / 2]])
    if P.base is not None:
        M[6, 6] = P.base[0] * P.rho * P.side**2
        elastic[6, 6] = P.base[1]

    def T(x, y):
        rows = np.zeros((2, n))
        rows[:, :6] = [[1, 0, -y, x, 0, y / 2], [0, 1, x, 0, y, x / 2]]
        return rows

    load = P.side * T(0, h / 2).T @ [0, -P.q]
    load[4] *= P.row_sign
    weight = np.zeros(n)
    weight[1] = -P.rho * S * P.g
    corners = np.array([T(-a / 2, -h / 2), T(a / 2, -h / 2)])
    corners[:, 1, 6:] = -1.0
    return M, elastic, load, weight, corners, S


def history(P):
    """Return the history of a run."""
    a, h = P.side, P.side if P.height is None else P.height
    M, elastic, load, weight, corners, S = matrices(P, a, h)
    rng = np.random.default_rng(P.seed)

    stress, (V, A, total) = np.zeros(3), np.zeros((3, len(M)))
    stretch = [np.zeros(2), np.zeros(2)]
    on = [True, True]
    if P.consistent:
        A = np.linalg.solve(M, load + weight)
    found = []
    for n in range(P.steps):
        share = min(1.0, (n + 1) * P.dt / P.ramp) if P.ramp else 1.0
        share *= 1 + P.shaken * rng.standard_normal()
        one = P.gg if P.formulas != "velocity" else 1.0
        two = P.gg if P.formulas != "displacement" else 1.0
        if P.lags:
            on = [gone[1] <= 0 if was else P.lags == "switching" and gone[1] < 0 for gone, was in
                  zip(stretch, on, strict=True)]  # fmt: skip
        for _ in range(8):
            K, F = elastic.copy(), share * load + weight
            if P.keeps_stress:
                F[3:6] -= S * stress
            F[6:] -= elastic[6:, 6:] @ total[6:]
            for corner, gone, closed in zip(corners, stretch, on, strict=True):
                if not closed:
                    continue
                p = P.p * (1 + P.hardening * abs(gone[1]))
                k = p * np.outer(corner[1], corner[1])
                back = p * gone[1] * corner[1]
                if P.coupling != 1:
                    k[1, 4] *= P.coupling
                    k[4, 1] *= P.coupling
                    half = corner[1, 4]
                    back = p * np.array([0, total[1] + P.coupling * half * total[4], 0, 0,
                                         half * (P.coupling * total[1] + half * total[4]), 0])  # fmt: skip
                K += k + P.p * np.outer(corner[0], corner[0])
                if P.keeps_springs:
                    F -= back + P.p * gone[0] * corner[0]
            damping = P.viscous * M + P.structural * K
            if P.friction:
                F[1] -= P.friction * np.tanh(V[1] / 0.01)
            b, c = P.alpha * P.dt**2, P.delta / (P.alpha * P.dt)
            hold = 1 + P.hht
            star = one * P.dt * V + P.dt**2 * (0.5 - P.alpha) * A
            # M (d - star)/b + damping V1 + (1 + hht) K d = F,  V1 = two V + dt (1 - delta) A + c (d - star)
            left = M / b + c * damping + hold * K
            right = F + M @ star / b - damping @ (two * V + P.dt * (1 - P.delta) * A - c * star)
            d = np.linalg.solve(left, right)
            ends = [gone + corner @ d for gone, corner in zip(stretch, corners, strict=True)]
            new = [not P.opens or (end[1] < P.tension / P.p if closed else end[1] < -P.band) for end, closed in
                   zip(ends, on, strict=True)]  # fmt: skip
            if P.lags:
                new = on if P.lags == "switching" else [was or now for was, now in zip(on, new, strict=True)]
            if new == on:
                break
            on = new
        A1 = (d - star) / b
        V = two * V + P.dt * ((1 - P.delta) * A + P.delta * A1)
        A = A1
        total = total + d
        stress = (stress + elastic[3:6, 3:6] @ d[3:6] / S) * (1 - P.creep * P.dt)
        stretch = [np.array([end[0] if closed else 0.0, end[1]]) for end, closed in zip(ends, on, strict=True)]
        force = sum(
            -P.p * (1 + P.hardening * abs(s[1])) * s[1] for s, closed in zip(stretch, on, strict=True) if closed
        )
        found.append((total[1] + P.point * h / 2 * total[4], force / P.side, not any(on)))
        if P.updated:
            a, h = a * (1 + d[3]), h * (1 + d[4])
            M, elastic, load, weight, corners, S = matrices(P, a, h)
    displacement, pressure, opened = np.array(found).T
    if P.averaged:
        pressure = (pressure + np.append(0.0, pressure[:-1])) / 2
    if P.late:
        pressure = np.append(np.zeros(P.late), pressure[: -P.late])
    for values in (displacement, pressure):
        for n in range(1, len(values)) if P.filtered else ():
            values[n] = P.filtered * values[n - 1] + (1 - P.filtered) * values[n]
    time = P.dt * np.arange(1, P.steps + 1)
    return History(time, P.displacement_times * displacement, P.pressure_times * pressure, opened > 0)


def write_measured_point(history, path, dt):
    """Write the file that ntdda writes: seven digits, an unsigned displacement, step velocities."""
    steps = np.diff(history.displacement, prepend=0.0)
    lines = [
        f"{n + 1:10d} {t:20e} {dt:20e} {5.0:20e} {3 + d:20e} {abs(d):20e} {0.0:20e} {s / dt:20e} {abs(s / dt):20e}\n"
        for n, (t, d, s) in enumerate(zip(history.time, history.displacement, steps, strict=True))
    ]
    path.write_text(HEADER + "".join(lines) + "];\n")
    return path
