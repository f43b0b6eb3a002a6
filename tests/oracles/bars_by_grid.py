"""Bars on each other on a grid of characteristics: travel times are whole numbers of steps.

Shares no code with the exact motions. The waves are exact on the grid; springs follow the trapezoidal rule, with an
error of the second order in the step, and rigid joints switch at the nodes of the grid.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def bars_on_grid(
    impedances: list[float],
    travels: list[int],
    velocities: list[float],
    joints: list[tuple[str, float, float] | None],
    steps: int,
    dt: float,
    gravity: float = 0.0,
    base: Callable[[float], float] = lambda t: 0.0,
    base_impedance: float = np.inf,
    top: Callable[[float], float] = lambda t: 0.0,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forces and openings of the joints, (joints, steps + 1), and mean velocities of the bars at the end, (bars,).

    A joint is ("unilateral", k, gap) or ("frictional", k, strength); travel times are counted in steps.
    """
    n = len(impedances)
    p = [[v / 2] * T for v, T in zip(velocities, travels, strict=True)]  # from -T on
    d = [[v / 2] * T for v, T in zip(velocities, travels, strict=True)]
    forces = np.zeros((n, steps + 1))
    openings = np.zeros((n, steps + 1))
    slips = np.zeros(n)
    gaps = np.array([joint[2] if joint and joint[0] == "unilateral" else 0.0 for joint in joints])
    rates = np.zeros(n)
    for m in range(steps + 1):
        t = m * dt
        for j, joint in enumerate(joints):
            if joint is None:
                p[j].append(d[j][m])
                continue
            law, k, limit = joint
            below = p[j - 1][m] if j else (base(t) if np.isfinite(base_impedance) else base(t) / 2) + gravity * t / 2
            z_below = impedances[j - 1] if j else base_impedance
            mobility = 1 / impedances[j] + 1 / z_below
            K = 2 * d[j][m] - 2 * below
            # trapezoidal rule for the gap, from the rate at the last node: y = known + dt / 2 (K + mobility N)
            known = gaps[j] + dt / 2 * (rates[j] + K) if m else gaps[j]
            weight = dt / 2 * mobility if m else 0.0
            if law == "unilateral":
                if np.isinf(k):
                    closed = known <= 1e-12 and K <= 1e-12
                    N = max(0.0, -K / mobility) if closed else 0.0
                    gaps[j] = 0.0 if closed else known
                else:
                    N = max(0.0, -k * known / (1 + k * weight))
                    gaps[j] = known + weight * N
                openings[j, m] = gaps[j]
            else:
                if np.isinf(k):
                    N = float(np.clip(-K / mobility, -limit, limit))
                    gaps[j] = known + weight * N
                    slips[j] = gaps[j]
                else:
                    N = float(np.clip(-k * (known - slips[j]) / (1 + k * weight), -limit, limit))
                    gaps[j] = known + weight * N
                    slips[j] = gaps[j] + N / k
                openings[j, m] = slips[j]
            rates[j] = K + mobility * N
            forces[j, m] = N
            p[j].append(d[j][m] + N / impedances[j])
            if j:
                d[j - 1].append(p[j - 1][m] - N / impedances[j - 1])
        d[-1].append(p[-1][m] - top(t) / impedances[-1])
    means = np.zeros(n)
    for i, T in enumerate(travels):
        means[i] = np.trapezoid(np.array(p[i][-T - 1 :]) + np.array(d[i][-T - 1 :])) / T - gravity * steps * dt
    return forces, openings, means
