"""Finite-element problems that several tests solve."""

import numpy as np

from fem_reference.history.solver import run
from fem_reference.mesh.model import build
from fem_reference.problem.problem import Problem
from fem_reference.scheme.newmark import Stepper

SQUARE = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
# A trapezoid on an inclined base, away from the origin, its base not the first edge.
INCLINED = ((9.2, 11.9), (10.0, 10.0), (11.6, 11.2), (10.6, 12.6))


def make(vertices=SQUARE, base=0, top=2, poisson=0.0, hypothesis="plane stress", p=1e9, shear=None, **mesh):
    shear = p if shear is None else shear
    return Problem(vertices, base, top, 2700.0, 1e9, poisson, hypothesis, p, shear, 5e6, **mesh)


COLUMNS = ("displacement", "contact_pressure")


def stepped(problem, scheme, steps):
    """Return the columns by plain steps on the same unknowns."""
    model = build(problem)
    return problem.load_size * run(Stepper(model.M, model.K, model.F, scheme), model, steps, COLUMNS)


def error(found, columns):
    return max(np.abs(a - b).max() / np.abs(b).max() for a, b in zip(found, columns, strict=True))
