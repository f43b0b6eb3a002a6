"""Conditioning and stability of the step of the two-block model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dda.bodies.two_block import TwoBlockModel
from dda.linear.answers import Mode, modes
from dda.model.arrays import Array
from dda.scheme import roots, spectral
from dda.scheme.newmark import Scheme, staged_step, step_matrices


@dataclass(frozen=True)
class Diagnostics:
    """Conditioning and stability of the assembled step."""

    condition_number: float  # of S = M + alpha dt^2 K in D, unscaled [-]
    scaled_condition_number: float  # of the scaled S that is factored [-]
    scaled_residual: float  # max |S x - b| / (|S| |x| + |b|) of one solution with the load [-]
    spectral_radius: float  # largest |lambda| seen: the step applied to unit states of the reached modes [-]
    predicted_radius: float  # the same from trace and determinant in closed form [-]
    largest_omega: float  # largest w dt over the reached modes [-]


def diagnostics(model: TwoBlockModel, scheme: Scheme) -> Diagnostics:
    """Return conditioning, residual and spectral radius of the assembled step."""
    form = model.reached
    S = step_matrices(scheme, form.M, np.diag(scheme.step**2 * form.K))[-1]
    scale = np.ldexp(1.0, -(np.frexp(np.diag(S))[1] // 2))  # powers of two, which bring the diagonal near one
    S = scale[:, None] * S * scale
    F = scale * (scheme.step**2 * form.F)
    x = np.linalg.solve(S, F)
    residual = np.abs(S @ x - F) / (np.abs(S) @ np.abs(x) + np.abs(F))
    unscaled = step_matrices(scheme, model.mass, scheme.step**2 * model.stiffness)[-1]
    reached = modes(model, scheme)
    omegas = np.array([mode.frequency * scheme.step for mode in reached])
    return Diagnostics(
        condition_number=float(np.linalg.cond(unscaled)),
        scaled_condition_number=float(np.linalg.cond(S)),
        scaled_residual=float(np.max(residual)),
        spectral_radius=_stepped_radius(scheme, reached),
        predicted_radius=_predicted(scheme, omegas),
        largest_omega=float(np.max(omegas)),
    )


def _stepped_radius(scheme: Scheme, reached: tuple[Mode, ...]) -> float:
    """Return the largest |lambda| of the steps of the modes."""
    if scheme.table is None:
        return max(abs(mode.eigenvalues[0]) for mode in reached)
    steps = [step_of_mode(scheme, mode.frequency * scheme.step) for mode in reached]
    return float(np.max(np.abs(np.linalg.eigvals(steps))))


def step_of_mode(scheme: Scheme, omega: float) -> Array:
    """Return the (3, 3) matrix of one unloaded step of a mode of w dt = omega on (D, dt V, dt^2 A), undamped."""
    k = omega * omega
    S = step_matrices(scheme, 1.0, k)
    still = [0.0 for _ in S]
    units = ((1.0, 0.0, 0.0, -k), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))
    return np.array([staged_step(scheme, S, k, still, still, unit)[:3] for unit in units]).T


def _predicted(scheme: Scheme, omegas: Array) -> float:
    """Return the largest |lambda| of some w dt from trace and determinant in closed form."""
    if scheme.table is not None or scheme.damped:
        return max(abs(complex(roots.roots(scheme, omega)[0])) for omega in omegas.tolist())
    return float(np.max(spectral.spectral_radius(omegas, scheme.alpha, scheme.delta, scheme.gg)))
