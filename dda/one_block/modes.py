"""Natural modes of the two-block model, and conditioning and stability of its step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dda.model.arrays import Array
from dda.one_block.gap_form import GapForm
from dda.one_block.natural_modes import modal_form
from dda.one_block.two_block import TwoBlockModel
from dda.scheme import roots, spectral
from dda.scheme.newmark import Scheme, staged_step, step_matrices, viscosity


@dataclass(frozen=True)
class Mode:
    """A natural mode and what one step of the scheme does to it."""

    frequency: float  # w [rad/s], undamped natural
    share: float  # of the static response, (phi'F)^2 / (w^2 F'D_static) [-]
    eigenvalues: tuple[complex, complex]  # of the mode's own one-step operator, larger modulus first
    contact_share: float  # static contact pressure that the mode carries, over the applied pressure [-]


@dataclass(frozen=True)
class Diagnostics:
    """Conditioning and stability of the assembled step."""

    condition_number: float  # of S = M + alpha dt^2 K in D, unscaled [-]
    scaled_condition_number: float  # of the scaled S that is factored [-]
    scaled_residual: float  # max |S x - b| / (|S| |x| + |b|) of one solution with the load [-]
    spectral_radius: float  # largest |lambda| seen: the step applied to unit states of the reached modes [-]
    predicted_radius: float  # the same from trace and determinant in closed form [-]
    largest_omega: float  # largest w dt over the reached modes [-]


def modes(model: TwoBlockModel, scheme: Scheme) -> tuple[Mode, ...]:
    """Return the modes that the load can reach, the largest static share first.

    Where the base alone acts the load is the inertia M R of its unit acceleration.
    """
    form = model.gap_form.reduced()
    modal = modal_form(form)
    alone = model.load_size == 0 and np.any(modal.translation)  # then form.F is that of 1 Pa
    pushed = np.sum(modal.translation, axis=1) if alone else modal.load
    shares = (pushed / modal.frequencies) ** 2
    shares /= np.sum(shares)
    carried = (form.observers["contact_pressure"] @ modal.shapes) * pushed / modal.frequencies**2
    return modes_of(scheme, modal.frequencies, shares, carried, np.argsort(-shares))


def modes_of(
    scheme: Scheme, frequencies: Array, shares: Array, carried: Array, order: NDArray[np.intp]
) -> tuple[Mode, ...]:
    """Return modes in some order, with what a step of the scheme does to each."""
    rows = zip(frequencies[order].tolist(), shares[order].tolist(), carried[order].tolist(), strict=True)
    return tuple(Mode(w, share, scalar_eigenvalues(scheme, w), pressure) for w, share, pressure in rows)


def scalar_eigenvalues(scheme: Scheme, frequency: float) -> tuple[complex, complex]:
    """Return the two non-zero eigenvalues of one step of a mode, the larger modulus first.

    The step is applied to the unit states of (D, dt V) with the acceleration that equilibrium
    gives them, A = -w^2 D - (a0 + a1 w^2) V, which every step but the first starts from. Of schemes by their stages
    they are those of the closed form, `dda.scheme.roots`.
    """
    if scheme.table is not None:
        return roots.eigenvalues(scheme, frequency * scheme.step)
    k = (frequency * scheme.step) ** 2
    S = step_matrices(scheme, 1.0, k)
    a, c, *_ = staged_step(scheme, S, k, [0.0], [0.0], (1.0, 0.0, -k, -k))
    b, d, *_ = staged_step(scheme, S, k, [0.0], [0.0], (0.0, 1.0, 0.0 - viscosity(scheme, k), 0.0))
    root = np.sqrt(complex(((a - d) / 2) ** 2 + b * c))
    pair = sorted(((a + d) / 2 + root, (a + d) / 2 - root), key=abs, reverse=True)
    return complex(pair[0]), complex(pair[1])


def _scaled(form: GapForm, scheme: Scheme) -> tuple[Array, Array, Array]:
    """Return M, dt^2 K (diagonal) and dt^2 F in unknowns scaled for a diagonal of S near one."""
    k = scheme.step**2 * form.K
    F = scheme.step**2 * form.F
    diagonal = step_matrices(scheme, np.diag(form.M), k)[-1]
    scale = np.ldexp(1.0, -(np.frexp(diagonal)[1] // 2))
    return scale[:, None] * form.M * scale, scale * k * scale, scale * F


def diagnostics(model: TwoBlockModel, scheme: Scheme) -> Diagnostics:
    """Return conditioning, residual and spectral radius of the assembled step."""
    form = model.gap_form.reduced()
    M, k, F = _scaled(form, scheme)
    S = step_matrices(scheme, M, np.diag(k))[-1]
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
