"""A column whose contacts open or slip, integrated by DOP853 that is restarted at its events.

It assembles dense matrices of faces, ties welded faces by constraints, and knows nothing of series or balls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from flint import arb
from scipy.integrate import solve_ivp

from fem_reference.events import column_drive as drives
from fem_reference.events.column_model import ColumnBlock, ColumnJoint, ColumnProblem

TOLERANCE = 1e-12


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
        n = len(problem.blocks)
        M = np.zeros((2 * n, 2 * n))
        K = np.zeros((2 * n, 2 * n))
        weight = np.zeros(2 * n)
        columns = []  # faces that move alike
        for i, block in enumerate(problem.blocks):
            m = block.density * block.height
            faces = [2 * i, 2 * i + 1]
            M[np.ix_(faces, faces)] += m / 6 * np.array([[2, 1], [1, 2]])
            weight[faces] -= m * problem.gravity / 2
            if math.isfinite(block.modulus):
                K[np.ix_(faces, faces)] += block.modulus / block.height * np.array([[1, -1], [-1, 1]])
            if problem.joints[i] is None and i:
                columns[-1].append(2 * i)
            else:
                columns.append([2 * i])
            if math.isfinite(block.modulus):
                columns.append([2 * i + 1])
            else:
                columns[-1].append(2 * i + 1)
        P = np.zeros((2 * n, len(columns)))
        for j, faces in enumerate(columns):
            P[faces, j] = 1.0
        self.P = P
        self.M = P.T @ M @ P
        self.K = P.T @ K @ P
        self.weight = P.T @ weight
        self.C = np.zeros_like(self.M)
        self.C[0, 0] = problem.impedance if problem.base == "transmitting" else 0.0
        self.joints = [j for j, joint in enumerate(problem.joints) if joint is not None]
        B = np.zeros((len(self.joints), 2 * n))
        for row, j in zip(B, self.joints, strict=True):
            row[2 * j] = 1.0
            if j:
                row[2 * j - 1] = -1.0
        self.B = B @ P
        self.on_base = np.array([j == 0 for j in self.joints])
        known = [joint for joint in problem.joints if joint is not None]
        self.stiffness = np.array([joint.stiffness for joint in known])
        self.gap = np.array([joint.gap for joint in known])
        self.strength = np.array([np.inf if joint.strength is None else joint.strength for joint in known])
        self.bottom = P[0]
        self.top = P[2 * n - 1]
        self.velocity = np.array([problem.blocks[faces[0] // 2].velocity for faces in columns])


def integrated(problem, end):
    """Integrate a column whose lowest block stands on a spring, a half-space or nothing, from t = 0."""
    n = len(problem.blocks)
    form = Assembly(problem)
    M, K, C, B, P = form.M, form.K, form.C, form.B, form.P
    k, gap, s, joints, weight = form.stiffness, form.gap, form.strength, form.joints, form.weight
    inverse = np.linalg.inv(M)
    finite = np.where(np.isfinite(s), s, 0.0)
    base, pressure = value_of(problem.base_motion), value_of(problem.pressure)
    size = len(M)
    unilateral = problem.law == "unilateral"

    def stretch(t, x, order=0):
        part = B @ x[order * size : (order + 1) * size] - form.on_base * base(t, order)
        return part + gap if order == 0 else part

    u = np.zeros(size)
    if problem.at_rest:
        u = np.linalg.solve(K + B.T @ (k[:, None] * B), weight + B.T @ (k * (form.on_base * base(0.0, 0) - gap)))
    x = np.concatenate([u, form.velocity])
    states = np.where(stretch(0.0, x) <= 0, 1, 0) if unilateral else np.ones(len(joints), dtype=int)
    references = np.zeros(len(joints))
    switches = []
    fastest = math.sqrt(np.abs(np.linalg.eigvals(inverse @ (K + B.T @ (k[:, None] * B)))).max())
    breaks = {b for drive in (problem.base_motion, problem.pressure) for b in drive().breaks if 0 < b < end}
    now = 0.0

    def forces(t, x):
        sticking = -k * (stretch(t, x) - references)
        return np.where(states == 1, sticking, -np.sign(states) * np.where(states == 0, 0.0, finite))

    def rates(t, x):
        f = weight + B.T @ forces(t, x) - K @ x[:size] - C @ x[size:] - form.top * pressure(t, 0)
        if problem.base == "transmitting":
            f = f + form.bottom * 2 * problem.impedance * base(t, 1)
        return np.concatenate([x[size:], inverse @ f])

    def watch(c, sign):
        def function(t, x):
            if unilateral:
                return float(stretch(t, x)[c])
            if states[c] == 1:
                return float(s[c] + sign * k[c] * (references[c] - stretch(t, x)[c]))
            return float(np.sign(states[c]) * stretch(t, x, 1)[c])

        function.terminal = True
        function.direction = (-1 if states[c] == 0 else 1) if unilateral else -1
        return function

    for border in (*sorted(breaks), end):
        while now < border:
            events, labels = [], []
            for c in range(len(joints)):
                for sign in (1, -1):
                    if np.isfinite(s[c]) or (unilateral and sign > 0):
                        events.append(watch(c, sign))
                        labels.append((c, sign))
            solution = solve_ivp(
                rates, (now, border), x, "DOP853", rtol=TOLERANCE, atol=1e-16, max_step=0.15 / fastest, events=events
            )
            now, x = float(solution.t[-1]), solution.y[:, -1]
            if solution.status != 1:
                now = border
                break
            for (c, sign), times in zip(labels, solution.t_events, strict=True):
                if not len(times) or (states[c] in (2, -2) and sign < 0):
                    continue
                if unilateral:
                    states[c] = 1 - states[c]
                    switches.append((f"{joints[c]}{'OC'[states[c]]}", now))
                elif states[c] == 1:
                    states[c] = 2 * sign
                    switches.append((f"{joints[c]}{'+' if sign > 0 else '-'}", now))
                else:
                    references[c] = stretch(now, x)[c] - np.sign(states[c]) * s[c] / k[c]
                    states[c] = 1
                    switches.append((f"{joints[c]}K", now))
    slip = np.zeros(n)
    slipping = np.abs(states) == 2
    references = np.where(slipping, stretch(now, x) - np.sign(states) * finite / k, references)
    slip[joints] = references
    faces = P @ x[:size]
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
