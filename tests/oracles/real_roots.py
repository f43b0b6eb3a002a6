"""Where the roots of a step turn real, in closed form: a pair of bounds of X = Omega^2 / (1 + alpha Omega^2)."""

import numpy as np


def real_root_bounds(delta: float, gg: float) -> tuple[float, float]:
    """Return the two X between which the roots are a complex pair, NaN if there are none."""
    p = 0.5 + gg * delta
    b = 2 * (1 + gg) * p + 4 * gg * (0.5 - delta)
    inner = 8 * gg * (1 + gg) * (1 - delta * (1 - gg))
    if inner < 0:
        return np.nan, np.nan
    larger = b + np.sqrt(inner)
    if larger <= 0:
        return np.nan, np.nan
    return 2 * (1 - gg) ** 2 / larger, larger / (2 * p * p)


def omega_of_x(X: float, alpha: float) -> float:
    """Return Omega where Omega^2 / (1 + alpha Omega^2) = X; inf if it stays below."""
    if np.isnan(X):
        return np.nan
    # decimals such as 0.3025 meet the bound alpha X = 1 to their rounding only
    return float(np.sqrt(X / (1 - alpha * X))) if alpha * X < 1 - 8 * np.finfo(float).eps else np.inf


def bifurcation_omega(alpha: float, delta: float, gg: float = 1.0) -> float:
    """Return the Omega above which the roots are real; inf if never, NaN if they always are.

    At gg = 1 it is finite unless alpha >= (1/2 + delta)^2 / 4, eq. (14).
    """
    return omega_of_x(real_root_bounds(delta, gg)[1], alpha)


def overdamping_omega(alpha: float, delta: float, gg: float) -> float:
    """Return the Omega below which kinetic damping alone overdamps; NaN if the roots are always real."""
    return omega_of_x(real_root_bounds(delta, gg)[0], alpha)
