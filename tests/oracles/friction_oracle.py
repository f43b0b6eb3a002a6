"""Blocks with friction on a base that may move, integrated by DOP853 with events: a program of its own in floats."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from oracles.block_oracle import Integrated, random_problem

from fem_reference.events.block_model import BlockProblem
from fem_reference.problem.motion import Motion

OPEN, STICKS, RIGHT, LEFT = 0, 1, 2, -2
Array = NDArray[np.float64]


def slipping_problem(seed: int, moved: bool = False) -> BlockProblem:
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


class Slipping(Integrated):
    """The block of `Integrated` with Coulomb's friction in its corners."""

    def __init__(self, problem: BlockProblem, longest: float = math.inf) -> None:
        super().__init__(problem)
        q = self.problem
        self.tan = math.tan(math.radians(q.friction or 0.0))
        self.C = q.cohesion * q.width / 2
        turn = math.radians(q.slope)
        weight = q.density * q.width * q.height * q.gravity
        self.F += weight * (math.sin(turn) * self.T(0, 0)[0] + (1 - math.cos(turn)) * self.T(0, 0)[1])
        self.states, self.references = [OPEN, OPEN], [0.0, 0.0]
        self.longest = longest  # a step that is longer may jump over two events

    def base(self, t: float) -> tuple[Array, Array]:
        if self.problem.base is None:
            return np.zeros(2), np.zeros(2)
        rows = np.array([self.problem.base.time, self.problem.base.x, self.problem.base.y])
        i = min(max(int(np.searchsorted(rows[0], self.inside)) - 1, 0), rows.shape[1] - 2)
        speed = (rows[1:, i + 1] - rows[1:, i]) / (rows[0, i + 1] - rows[0, i])
        return rows[1:, i] + speed * (t - rows[0, i]), speed

    def corner(self, c: int, t: float, y: Array) -> dict[str, float]:
        """Gap, slide, forces, reserves and the rate of dissipation of a corner."""
        q, (at, speed) = self.problem, self.base(t)
        s, w = self.corners[c] @ y[:6] - at + [0, q.gap]
        ds, dw = self.corners[c] @ y[6:] - speed
        state, sign = self.states[c], -np.sign(self.states[c])
        N = -q.stiffness * w if state else 0.0
        limit = self.tan * N + self.C
        T = {OPEN: 0.0, STICKS: -q.shear_stiffness * (s - self.references[c])}.get(state, sign * limit)
        moved = ds - sign * self.tan * q.stiffness * dw / q.shear_stiffness
        return {"w": w, "s": s, "dw": dw, "ds": ds, "N": N, "T": T, "limit": limit, "d": -sign * moved}

    def run(self, states: list[int], end: float) -> tuple[list[tuple[float, str, int]], Array]:
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

    def until(self, t: float, y: Array, end: float) -> tuple[float, Array, list[tuple[float, str, int]]]:
        from scipy.integrate import solve_ivp

        found = []
        for c in (0, 1):
            if abs(self.states[c]) == RIGHT and self.corner(c, t, y)["d"] < -1e-9:  # the base turned round
                found.append(self.switch(c, STICKS, t, y))
        events = [(c, *event) for c in (0, 1) for event in self.events(c)]
        options = {"rtol": 1e-13, "atol": 1e-16, "max_step": self.longest, "events": [event for _, _, event in events]}
        done = solve_ivp(self.motion, (t, end), y, "DOP853", **options)
        t, y = float(done.t[-1]), done.y[:, -1]
        for (c, state, _), times in zip(events, done.t_events, strict=True):
            if len(times):
                found.append(self.switch(c, state, t, y))
        return t, y, found

    def switch(self, c: int, state: int, t: float, y: Array) -> tuple[float, str, int]:
        here = self.corner(c, t, y)
        q = self.problem
        self.references[c] = here["s"] + here["T"] / q.shear_stiffness
        fast = q.shear_stiffness * abs(here["ds"]) > self.tan * q.stiffness * abs(here["dw"])
        if state == STICKS and self.states[c] == OPEN and fast and not self.C:
            state = RIGHT if here["ds"] > 0 else LEFT
        self.states[c] = state
        return t, "MN"[c], state

    def events(self, c: int):
        def falls(state, value):
            def event(t, y):
                return value(self.corner(c, t, y))

            event.terminal, event.direction = True, -1
            return state, event

        if self.states[c] == OPEN:
            return [falls(STICKS, lambda here: here["w"])]
        opens = falls(OPEN, lambda here: here["N"])
        if self.states[c] != STICKS:
            return [opens, falls(STICKS, lambda here: here["d"])]
        return [
            opens,
            falls(LEFT, lambda here: here["limit"] - here["T"]),
            falls(RIGHT, lambda here: here["limit"] + here["T"]),
        ]

    def motion(self, t: float, y: Array) -> Array:
        force = self.F - self.K0 @ y[:6]
        for c, T in enumerate(self.corners):
            here = self.corner(c, t, y)
            force = force + here["T"] * T[0] + here["N"] * T[1]
        return np.concatenate([y[6:], np.linalg.solve(self.M, force)])
