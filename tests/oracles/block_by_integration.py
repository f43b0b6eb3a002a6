"""Random blocks on corners that open, slip or have dashpots, on a base that may move, integrated by DOP853 with events.

A program of its own in floats, in (u, v, r, ex, ey, gxy): it shares nothing with the exact motion but the problem.
"""

import math
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from fem_reference.events.block_model import BlockProblem
from fem_reference.problem.motion import Motion

OPEN, STICKS, RIGHT, LEFT, RELEASED = 0, 1, 2, -2, 3


def random_problem(seed):
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


def slipping_problem(seed, moved=False):
    """A random block with friction; where `moved`, its base follows a random record."""
    rng = np.random.default_rng(1000 + seed)
    problem = random_problem(seed)
    travel = problem.height * math.sqrt(problem.density / problem.young)
    rows = np.cumsum(rng.uniform(0.1, 0.6, 40)) * travel
    path = np.cumsum(rng.normal(0, 2e-4, (2, 39)), axis=1) * problem.width
    record = Motion((0.0, *rows[:39]), (0.0, *path[0]), (0.0, *path[1]))
    return replace(
        problem,
        shear_stiffness=problem.stiffness * rng.uniform(0.2, 1.0),
        slope=rng.uniform(-20, 20),
        friction=rng.uniform(5, 45),
        cohesion=problem.pressure * rng.uniform(0, 0.1) * int(rng.integers(2)),
        base=record if moved else None,
    )


class Integrated:
    """A block from given states of its corners; without an angle of friction they never slip."""

    def __init__(self, problem):
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
        slope = math.radians(q.slope)
        weight = q.density * q.width * q.height * q.gravity
        self.F += weight * np.array([math.sin(slope), -math.cos(slope)]) @ self.T(0, 0)
        self.tan = math.tan(math.radians(q.friction or 0.0))
        self.C = q.cohesion * q.width / 2
        self.states, self.references = [OPEN, OPEN], [0.0, 0.0]

    @staticmethod
    def T(x, y):
        return np.array([[1, 0, -y, x, 0, y / 2], [0, 1, x, 0, y, x / 2]])

    def base(self, t):
        if self.problem.base is None:
            return np.zeros(2), np.zeros(2)
        rows = np.array([self.problem.base.time, self.problem.base.x, self.problem.base.y])
        i = min(max(int(np.searchsorted(rows[0], self.inside)) - 1, 0), rows.shape[1] - 2)
        speed = (rows[1:, i + 1] - rows[1:, i]) / (rows[0, i + 1] - rows[0, i])
        return rows[1:, i] + speed * (t - rows[0, i]), speed

    def corner(self, c, t, y):
        """Gap, slide, forces, reserves and the rate of dissipation of a corner; `P` is N as if it were closed."""
        q, (at, speed) = self.problem, self.base(t)
        s, w = self.corners[c] @ y[:6] - at + [0, q.gap]
        ds, dw = self.corners[c] @ y[6:] - speed
        state, sign = self.states[c], -np.sign(self.states[c])
        P = -q.stiffness * w - q.damping * dw
        N = 0.0 if state in (OPEN, RELEASED) else P
        limit = self.tan * N + self.C
        resting = {OPEN: 0.0, RELEASED: 0.0, STICKS: -q.shear_stiffness * (s - self.references[c])}
        T = resting.get(state, sign * limit)
        here = {"w": w, "s": s, "dw": dw, "ds": ds, "P": P, "N": N, "T": T, "limit": limit}
        if q.friction is not None:
            here["d"] = -sign * (ds - sign * self.tan * q.stiffness * dw / q.shear_stiffness)
        return here

    def run(self, states, end):
        """Times, corners and new states of the switches, and the state vector at the end."""
        self.states = states
        y, t, found = np.zeros(12), 0.0, []
        y[7] = self.problem.velocity
        rows = [] if self.problem.base is None else [x for x in self.problem.base.time if 0 < x < end]
        for row in [*rows, end]:
            self.inside = (t + row) / 2
            while t < row:
                t, y, switches = self.until(t, y, row)
                found += switches
        return found, y

    def until(self, t, y, end):
        found = []
        for c in (0, 1):
            if abs(self.states[c]) == RIGHT and self.corner(c, t, y)["d"] < -1e-9:  # the base turned round
                found.append(self.switch(c, STICKS, t, y))
        events = [(c, *event) for c in (0, 1) for event in self.events(c)]
        options = {"rtol": 1e-13, "atol": 1e-16, "events": [event for _, _, event in events]}
        done = solve_ivp(self.motion, (t, end), y, "DOP853", **options)
        t, y = float(done.t[-1]), done.y[:, -1]
        for (c, state, _), times in zip(events, done.t_events, strict=True):
            if len(times):
                released = self.states[c] == RELEASED and state == OPEN  # which changes no force
                switch = self.switch(c, state, t, y)
                found += [] if released else [switch]
        return t, y, found

    def switch(self, c, state, t, y):
        here = self.corner(c, t, y)
        q = self.problem
        self.references[c] = here["s"] + (here["T"] / q.shear_stiffness if here["T"] else 0.0)
        fast = q.shear_stiffness * abs(here["ds"]) > self.tan * q.stiffness * abs(here["dw"])
        if q.friction is not None and state == STICKS and self.states[c] == OPEN and fast and not self.C:
            state = RIGHT if here["ds"] > 0 else LEFT
        self.states[c] = state
        return t, "MN"[c], state

    def events(self, c):
        def falls(state, value):
            def event(t, y):
                return value(self.corner(c, t, y))

            event.terminal, event.direction = True, -1
            return state, event

        if self.states[c] == OPEN:
            return [falls(STICKS, lambda here: here["w"])]
        if self.states[c] == RELEASED:
            return [falls(OPEN, lambda here: -here["w"]), falls(STICKS, lambda here: -here["P"])]
        opens = falls(RELEASED if self.problem.damping else OPEN, lambda here: here["N"])
        if self.problem.friction is None:
            return [opens]
        if self.states[c] != STICKS:
            return [opens, falls(STICKS, lambda here: here["d"])]
        return [
            opens,
            falls(LEFT, lambda here: here["limit"] - here["T"]),
            falls(RIGHT, lambda here: here["limit"] + here["T"]),
        ]

    def motion(self, t, y):
        force = self.F - self.K0 @ y[:6]
        for c, T in enumerate(self.corners):
            here = self.corner(c, t, y)
            force = force + here["T"] * T[0] + here["N"] * T[1]
        return np.concatenate([y[6:], np.linalg.solve(self.M, force)])
