"""Schemes by their stages on one mode: the map of a step, its roots, and what an impact on a spring becomes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from validation.runs.history import Array

PHASES = 200
FLIGHT = 80


@dataclass(frozen=True)
class Stage:
    """One solve of a step."""

    d_u: float
    d_g: float
    e_0: float
    e_g: float
    beta: float
    g_0: float
    g_g: float
    gamma: float
    am: float = 0.0
    af: float = 0.0


def newmark(alpha: float, delta: float) -> tuple[Stage, ...]:
    return (Stage(1, 0, 0.5 - alpha, 0, alpha, 1 - delta, 0, delta),)


def generalised_alpha(am: float, af: float) -> tuple[Stage, ...]:
    gamma = 0.5 - am + af
    beta = (1 - am + af) ** 2 / 4
    return (Stage(1, 0, 0.5 - beta, 0, beta, 1 - gamma, 0, gamma, am, af),)


def named(name: str, r: float = 0.0, split: float | None = None) -> tuple[Stage, ...]:
    if name == "chung-hulbert":
        return generalised_alpha((2 * r - 1) / (r + 1), r / (r + 1))
    if name == "hht":
        return generalised_alpha(0.0, (1 - r) / (1 + r))
    if name == "wbz":
        return generalised_alpha((r - 1) / (r + 1), 0.0)
    if name == "leapfrog":
        return (Stage(1, 0, 1, 0, 0, 1, 0, 0),)
    g = split
    if g is None:
        g = 0.5 if r == 1 else (2 - math.sqrt(2 + 2 * r)) / (1 - r)
    q1 = (r + 1) / (2 * g * (r - 1) + 4)
    q0 = (g - 1) * q1 + 0.5
    q2 = 0.5 - g * q1
    first = Stage(g, 0, g * g / 4, 0, g * g / 4, g / 2, 0, g / 2)
    return (first, Stage(q0 + q2, q1, q2 * q0, q2 * q1, q2 * q2, q0, q1, q2))


def matrix(stages: tuple[Stage, ...], omega: float, gg: float = 1.0) -> Array:
    """Map (x, v, a) -> (x1, v1, a1), dt = 1."""
    W2 = omega**2
    start = np.eye(3)
    x, v, a = start[0], gg * start[1], start[2]
    zero = np.zeros(3)
    x1, v1, a1 = zero, zero, zero
    vg, ag = zero, zero
    for s in stages:
        xs = x + s.d_u * v + s.d_g * vg + s.e_0 * a + s.e_g * ag
        a1 = (-W2 * (1 - s.af) * xs - W2 * s.af * x - s.am * a) / ((1 - s.am) + (1 - s.af) * W2 * s.beta)
        x1 = xs + s.beta * a1
        v1 = v + s.g_0 * a + s.g_g * ag + s.gamma * a1
        vg, ag = v1, a1
    return np.array([x1, v1, a1])


def rebounds(stages: tuple[Stage, ...], omega: float, gg: float = 1.0, phases: int = PHASES) -> Array:
    W2 = omega**2
    x = (np.arange(phases) + 0.5) / phases * gg
    v = np.full(phases, -1.0)
    a = np.zeros(phases)
    N = np.zeros(phases)
    touched = np.zeros(phases, bool)
    left = np.full(phases, -1)
    for _ in range(100000):
        u = gg * v
        vg = ag = np.zeros(phases)
        x1, v1, a1, N1 = x, v, a, N
        for s in stages:
            xs = x + s.d_u * u + s.d_g * vg + s.e_0 * a + s.e_g * ag
            known = (s.af * N - s.am * a) / (1 - s.am)
            free = xs + s.beta * known
            share = (1 - s.af) / (1 - s.am)
            N1 = np.where(free < 0, -W2 * free / (1 + s.beta * share * W2), 0.0)
            a1 = known + share * N1
            x1 = xs + s.beta * a1
            v1 = u + s.g_0 * a + s.g_g * ag + s.gamma * a1
            touched |= free < 0
            vg, ag = v1, a1
        x, v, a, N = x1, v1, a1, N1
        flying = touched & (N == 0) & (v > 0) & (x > 0)
        left = np.where(flying, left + 1, -1)
        if np.all((left > FLIGHT) | (np.abs(v) < 1e-9) & (np.abs(x) < 1e-9)):
            break
    return v
