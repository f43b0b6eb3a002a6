"""Columns of contacts, drawn by a seed, and the equations that every history of theirs must obey, from its columns.

Nothing here is taken from the stepping: displacements, velocities and forces at each step are put into Newmark's
formulas, the laws of the contacts and the balance of energy.
"""

import math

import numpy as np

from dda import Scheme
from dda.bodies.bonded_column import Drive
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.contact_column import ColumnContactResult, ColumnOptions, solve_contact_column

SCHEMES = [(0.25, 0.5), (0.5, 1.0), (0.3025, 0.6), (0.375, 0.75), (1 / 6, 0.5)]


def still(steps: int) -> Drive:
    """Return no drive."""
    none = np.zeros(steps + 1)
    return Drive(none, none, none, none)


def random_column(rng: np.random.Generator, frictional: bool) -> Column:
    """Return a column of 1 to 7 blocks, elastic or rigid, with contacts, welds and any base."""
    n = int(rng.integers(1, 8))
    layers = []
    for _ in range(n):
        young = math.inf if rng.random() < 0.35 else 1e9 * math.exp(rng.uniform(-2, 2))
        velocity = rng.uniform(-1, 1)
        layers.append(Layer(math.exp(rng.uniform(-1, 1)), rng.uniform(1500, 3500), young, 0.0, 1, velocity))
    faces = np.concatenate([[0.0], np.cumsum([layer.thickness for layer in layers])])
    base = rng.choice(["spring", "welded", "half-space", "free"])
    joints = []
    for height in faces[0 if base == "spring" else 1 : -1]:
        if rng.random() < 0.15:
            continue  # welded
        stiffness = math.inf if rng.random() < 0.2 else 1e9 * math.exp(rng.uniform(-2, 2))
        if frictional:
            strength = math.inf if rng.random() < 0.1 else 1e5 * math.exp(rng.uniform(-2, 2))
            joints.append(Spring(float(height), stiffness, strength=strength))
        else:
            joints.append(Spring(float(height), stiffness, gap=1e-3 * rng.choice([0.0, rng.random()])))
    return Column(
        layers,
        motion="shear" if frictional else "pressure",
        law="frictional" if frictional else "unilateral",
        joints=joints,
        impedance=2e6 if base == "half-space" else None,
        gravity=0.0 if frictional else 9.81,
        unsupported=base == "free",
    )


def random_drive(rng: np.random.Generator, instants: np.ndarray, column: Column) -> Drive:
    """Return a shaking base, or wave, and a pressure on the top; a base that is welded to a block is still."""
    w = 2 * math.pi * rng.uniform(20, 80)
    size = rng.uniform(0, 1)
    if column.rests_on_base and column.contacts[0] is None:
        size = 0.0
    motion = size / w * (1 - np.cos(w * instants)), size * np.sin(w * instants), size * w * np.cos(w * instants)
    return Drive(*motion, 1e6 * rng.random() * np.sin(w * instants) ** 2)


def random_scheme(rng: np.random.Generator, step: float) -> Scheme:
    """Return a scheme that is stable, but for alpha = 1/6 in long steps."""
    alpha, delta = SCHEMES[int(rng.integers(len(SCHEMES) - 1))]
    gg = float(rng.choice([1.0, 0.99, 0.8]))
    return Scheme(alpha, delta, gg, step, str(rng.choice(["zero", "consistent"])))  # type: ignore[arg-type]


def all_columns(column: Column) -> tuple[list[str], list[float]]:
    """Return the names that show all of a history, and their heights: middles, tops and contacts."""
    n = len(column.heights)
    middles = list(column.faces[:-1] + column.heights / 2)
    tops = list(column.faces[1:])
    feet = [joint.height for joint in column.joints]
    names = ["displacement", "contact_pressure"]
    names += [f"{part}_{k + 1}" for part in ("displacement", "velocity", "stress") for k in range(2 * n)]
    names += [f"{part}_{2 * n + k + 1}" for part in ("force", "gap", "slip") for k in range(len(feet))]
    return names, [float(x) for x in [*middles, *tops, *feet]]


def run_all(column: Column, scheme: Scheme, drive: Drive, **options: object) -> ColumnContactResult:
    """Return a history with all columns, states and energies."""
    names, heights = all_columns(column)
    chosen = ColumnOptions(states=True, energies=True, **options)  # type: ignore[arg-type]
    return solve_contact_column(column, scheme, drive, names, heights, chosen)


