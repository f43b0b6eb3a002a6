"""Random bars on a no-tension spring."""

import numpy as np

from fem_reference.problem.bar import BarProblem


def random_problem(seed):
    rng = np.random.default_rng(seed)
    young = 1e9 * 10 ** rng.uniform(-1, 1)
    height, width = rng.uniform(0.5, 3.0, 2)
    speed = float(np.sqrt(young / 2500.0)) * 1e-3
    return BarProblem(
        height=height,
        width=width,
        density=rng.uniform(2000, 3000),
        young=young,
        base_stiffness=young * width / height * 10 ** rng.uniform(-1, 2),
        pressure=young * rng.uniform(-0.001, 0.01),
        gravity=rng.uniform(0, 20),
        gap=height * rng.uniform(0, 5e-3) * int(rng.integers(2)),
        velocity=speed * rng.uniform(-5, 2),
    )
