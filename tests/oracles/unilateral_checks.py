"""Random blocks on corners that open, and sizes of what their histories differ by."""

import numpy as np

from dda import Block, Material, Unilateral, UnilateralModel

DT = 3e-4


def random_model(seed, glued=None):
    """Return a block at random data: outline, material, loads, gap and speed; some are symmetric."""
    rng = np.random.default_rng(seed)
    a, h = rng.uniform(0.8, 2.5, 2)
    lean = rng.uniform(-0.3, 0.3) if seed % 3 == 0 else 0.0
    corners = [[0, 0], [a, 0], [a + lean, h], [lean, h * (1 + 0.2 * (seed % 3 == 0))]]
    young = 10 ** rng.uniform(8.5, 9.5)
    p = young * 10 ** rng.uniform(-0.5, 2)
    symmetric = seed % 3 == 1
    shear = (rng.uniform(0.2, 1.0) if (glued if glued is not None else seed % 2) else 0.0) * p
    return UnilateralModel(
        Block(corners, Material(rng.uniform(1500, 3000), young, rng.uniform(-0.2, 0.4))),
        Unilateral(p, shear, rng.uniform(0, 1e-3) * (seed % 4 == 0)),
        pressure=young * rng.uniform(1e-3, 5e-3),
        eccentricity=0.0 if symmetric else rng.uniform(-0.2, 0.2) * a,
        traction=0.0 if symmetric else young * rng.uniform(-1e-4, 1e-4),
        gravity=rng.uniform(0, 15),
        velocity=rng.uniform(-1.5, 1.0),
    )


def apart(values, others):
    """Return the greatest difference over the greatest of the other values."""
    return np.max(np.abs(values - others)) / max(np.max(np.abs(others)), 1e-300)


def size(result):
    """Return the greatest energy of a history [J]."""
    return max(np.max(np.abs(values)) for values in result.energies.values())