def check_history(column: Column, scheme: Scheme, drive: Drive, result: ColumnContactResult, digits: float) -> None:
    """Assert that a history obeys Newmark's formulas, the laws of its contacts and the balance of energy."""
    n = len(column.heights)
    rows = result.columns
    mean, top, speed, top_speed = (
        np.array([rows[f"{part}_{k + 1 + shift}"] for k in range(n)])
        for part, shift in (("displacement", 0), ("displacement", n), ("velocity", 0), ("velocity", n))
    )
    stretch = 2 * (top - mean)
    stretching = 2 * (top_speed - speed)
    mass = column.densities * column.heights
    elastic = np.isfinite(column.moduli)
    stiffness = np.where(elastic, column.moduli, 0.0) / column.heights
    pressure = drive.pressure[1 : mean.shape[1] + 1]
    base = drive.displacement[1 : mean.shape[1] + 1]

    # the forces of all faces: those of contacts are observed, those of welds follow from the blocks above
    dt, alpha, delta, gg = scheme.step, scheme.alpha, scheme.delta, scheme.gg
    forces = np.full((n + 1, mean.shape[1]), np.nan)
    forces[n] = pressure
    forces[0] = rows["contact_pressure"]
    faces = [column.face_of(joint) for joint in column.joints]
    for k, face in enumerate(faces):
        forces[face] = rows[f"force_{2 * n + k + 1}"]
    assert np.array_equal(forces[0], rows["contact_pressure"])
    known = ~np.isnan(forces[:, 0])

    # the sums of momentum over the blocks between two known forces, whose mean moves as a whole
    scale = np.abs(forces[known]).max() + (mass * 9.81).max() + mass.max() * np.abs(speed).max() / dt
    for low in range(n):
        if not known[low]:
            continue
        high = next(face for face in range(low + 1, n + 1) if known[face])
        inside = slice(low, high)
        total = forces[low] - forces[high] - column.gravity * mass[inside].sum()
        momentum = mass[inside] @ speed[inside]
        gained = momentum[1:] - gg * momentum[:-1]
        given = dt * ((1 - delta) * total[:-1] + delta * total[1:])
        assert np.abs(gained - given).max() <= digits * dt * scale * n
        moved = mass[inside] @ (mean[inside, 1:] - mean[inside, :-1])
        carried = gg * dt * momentum[:-1] + dt * dt * ((0.5 - alpha) * total[:-1] + alpha * total[1:])
        assert np.abs(moved - carried).max() <= digits * (dt * dt * scale * n + mass.sum() * np.abs(mean).max())
        if high == low + 1 and elastic[low]:
            squeeze = -stiffness[low] * stretch[low] - (forces[low] + forces[high]) / 2
            given = dt * ((1 - delta) * squeeze[:-1] + delta * squeeze[1:])
            gained = mass[low] / 12 * (stretching[low, 1:] - gg * stretching[low, :-1])
            largest = scale + np.abs(squeeze).max() + stiffness[low] * np.abs(mean).max()
            assert np.abs(gained - given).max() <= digits * dt * largest * n
    assert not stretch[~elastic].any()
    for k in np.flatnonzero(elastic):
        np.testing.assert_allclose(
            rows[f"stress_{k + 1}"], -stiffness[k] * stretch[k], rtol=0, atol=digits * stiffness[k]
        )

    # the base: a half-space's dashpot, or nothing
    if column.impedance is not None:
        wave = drive.velocity[1 : mean.shape[1] + 1]
        foot = speed[0] - stretching[0] / 2
        dashpot = column.impedance * (2 * wave - foot)
        assert (
            np.abs(forces[0] - dashpot).max()
            <= digits * column.impedance * (np.abs(wave).max() + np.abs(foot).max()) * n
        )
    if column.unsupported:
        assert not forces[0].any()

    # the faces: welds stay together, contacts obey their law
    bottom = mean - stretch / 2
    below = np.vstack([base, top[:-1]])
    length = np.abs(mean).max() + np.abs(stretch).max() + np.abs(base).max()
    opening = bottom - below
    for face in range(0 if column.rests_on_base else 1, n):
        if column.contacts[face] is None:
            assert np.abs(opening[face]).max() <= digits * length * n
    for k, (joint, face) in enumerate(zip(column.joints, faces, strict=True)):
        N = rows[f"force_{2 * n + k + 1}"]
        gap = rows[f"gap_{2 * n + k + 1}"]
        slip = rows[f"slip_{2 * n + k + 1}"]
        state = result.states[face]  # type: ignore[index]
        room = digits * n * (length + joint.gap)
        pressed = N / joint.stiffness
        if column.law == "unilateral":
            assert not slip.any()
            assert np.all(N >= 0)
            assert np.all((N == 0) | (gap == 0))
            assert np.array_equal(state == 1, N > 0)
            assert np.abs(opening[face] + joint.gap - (gap - pressed)).max() <= room
        else:
            assert np.all(np.abs(N) <= joint.strength)
            assert np.abs(opening[face] - slip + pressed).max() <= room
            increment = np.diff(slip)
            assert np.all(increment[state[1:] == 1] == 0)
            assert np.all(increment * state[1:] >= 0)
            assert np.all(N[state == 2] == -joint.strength)
            assert np.all(N[state == -2] == joint.strength)
    check_energy(result, digits)


def check_energy(result: ColumnContactResult, digits: float) -> None:
    """Assert that energy stored and lost, and the work of loads and base, sum to a constant."""
    energies = result.energies
    assert energies is not None
    total = np.sum(list(energies.values()), axis=0)
    size = max(np.abs(part).max() for part in energies.values())
    assert np.ptp(total) <= digits * size * max(1.0, len(total) / 100)
