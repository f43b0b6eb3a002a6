"""A plain DDA code of one block, as someone writes it from the paper in an afternoon, with the slips that one makes.

Six unknowns (u, v, r, ex, ey, gxy) about the centroid, two corner springs, textbook recursion (increments of the
displacement, stress and spring stretch summed up), dense solves for the acceleration; the geometry may move with the
block, and a base of its own mass and springs may yield. It shares no line with the suite's own models. Corners that
may slip do so by one of two laws, Coulomb's with a reference for the shear:

consistent
    All states, stick and slip included, agree with the motion that they give; if passing does not end, all are tried.
lagged
    As other programs do it: a pass is repeated only where a corner opens or closes (beyond dead bands), the friction of
    a slipping corner is that of the pass before, or of the step before, and a corner that slips forgets its shear: it
    sticks again from where the step began in which it turned round.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

HEADER = "\n% Timestep, currenttime, deltat, xpos, ypos, dcum, vx, vy, v\n\nmeaspoint1=[\n"
OPEN, STICK = 0, 1  # slip is +2 or -2, the sign of the force
PASSES, AGREES = 6, 1e-15  # before all states are tried; m, of a crossing


@dataclass(frozen=True)
class Plain:
    """A run; the first lines are the scene, the others what was done wrong."""

    dt: float = 0.002
    steps: int = 100
    side: float = 2.0
    height: float | None = None  # the side, if none is given
    rho: float = 2700.0
    E: float = 1e9
    mu: float = 0.0
    strain: bool = False
    p: float = 1e9
    ps: float | None = None  # springs along the base, if other ones
    q: float = 5e6
    eccentricity: float = 0.0
    force: tuple[float, float] = (0.0, 0.0)  # N at the centroid
    g: float = 0.0
    slope: float = 0.0  # deg
    alpha: float = 0.5
    delta: float = 1.0
    gg: float = 1.0
    consistent: bool = False  # start
    phi: float | None = None  # deg; corners slip by the consistent law
    cohesion: float = 0.0  # N a corner
    lagged: bool = False  # or by the other one
    base: tuple[float, float] | None = None  # a base that yields: its mass over the block's, its springs [N/m]

    updated: bool = False  # all matrices are those of the moved corners
    formulas: str = "both"  # in which gg stands
    point: float = 0.0  # height of the reported point over h/2
    late: int = 0  # steps that the pressure is late
    averaged: bool = False  # pressure of two steps
    row_sign: float = 1.0  # of the load in the row of ey
    coupling: float = 1.0  # of v and ey by the springs
    keeps_stress: bool = True
    opens: bool = False
    band: float = 0.0  # m, of an open corner that closes
    opening_band: float = 0.0  # m, of a closed one that opens
    tension: float = 0.0  # N a corner, that a closed contact bears
    lags: str = ""  # "opening" or "switching": by the gap at the start of the step
    pressure_times: float = 1.0
    displacement_times: float = 1.0

    # what no catalogue holds
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


SLIDER = Plain(q=0.0, ps=4e8, dt=1e-3, phi=30.0)


@dataclass(frozen=True)
class History:
    """What a run gives at each step."""

    time: np.ndarray
    displacement: np.ndarray
    pressure: np.ndarray
    sideways: np.ndarray
    open: np.ndarray  # both corners open at the end of the step

    @property
    def opened(self):
        """The first and the last step with open corners."""
        steps = np.flatnonzero(self.open) + 1
        return (int(steps[0]), int(steps[-1])) if len(steps) else None


@dataclass(frozen=True)
class End:
    """The end of a step for given states."""

    acceleration: np.ndarray
    moved: np.ndarray  # what is added to the displacements
    gap: np.ndarray  # of both corners
    slide: np.ndarray  # what is added along the base
    stretch: np.ndarray  # along the base, from the references


def run(P):
    """Return displacement and contact pressure of every step."""
    found = history(P)
    return found.displacement, found.pressure


def matrices(P, a, h):
    """Return mass, stiffness, load, weight, and rows of both corners (corners, along and across, unknowns)."""
    n = 6 if P.base is None else 8  # displacements of the base, which gaps and slides count from
    S, s1, s2 = a * h, h * a**3 / 12, a * h**3 / 12
    M = P.rho * np.diag([S, S, s1 + s2, s1, s2, (s1 + s2) / 4, 0, 0])[:n, :n]
    M[2, 5] = M[5, 2] = P.rho * (s1 - s2) / 2
    E, mu = (P.E / (1 - P.mu**2), P.mu / (1 - P.mu)) if P.strain else (P.E, P.mu)
    elastic = np.zeros((n, n))
    elastic[3:6, 3:6] = S * E / (1 - mu**2) * np.array([[1, mu, 0], [mu, 1, 0], [0, 0, (1 - mu) / 2]])
    for i in range(6, n):
        M[i, i] = P.base[0] * P.rho * P.side * (P.height or P.side)
        elastic[i, i] = P.base[1]

    def T(x, y):
        return np.array([[1, 0, -y, x, 0, y / 2, -1, 0], [0, 1, x, 0, y, x / 2, 0, -1]])[:, :n]

    load = -P.q * (P.side - 2 * abs(P.eccentricity)) * T(P.eccentricity, h / 2)[1]
    load[6:] = 0.0
    load[4] *= P.row_sign
    slope = math.radians(P.slope)
    weight = np.zeros(n)
    weight[:2] = np.array(P.force) + P.rho * S * P.g * np.array([math.sin(slope), -math.cos(slope)])
    return M, elastic, load, weight, np.array([T(-a / 2, -h / 2), T(a / 2, -h / 2)])


def history(P):
    """Return the history of a run."""
    a, h = P.side, P.height or P.side
    M, elastic, load, weight, corners = matrices(P, a, h)
    along, across = corners[:, 0], corners[:, 1]
    rng = np.random.default_rng(P.seed)
    shear = P.p if P.ps is None else P.ps
    e = P.alpha * P.dt**2
    tangent = math.tan(math.radians(P.phi or 0.0))
    law = open_close if P.phi is None else lagged if P.lagged else consistent
    force_of_strain, gap, stretch = np.zeros(3), np.zeros(2), np.zeros(2)
    V, A, total = np.zeros((3, len(M)))
    states = (STICK, STICK)
    if P.consistent:
        A = np.linalg.solve(M, load + weight)
    rows = []

    def trial(states, stretch, known=None):
        """Return the end of the step that the loop below is in; friction may be that of known normal forces."""
        K, F = elastic.copy(), outer.copy()
        for c, state in enumerate(states):
            if state == OPEN:
                continue
            k = normal[c] * np.outer(across[c], across[c])
            k[[1, 4], [4, 1]] *= P.coupling
            back = k @ total if P.coupling != 1 else normal[c] * gap[c] * across[c]
            if state == STICK:
                k += shear * np.outer(along[c], along[c])
                back = back + shear * stretch[c] * along[c]
            else:
                sign = math.copysign(1, state)
                F += sign * P.cohesion * along[c]
                if known is None:
                    k += sign * tangent * P.p * np.outer(along[c], across[c])
                    back = back + sign * tangent * P.p * gap[c] * along[c]
                else:
                    F += sign * tangent * known[c] * along[c]
            K += k
            F -= back
        C = P.viscous * M + P.structural * K
        K *= 1 + P.hht
        # M a + C (later + dt delta a) + (1 + hht) K (star + alpha dt^2 a) = F
        new = np.linalg.solve(M + P.dt * P.delta * C + e * K, F - C @ later - K @ star)
        moved = star + e * new
        return End(new, moved, gap + across @ moved, along @ moved, stretch + along @ moved)

    for n in range(P.steps):
        share = min(1.0, (n + 1) * P.dt / P.ramp) if P.ramp else 1.0
        share *= 1 + P.shaken * rng.standard_normal()
        one = P.gg if P.formulas != "velocity" else 1.0
        two = P.gg if P.formulas != "displacement" else 1.0
        outer = share * load + weight
        outer[3:6] -= P.keeps_stress * force_of_strain
        outer[6:] -= elastic[6:, 6:] @ total[6:]
        outer[1] -= P.friction * np.tanh(V[1] / 0.01)
        star = one * P.dt * V + P.dt**2 * (0.5 - P.alpha) * A
        later = two * V + P.dt * (1 - P.delta) * A
        normal = P.p * (1 + P.hardening * np.abs(gap))
        end, states, stretch = law(P, trial, states, gap, stretch, (tangent, shear))
        V = later + P.dt * P.delta * end.acceleration
        A = end.acceleration
        total = total + end.moved
        gap = end.gap
        force_of_strain = (force_of_strain + elastic[3:6, 3:6] @ end.moved[3:6]) * (1 - P.creep * P.dt)
        closed = np.array(states) != OPEN
        push = -P.p * (1 + P.hardening * np.abs(gap)) * gap
        rows.append((total[1] + P.point * h / 2 * total[4], np.sum(push[closed]) / P.side, total[0], not any(closed)))
        if P.updated:
            size = a * h
            a, h = a * (1 + end.moved[3]), h * (1 + end.moved[4])
            force_of_strain *= a * h / size
            M, elastic, load, weight, corners = matrices(P, a, h)
            along, across = corners[:, 0], corners[:, 1]
    displacement, pressure, sideways, opened = np.array(rows).T
    if P.averaged:
        pressure = (pressure + np.append(0.0, pressure[:-1])) / 2
    if P.late:
        pressure = np.append(np.zeros(P.late), pressure[: -P.late])
    for values in (displacement, pressure):
        for n in range(1, len(values)) if P.filtered else ():
            values[n] = P.filtered * values[n - 1] + (1 - P.filtered) * values[n]
    time = P.dt * np.arange(1, P.steps + 1)
    return History(time, P.displacement_times * displacement, P.pressure_times * pressure, sideways, opened > 0)


# ---- laws of the corners: the end of a step, its states and stretches ----------------------------------------------


def open_close(P, trial, states, gap, stretch, law):
    """Corners stick, and open if they may."""
    if P.lags:
        holds = [gap[c] <= 0 if states[c] else P.lags == "switching" and gap[c] < 0 for c in (0, 1)]
        states = tuple(map(int, holds))
    for _ in range(8):
        end = trial(states, stretch)
        reach = [P.opening_band + P.tension / P.p if closed else -P.band for closed in states]
        new = tuple(int(not P.opens or end.gap[c] < reach[c]) for c in (0, 1))
        if P.lags:
            new = states if P.lags == "switching" else tuple(map(max, states, new))
        if new == states:
            break
        states = new
    return end, states, np.where(states, end.stretch, 0.0)


def consistent(P, trial, states, gap, stretch, law):
    """States that agree with the motion that they give."""
    queue = itertools.chain([states], [None] * (PASSES - 1), itertools.product((STICK, 2, -2, OPEN), repeat=2))
    found = None
    for candidate in queue:
        states = candidate or found
        end = trial(states, stretch)
        start = stretch
        for _ in range(60):  # the crossing depends on the step's end
            touching = (gap > 0) & (end.gap < 0)
            crossing = np.where(touching, gap / np.where(touching, gap - end.gap, 1.0), 0.0)
            moved = np.where(touching, -crossing * end.slide, stretch)
            if np.max(np.abs(moved - start)) <= AGREES:
                break
            start = moved
            end = trial(states, start)
        found = requested(P, end, states, law)
        if found == states:
            break
    else:
        end = trial(found, start)
    tangent, shear = law
    limit = tangent * -P.p * end.gap + P.cohesion
    slipping = np.sign(found) * (np.abs(found) == 2)
    held = np.where(np.array(found) == STICK, end.stretch, 0.0)
    return end, found, np.where(slipping, -slipping * limit / shear, held)


def requested(P, end, states, law):
    """Return the states that the end of a step asks for."""
    tangent, shear = law
    found = []
    for c, state in enumerate(states):
        cap = tangent * max(0.0, -P.p * end.gap[c]) + P.cohesion
        pull = -shear * end.stretch[c]
        if end.gap[c] > 0:
            found.append(OPEN)
        elif abs(state) == 2:
            found.append(state if state * pull >= abs(state) * cap else STICK)
        else:
            found.append(STICK if abs(pull) <= cap else int(math.copysign(2, pull)))
    return tuple(found)


def lagged(P, trial, states, gap, stretch, law):
    """Friction of the pass before; a pass more only where a corner opens or closes."""
    tangent, shear = law
    known = np.maximum(0.0, -P.p * gap)
    for _ in range(PASSES):
        end = trial(states, stretch, known)
        found, start = [], stretch.copy()
        for c, state in enumerate(states):
            pull = -shear * end.stretch[c]
            cap = tangent * max(0.0, -P.p * end.gap[c]) + P.cohesion
            if end.gap[c] > P.opening_band or (state == OPEN and end.gap[c] >= -P.band):
                found.append(OPEN)
            elif state == OPEN:
                found.append(STICK)
                start[c] = -end.slide[c] * (gap[c] / (gap[c] - end.gap[c]) if gap[c] > 0 else 0.0)
            elif state == STICK:
                found.append(STICK if abs(pull) <= cap else int(math.copysign(2, pull)))
            else:
                found.append(state if state * end.slide[c] <= 0 else STICK)
        if [state == OPEN for state in found] == [state == OPEN for state in states]:
            break
        states, stretch, known = tuple(found), start, np.maximum(0.0, -P.p * end.gap)
    sticks = np.array(found) == STICK
    forgets = np.abs(states) == 2  # it has turned round within this step
    return end, tuple(found), np.where(sticks, end.slide + np.where(forgets, 0.0, stretch), 0.0)


def write_measured_point(history, path, dt):
    """Write the file that ntdda writes: seven digits, an unsigned displacement, step velocities."""
    steps = np.diff(history.displacement, prepend=0.0)
    lines = [
        f"{n + 1:10d} {t:20e} {dt:20e} {5.0:20e} {3 + d:20e} {abs(d):20e} {0.0:20e} {s / dt:20e} {abs(s / dt):20e}\n"
        for n, (t, d, s) in enumerate(zip(history.time, history.displacement, steps, strict=True))
    ]
    path.write_text(HEADER + "".join(lines) + "];\n")
    return path
