"""Conditioning and stability of one step of the finite-element model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.mesh.model import Model, build
from fem_reference.problem.problem import Problem, Scheme
from fem_reference.scheme.eigen import DENSE, eigenvalues, highest_frequency, lowest
from fem_reference.scheme.modal import roots
from fem_reference.scheme.newmark import Stepper


@dataclass(frozen=True)
class Diagnostics:
    """What one step does to the mesh's modes, and how well its matrix is conditioned."""

    condition_number: float  # of S = M + alpha dt^2 K [-]; NaN for meshes too large for dense matrices
    scaled_residual: float  # max |S x - b| / (|S| |x| + |b|) of one solution with the load [-]
    spectral_radius: float  # largest |lambda| seen: the code's own step applied to unit states of single modes [-]
    predicted_radius: float  # largest |lambda| of the same modes by the stages of one step [-]
    largest_omega: float  # largest w dt [-]


def diagnostics(problem: Problem, scheme: Scheme, full: bool = False, model: Model | None = None) -> Diagnostics:
    """Conditioning, residual and spectral radius of the step."""
    model = build(problem, full) if model is None else model
    small = len(model.F) <= DENSE
    # all frequencies of a small mesh, the lowest ones and the highest of a large one
    squares = lowest(model.K, model.M, len(model.F) if small else 6)[0]
    omegas = np.append(np.sqrt(np.abs(squares)), highest_frequency(problem, model=model)) * scheme.step
    stepper = Stepper(model.M, model.K, model.F, scheme)
    S = stepper.S
    F = model.F
    x = stepper.solve(F)
    residual = np.abs(S @ x - F) / (abs(S) @ np.abs(x) + np.abs(F) + np.finfo(float).tiny)
    return Diagnostics(
        condition_number=float(np.linalg.cond(S.toarray())) if small else float("nan"),
        scaled_residual=float(np.max(residual)),
        spectral_radius=max(float(np.max(np.abs(eigenvalues(w / scheme.step, scheme)))) for w in omegas),
        predicted_radius=max(float(np.max(np.abs(roots(float(w), scheme)))) for w in omegas),
        largest_omega=float(np.max(omegas)),
    )
