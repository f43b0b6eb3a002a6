"""Blocks and columns whose contacts open, slip or have dashpots, integrated by DOP853 that is restarted at its events.

A program of its own in floats and dense matrices: a block in (u, v, r, ex, ey, gxy) on two corners, on a base that may
move; a column in the displacements of its faces, those that are welded being one. It shares nothing with the exact
motions but the problem, and knows nothing of series or balls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from flint import arb
from scipy.integrate import solve_ivp

from fem_reference.events import column_drive as drives
from fem_reference.events.block_model import BlockProblem
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnProblem
from fem_reference.problem.motion import Motion

OPEN, STICKS, RIGHT, LEFT, RELEASED = 0, 1, 2, -2, 3


class Integration:
    """M x'' + C x' + K x = load(t, x') + T along + N across, from given states of the contacts.

    `rows` are those of the slide and the gap of each contact, (contacts, 2, unknowns), from which the place of the base
    counts; `base` gives this and its rate at an instant, which is on the piece of the course where `self.inside` is.
    """

    def __init__(self, M, K, load, rows, base, gap, normal, shear, **law):
        self.M, self.K, self.load, self.rows, self.base = M, K, load, rows, base
        self.gap, self.normal, self.shear = gap, normal, shear
        self.opens = law.get("opens", True)
        self.slips = law.get("slips", False)
        self.tangent = law.get("tangent", 0.0)
        self.cohesion = law.get("cohesion", np.zeros(len(rows)))
        self.damping = law.get("damping", 0.0)
        self.max_step = law.get("max_step", np.inf)
        self.references = np.zeros(len(rows))

    def contact(self, c, t, y):
        """Gap, slide, forces, reserves and the rate of dissipation of a contact; `P` is N as if it were closed."""
        n = len(self.M)
        at, speed = self.base(t)
        s, w = self.rows[c] @ y[:n] - at[c] + [0, self.gap[c]]
        ds, dw = self.rows[c] @ y[n:] - speed[c]
        state, sign = self.states[c], -np.sign(self.states[c])
        P = -self.normal[c] * w - self.damping * dw
        N = 0.0 if state in (OPEN, RELEASED) or not self.opens else P
        limit = self.tangent * N + self.cohesion[c]
        resting = {OPEN: 0.0, RELEASED: 0.0, STICKS: -self.shear[c] * (s - self.references[c])}
        T = resting[state] if state in resting else sign * limit
        here = {"w": w, "s": s, "dw": dw, "ds": ds, "P": P, "N": N, "T": T, "limit": limit}
        if self.slips:
            here["d"] = -sign * (ds - sign * self.tangent * self.normal[c] * dw / self.shear[c])
        return here

    def run(self, states, y, end, borders=()):
        """Return instants, contacts and new states of the switches, and the state vector at the end."""
        self.states = states
        t, found = 0.0, []
        for border in (*sorted(x for x in borders if 0 < x < end), end):
            self.inside = (t + border) / 2
            while t < border:
                t, y, switches = self.until(t, y, border)
                found += switches
        return found, y

    def until(self, t, y, end):
        found = []
        contacts = range(len(self.rows))
        for c in contacts:
            if abs(self.states[c]) == RIGHT and self.contact(c, t, y)["d"] < -1e-9:  # the base turned round
                found.append(self.switch(c, STICKS, t, y))
        events = [(c, *event) for c in contacts for event in self.events(c)]
        options = {"rtol": 1e-13, "atol": 1e-16, "max_step": self.max_step, "events": [event for *_, event in events]}
        done = solve_ivp(self.motion, (t, end), y, "DOP853", **options)
        t, y = float(done.t[-1]), done.y[:, -1]
        for (c, state, _), times in zip(events, done.t_events, strict=True):
            if len(times):
                released = self.states[c] == RELEASED and state == OPEN  # which changes no force
                switch = self.switch(c, state, t, y)
                found += [] if released else [switch]
        return t, y, found

    def reference(self, c, t, y):
        """Return where the shear force of a contact counts from."""
        here = self.contact(c, t, y)
        return here["s"] + (here["T"] / self.shear[c] if here["T"] else 0.0)

    def switch(self, c, state, t, y):
        here = self.contact(c, t, y)
        self.references[c] = self.reference(c, t, y)
        fast = self.shear[c] * abs(here["ds"]) > self.tangent * self.normal[c] * abs(here["dw"])
        if self.slips and state == STICKS and self.states[c] == OPEN and fast and not self.cohesion[c]:
            state = RIGHT if here["ds"] > 0 else LEFT
        self.states[c] = state
        return t, c, state

    def events(self, c):
        def falls(state, value):
            def event(t, y):
                return value(self.contact(c, t, y))

            event.terminal, event.direction = True, -1
            return state, event

        if self.states[c] == OPEN:
            return [falls(STICKS, lambda here: here["w"])]
        if self.states[c] == RELEASED:
            return [falls(OPEN, lambda here: -here["w"]), falls(STICKS, lambda here: -here["P"])]
        events = [falls(RELEASED if self.damping else OPEN, lambda here: here["N"])] if self.opens else []
        if self.slips and self.states[c] != STICKS:
            events.append(falls(STICKS, lambda here: here["d"]))
        elif self.slips:
            events.append(falls(LEFT, lambda here: here["limit"] - here["T"]))
            events.append(falls(RIGHT, lambda here: here["limit"] + here["T"]))
        return events

    def motion(self, t, y):
        n = len(self.M)
        force = self.load(t, y[n:]) - self.K @ y[:n]
        for c, (along, across) in enumerate(self.rows):
            here = self.contact(c, t, y)
            force = force + here["T"] * along + here["N"] * across
        return np.concatenate([y[n:], np.linalg.solve(self.M, force)])


# ---- blocks ----


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


def T(x, y):
    return np.array([[1, 0, -y, x, 0, y / 2], [0, 1, x, 0, y, x / 2]])


def integrated_block(problem, states, end):
    """Return (instant, corner, new state) of each switch of a block, and its state vector at the end."""
    q = problem
    x, weight = np.polynomial.legendre.leggauss(3)
    X, Y = (z.ravel() * side / 2 for z, side in zip(np.meshgrid(x, x), (q.width, q.height), strict=True))
    area = np.outer(weight, weight).ravel() * q.width * q.height / 4
    M = sum(q.density * w * row.T @ row for w, row in zip(area, map(T, X, Y), strict=True))
    E, mu = q.young, q.poisson
    lame = E * mu / ((1 + mu) * (1 - 2 * mu)) if q.hypothesis == "plane strain" else E * mu / (1 - mu**2)
    G = E / (2 * (1 + mu))
    K = np.zeros((6, 6))
    K[3:, 3:] = q.width * q.height * np.array([[lame + 2 * G, lame, 0], [lame, lame + 2 * G, 0], [0, 0, G]])
    middle = T(q.eccentricity, q.height / 2)[1] * (q.width - 2 * abs(q.eccentricity))
    F = -q.pressure * middle + q.traction * q.width * T(0, q.height / 2)[0]
    slope = math.radians(q.slope)
    weight = q.density * q.width * q.height * q.gravity
    F += weight * np.array([math.sin(slope), -math.cos(slope)]) @ T(0, 0)
    record = np.zeros((3, 2)) if q.base is None else np.array([q.base.time, q.base.x, q.base.y])

    def base(t):
        if q.base is None:
            return np.zeros((2, 2, 2))
        i = min(max(int(np.searchsorted(record[0], block.inside)) - 1, 0), record.shape[1] - 2)
        speed = (record[1:, i + 1] - record[1:, i]) / (record[0, i + 1] - record[0, i])
        return np.array([[record[1:, i] + speed * (t - record[0, i])] * 2, [speed] * 2])

    pair = np.ones(2)
    block = Integration(
        *(M, K, lambda t, v: F, np.array([T(side * q.width / 2, -q.height / 2) for side in (-1, 1)]), base),
        *(q.gap * pair, q.stiffness * pair, q.shear_stiffness * pair),
        slips=q.friction is not None,
        tangent=math.tan(math.radians(q.friction or 0.0)),
        cohesion=q.cohesion * q.width / 2 * pair,
        damping=q.damping,
    )
    y = np.zeros(12)
    y[7] = q.velocity
    found, y = block.run(states, y, end, record[0])
    return [(t, "MN"[c], state) for t, c, state in found], y


# ---- columns ----


@dataclass(frozen=True)
class IntegratedColumn:
    """What DOP853 gives."""

    switches: list[tuple[str, float]]  # joint with the letter of its kind, and instant [s]
    displacement: np.ndarray  # mean of the faces of each block at the end [m]
    slip: np.ndarray  # reference of each joint [m]


def value_of(drive):
    """A drive and its derivatives at an instant in floats."""
    course = drive()

    def value(t, order):
        piece = course.piece_at(t)
        return float(piece.series(arb(t), 1.0, 3)[order]) * math.factorial(order)

    return value


class Assembly:
    """Matrices of the faces of a column's blocks, those that move alike being one unknown."""

    def __init__(self, problem):
        blocks = problem.blocks
        welded = [i > 0 and joint is None for i, joint in enumerate(problem.joints)]
        elastic = [math.isfinite(block.modulus) for block in blocks]
        moves = np.column_stack([np.logical_not(welded), elastic]).ravel()  # other than the face below
        self.P = P = np.eye(np.sum(moves))[np.cumsum(moves) - 1]
        masses = np.array([block.density * block.height for block in blocks])
        springs = [block.modulus / block.height if soft else 0.0 for block, soft in zip(blocks, elastic, strict=True)]
        self.M = P.T @ np.kron(np.diag(masses / 6), [[2, 1], [1, 2]]) @ P
        self.K = P.T @ np.kron(np.diag(springs), [[1, -1], [-1, 1]]) @ P
        self.weight = -P.T @ np.repeat(masses * problem.gravity / 2, 2)
        self.C = np.zeros_like(self.M)
        self.C[0, 0] = problem.impedance if problem.base == "transmitting" else 0.0
        known = {j: joint for j, joint in enumerate(problem.joints) if joint is not None}
        self.joints = list(known)
        self.B = np.array([P[2 * j] - (P[2 * j - 1] if j else 0.0) for j in known]).reshape(-1, len(self.M))
        self.on_base = np.array([j == 0 for j in known])
        self.stiffness = np.array([joint.stiffness for joint in known.values()])
        self.gap = np.array([joint.gap for joint in known.values()])
        self.strength = np.array([np.inf if joint.strength is None else joint.strength for joint in known.values()])
        self.bottom = P[0]
        self.top = P[-1]
        self.velocity = np.array([blocks[face // 2].velocity for face in np.flatnonzero(moves)])


def integrated_column(problem, end):
    """Integrate a column whose lowest block stands on a spring, a half-space or nothing, from t = 0."""
    form = Assembly(problem)
    B, k, joints = form.B, form.stiffness, form.joints
    base, pressure = value_of(problem.base_motion), value_of(problem.pressure)
    unilateral = problem.law == "unilateral"
    way = int(unilateral)  # of a joint's row: along or across
    rows = np.zeros((len(B), 2, len(form.M)))
    rows[:, way] = B
    frequencies = np.linalg.eigvals(np.linalg.solve(form.M, form.K + B.T @ (k[:, None] * B)))

    def place(t):
        at = np.zeros((2, len(B), 2))
        at[:, :, way] = np.outer([base(t, 0), base(t, 1)], form.on_base)
        return at

    def load(t, v):
        wave = 2 * problem.impedance * base(t, 1) if problem.base == "transmitting" else 0.0
        return form.weight - form.C @ v - form.top * pressure(t, 0) + form.bottom * wave

    column = Integration(
        *(form.M, form.K, load, rows, place, form.gap, k, 0 * k if unilateral else k),
        opens=unilateral,
        slips=not unilateral,
        cohesion=form.strength,
        max_step=0.15 / math.sqrt(np.abs(frequencies).max()),
    )
    u = np.zeros(len(form.M))
    if problem.at_rest:
        known = k * (form.on_base * base(0.0, 0) - form.gap)
        u = np.linalg.solve(form.K + B.T @ (k[:, None] * B), form.weight + B.T @ known)
    closed = B @ u - form.on_base * base(0.0, 0) + form.gap <= 0
    states = [STICKS if shut or not unilateral else OPEN for shut in closed]
    breaks = {b for drive in (problem.base_motion, problem.pressure) for b in drive().breaks}
    found, y = column.run(states, np.concatenate([u, form.velocity]), end, breaks)
    letters = {OPEN: "O", STICKS: "C" if unilateral else "K", RIGHT: "+", LEFT: "-"}
    slip = np.zeros(len(problem.blocks))
    slip[joints] = [column.reference(c, end, y) for c in range(len(joints))]
    faces = form.P @ y[: len(form.M)]
    switches = [(f"{joints[c]}{letters[state]}", t) for t, c, state in found]
    return IntegratedColumn(switches, (faces[::2] + faces[1::2]) / 2, slip)


def random_column(seed):
    """A column of two to four blocks, rigid or elastic, some of them welded, and the end of its motion [s]."""
    random = np.random.default_rng(seed)
    count = int(random.integers(2, 5))
    law = ("unilateral", "frictional")[seed % 2]
    base = ("rigid", "transmitting", "free")[int(random.integers(3))]
    speed = -random.uniform(0.2, 2.0)
    welded = [bool(i and random.random() < 0.25) for i in range(count)]
    if all(welded[1:]):
        welded[1] = False
    blocks, joints = [], []
    for i in range(count):
        modulus = math.inf if random.random() < 0.4 else float(10 ** random.uniform(8, 9.3))
        if not welded[i]:
            speed = float(random.normal()) if law == "unilateral" else float(random.normal() * 0.3)
        blocks.append(ColumnBlock(random.uniform(0.4, 2.0), random.uniform(1800.0, 2800.0), modulus, speed))
        joint = None
        if not welded[i] and (i or base == "rigid"):
            k = float(10 ** random.uniform(8.3, 9.5))
            gap = float(random.uniform(0, 1e-3)) if law == "unilateral" else 0.0
            strength = float(10 ** random.uniform(4, 5.3)) if law == "frictional" else None
            joint = ColumnJoint(k, gap, strength)
        joints.append(joint)
    motion = drives.still if base == "free" else drives.integrated(drives.sine(0.3, 20.0, quarters=int(seed % 3 == 0)))
    if base == "transmitting":
        motion = drives.integrated(drives.ricker(0.5, 60.0))
    pressure = drives.half_sine(float(random.uniform(0, 1e6)), 0.006)
    problem = ColumnProblem(
        tuple(blocks),
        tuple(joints),
        law,
        base,
        4e6 if base == "transmitting" else 0.0,
        9.81 if law == "unilateral" and base != "transmitting" else 0.0,
        base_motion=motion,
        pressure=pressure,
    )
    return problem, 0.04
