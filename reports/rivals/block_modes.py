"""The strongest rival of `dda` that a user has: the block's two modes, each a recursion by `scipy.signal.lfilter`.

Of the six unknowns the vertical displacement and strain alone are loaded. A mode's distance from rest obeys
y_{n+1} = trace y_n - det y_{n-1} from its second step on (docs/theory.md); the first two steps are taken one by one.
"""

import numpy as np
from scipy.linalg import eigh
from scipy.signal import lfilter


def swings(squares: np.ndarray, starts: np.ndarray, steps: int, dt: float, alpha: float, delta: float) -> np.ndarray:
    """Return the modes' distances from rest at every step, shape (modes, steps); they start with V = 0 and A = 0."""
    W2 = squares * dt**2
    share = W2 / (1 + alpha * W2)
    trace = 2 - (0.5 + delta) * share
    determinant = 1 + (0.5 - delta) * share
    A = -share * starts  # dt^2 A of the first step
    first = starts + alpha * A
    V = delta * A
    ahead = first + V + (0.5 - alpha) * A
    second = ahead - alpha * share * ahead
    distances = np.zeros((len(squares), steps))
    distances[:, 0] = first
    distances[:, 1:2] = (second - trace * first)[:, None]
    for y, t, d in zip(distances, trace, determinant, strict=True):
        y[:] = lfilter([1.0], [1.0, -t, d], y)
    return distances


def history(
    steps: int,
    side: float = 2.0,
    rho: float = 2700.0,
    young: float = 1e9,
    p: float = 1e9,
    q: float = 5e6,
    dt: float = 1e-3,
    alpha: float = 0.5,
    delta: float = 1.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Return displacement [m] and contact pressure [Pa] of every step, plane stress, Poisson's ratio 0."""
    M = rho * np.diag([side**2, side**4 / 12])
    gap = np.array([1.0, -side / 2])
    K = np.diag([0.0, young * side**2]) + 2 * p * np.outer(gap, gap)
    rest = np.linalg.solve(K, -q * side * np.array([1.0, side / 2]))
    squares, shapes = eigh(K, M)
    distances = swings(squares, -shapes.T @ M @ rest, steps, dt, alpha, delta)
    rows = np.array([[1.0, 0.0], -2 * p / side * gap])
    columns = (rows @ rest)[:, None] + rows @ shapes @ distances
    return columns[0], columns[1]
