"""The estimate of the small space of `fem` against its rival, plain steps, over random scenes."""

import numpy as np


def honesty(count: int) -> str:
    """Return what random scenes say of the estimate of the small space: true error over estimated, at worst."""
    from fem_reference import Problem, Scheme
    from fem_reference.history.reduced import Reduced, reduced
    from fem_reference.history.solver import run
    from fem_reference.mesh.model import build
    from fem_reference.scheme.newmark import Stepper

    rng, worst, largest, spaces = np.random.default_rng(1), 0.0, 0.0, 0
    corners, columns = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)), ("displacement", "contact_pressure")
    for _ in range(count):
        foundation, mu = (
            str(rng.choice(["distributed", "patch", "corner"])),
            float(rng.choice([0.0, rng.uniform(0, 0.45)])),
        )
        hypothesis, p = str(rng.choice(["plane stress", "plane strain"])), 1e9 * 10 ** rng.uniform(-3, 4)
        mesh = {"elements": int(rng.integers(4, 11)), "degree": int(rng.integers(1, 3)), "foundation": foundation}
        width = 0.5 if foundation == "patch" else None
        problem = Problem(corners, 0, 2, 2700.0, 1e9, mu, hypothesis, p, p, 5e6, patch_width=width, **mesh)
        alpha, delta = [(0.5, 1.0), (0.25, 0.5)][rng.integers(2)]
        start, dt = str(rng.choice(["zero", "consistent"])), float(10 ** rng.uniform(-4.5, -2))
        scheme, steps = Scheme(alpha, delta, float(rng.choice([1.0, 0.98])), dt, start), int(rng.choice([200, 1000]))
        model = build(problem)
        stepper = Stepper(model.M, model.K, model.F, scheme)
        found = reduced(stepper, np.array([model.observers[name] for name in columns]), steps)
        if isinstance(found, Reduced):
            plain = run(stepper, model, steps, columns, None)
            off = max(np.abs(a - b).max() / np.abs(b).max() for a, b in zip(found.history, plain, strict=True))
            worst, largest, spaces = max(worst, off / found.estimate), max(largest, off), spaces + 1
    return (
        f"Of {count} random scenes (p/E 1e-3 to 1e4, dt 3e-5 to 1e-2 s, both schemes and starts, three foundations) "
        f"{spaces} were blocked in a small space and the others stepped; against plain steps the greatest difference "
        f"is {largest:.1g} of the maximum, and the greatest ratio of the true to the estimated error {worst:.2g}."
    )
