"""A discount by the kinetic energy of the steps before: its own steps, in all six unknowns."""

import numpy as np
from oracles import block_in_digits

from dda import Block, Contact, Material, Scheme, TwoBlockModel, solve

PENTAGON = [[1, 1], [3.1, 1.7], [2.9, 3.3], [1.5, 4], [0.7, 2]]


def test_the_discount_is_the_ratio_of_the_last_two_speeds_above_a_floor():
    """And its loss is what it takes of the kinetic energy at the start of each step."""
    alpha, delta, dt, floor, steps = 0.3025, 0.6, 7e-4, 0.83, 60
    model = TwoBlockModel(Block(PENTAGON, Material(2100.0, 3e9, 0.28)), Contact(2e9, 0.7e9), 5e6, base=1, top=3)
    M, K, F = (part.astype(float) for part in block_in_digits.locked_matrices(model, Scheme(0.5, 1.0, 1.0, dt)))
    D = np.zeros(6)
    V = np.zeros(6)
    A = np.zeros(6)
    energies = [0.0, 0.0]  # at the ends of the last two steps
    rows = []
    taken = 0.0
    for _ in range(steps):
        before, now = energies
        gg = max(floor, np.sqrt(now / before)) if now < before else 1.0
        taken += (1 - gg**2) * now
        moved = D + dt * gg * V + dt**2 * (0.5 - alpha) * A
        rate = gg * V + dt * (1 - delta) * A
        A = np.linalg.solve(M + alpha * dt**2 * K, F - K @ moved)
        D = moved + alpha * dt**2 * A
        V = rate + delta * dt * A
        energies = [now, V @ M @ V / 2]
        rows.append([D[1], D[2], gg, taken])
    columns = ("displacement", "rotation", "discount", "kinetic_damping_loss")
    result = solve(model, Scheme(alpha, delta, 1.0, dt), steps, columns, floor=floor)
    expected = np.array(rows)
    assert {floor, 1.0} < set(expected[:, 2])
    for name, values in zip(columns, expected.T, strict=True):
        assert np.max(np.abs(result.columns[name] - values)) < 1e-9 * np.max(np.abs(values)), name
