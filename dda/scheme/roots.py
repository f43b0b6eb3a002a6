r"""Roots of one step of a mode, of any scheme.

For z = 1 + y a scheme of one stage has, with Omega = w dt,

    y (y + 1 - gg) (1 + (1 - am) y)
        + Omega^2 (1 + (1 - af) y) [gg d_u (g_0 + delta + delta y) + (e_0 + alpha + alpha y) (y + 1 - gg)] = 0,

where g_0 + delta = 1; one root is z = 0 where am = af = 0. One of two stages maps (D, dt V) by a 2 x 2 matrix I + B,
and y^2 - tr(B) y + det(B) = 0. Newmark's has under viscous damping, with e = dt (a0 + a1 w^2),

    (1 + alpha Omega^2 + delta e) y^2 + [1 - gg + e + Omega^2 (alpha + 1/2 + gg (delta - alpha))] y
        + Omega^2 (1 + gg)/2 = 0.

Nothing is subtracted from one, so that slow modes keep their digits.
"""

from __future__ import annotations

import numpy as np

from dda.model.arrays import Array
from dda.scheme.newmark import Scheme, step_matrices, viscosity
from dda.scheme.spectral import ComplexArray, Quadratic, damping_of, largest_first, pair
from dda.scheme.stage import effective_matrix, predictor, velocity_corrector


def state_matrix(scheme: Scheme, k: float) -> Array:
    """Return B of a step (D, P) -> (I + B) (D, P) without load, with k = (w dt)^2; the scheme does not average."""
    change = np.empty((2, 2))
    for column, (D, P) in enumerate(((1.0, 0.0), (0.0, 1.0))):
        f = -k * D
        P1 = P
        f1 = f
        moved = 0.0
        for stage in scheme.stages:
            f_g = f1
            balance = predictor(stage, P, f, P1, f_g)
            moved += (balance - stage.alpha * k * (D + moved)) / effective_matrix(stage, 1.0, k)
            f1 = -k * (D + moved)
            gained = velocity_corrector(stage, 0.0, f, f_g, f1)
            P1 = scheme.gg * P + gained
        change[:, column] = moved, gained - (1 - scheme.gg) * P
    return change


def polynomial(scheme: Scheme, omega: float) -> Array:
    """Return the coefficients of y = z - 1, highest power first, of the roots that are not z = 0 for any w dt."""
    k = omega * omega
    if scheme.damped:
        e = viscosity(scheme, k)
        slope = 1 - scheme.gg + e + k * (scheme.alpha + 0.5 + scheme.gg * (scheme.delta - scheme.alpha))
        (leading,) = step_matrices(scheme, 1.0, k)
        return np.array([1.0, slope / leading, k * (1 + scheme.gg) / 2 / leading])
    if not scheme.averages:
        change = state_matrix(scheme, k)
        return np.array([1.0, -np.trace(change), change[0, 0] * change[1, 1] - change[0, 1] * change[1, 0]])
    (stage,) = scheme.stages
    discounted = np.array([1.0, 1 - scheme.gg])
    free = np.polymul([1.0, 0.0], np.polymul(discounted, [1 - stage.am, 1.0]))
    velocity = scheme.gg * stage.d_u * np.array([stage.delta, stage.g_0 + stage.delta])
    moved = np.polyadd(velocity, np.polymul([stage.alpha, stage.e_0 + stage.alpha], discounted))
    return np.asarray(np.polyadd(free, k * np.polymul([1 - stage.af, 1.0], moved)))


def roots(scheme: Scheme, omega: float) -> ComplexArray:
    """Return the roots z of a step of a mode with w dt = omega, two or three, the largest modulus first."""
    return largest_first(1 + increments(scheme, omega))


def increments(scheme: Scheme, omega: float) -> ComplexArray:
    """Return y = z - 1 of the roots."""
    coefficients = polynomial(scheme, omega)
    if len(coefficients) == 3:
        return pair(quadratic(*coefficients[1:]))[0]
    y = np.roots(coefficients).astype(complex)
    slope = np.polyder(coefficients)
    for _ in range(2):  # Newton's method takes back what the eigenvalues of a companion matrix lose
        derivative = np.polyval(slope, y)
        y = y - np.divide(np.polyval(coefficients, y), derivative, out=np.zeros_like(y), where=derivative != 0)
    return np.asarray(y)


def principal_pair(scheme: Scheme, omega: float) -> ComplexArray:
    """Return y of the pair that stands for the mode: the complex one, else the two largest z."""
    y = increments(scheme, omega)
    rising = y[y.imag > 0]
    if len(rising) == 1:
        return np.array([rising[0], rising[0].conjugate()])
    return largest_first(1 + y)[:2] - 1 if len(y) > 2 else y


def eigenvalues(scheme: Scheme, omega: float) -> tuple[complex, complex]:
    """Return z of the principal pair, the larger modulus first."""
    first, second = largest_first(1 + principal_pair(scheme, omega)).tolist()
    return first, second


def damping_ratio(scheme: Scheme, omega: float) -> float:
    """Return xi = -Re(ln z)/|ln z|; at least one where overdamped, NaN where the dominant root is not positive."""
    y = principal_pair(scheme, omega)
    return float(damping_of(quadratic(float(-np.sum(y).real), float(np.prod(y).real))))


def quadratic(b: float, c: float) -> Quadratic:
    """Return the equation of a pair by that of its y."""
    return Quadratic(np.asarray(b), np.asarray(c), np.asarray(1 + (c - b)), np.asarray(c - b))
