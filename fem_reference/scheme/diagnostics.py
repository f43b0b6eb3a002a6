"""Stability of one step of the finite-element model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.mesh.model import Model, build
from fem_reference.problem.problem import Array, Problem, Scheme
from fem_reference.scheme.eigen import DENSE, eigenvalues, highest_frequency, lowest
from fem_reference.scheme.modal import roots


@dataclass(frozen=True)
class Diagnostics:
    """What one step does to the mesh's modes."""

    spectral_radius: float  # largest |lambda| seen: the code's own step applied to unit states of single modes [-]
    predicted_radius: float  # largest |lambda| of the same modes by the stages of one step [-]
    largest_omega: float  # largest w dt [-]


def diagnostics(problem: Problem, scheme: Scheme, full: bool = False, model: Model | None = None) -> Diagnostics:
    """Return spectral radii of the step and the largest w dt."""
    model = build(problem, full) if model is None else model
    omegas = _frequencies(problem, model) * scheme.step
    return Diagnostics(
        spectral_radius=max(float(np.max(np.abs(eigenvalues(w / scheme.step, scheme)))) for w in omegas),
        predicted_radius=max(float(np.max(np.abs(roots(float(w), scheme)))) for w in omegas),
        largest_omega=float(np.max(omegas)),
    )


def _frequencies(problem: Problem, model: Model) -> Array:
    """All frequencies of a small mesh, the lowest ones and the highest of a large one [rad/s]."""
    size = len(model.F)
    squares = lowest(model.K, model.M, size if size <= DENSE else 6)[0]
    highest = highest_frequency(problem, model=model)
    return np.asarray(np.sqrt(np.abs(np.append(squares, highest**2))))
