"""The numbers of docs/theory.md."""

import numpy as np

from validation import load_scene, solve

scene = load_scene("figures-3-4").with_values({"time.step": 0.01})
a, q, p, E = 2.0, 5e6, 1e9, 1e9
static = -a * q / (2 * p) - a / 2 * q / E
assert abs(solve(scene, "dda").displacement[-1] / static - 1) < 1e-6


def radius(W, alpha, delta, gg=1.0):
    """Return the spectral radius of a step of one mode at W = w dt."""
    beta = 1 + alpha * W**2
    trace = 1 - W**2 / (2 * beta) + gg * (1 - delta * W**2 / beta)
    return max(abs(np.roots([1, -trace, gg * (1 + (0.5 - delta) * W**2 / beta)])))


assert abs(radius(4.0, 0.5, 1.0) - 1 / 3) < 1e-6
assert abs(radius(100.0, 0.5, 1.0) - 0.9992) < 1e-4
assert abs(radius(3.0, 0.25, 0.5) - 1) < 1e-12

for alpha, delta, gg in ((0.2, 0.5, 0.5), (0.24, 0.5, 0.5), (0.26, 0.48, 0.9), (0.26, 0.46, 0.9), (0.3, 0.7, 0.9)):
    enough = 4 * (1 + gg) * alpha >= 1 - gg + 4 * gg * delta and gg * (delta - 0.5) >= -(1 - gg) * alpha
    greatest = max(radius(W, alpha, delta, gg) for W in np.geomspace(0.01, 1e5, 200))
    assert enough == (greatest <= 1 + 1e-9)
