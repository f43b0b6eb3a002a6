"""The largest frequency of a block on a base that opens: every point of it closed and sticking."""

from __future__ import annotations

from scipy.sparse import csr_array, diags_array

from fem_reference.contact.points import build
from fem_reference.problem.problem import Problem
from fem_reference.scheme.eigen import largest_frequency


def highest_closed_frequency(problem: Problem, full: bool = False) -> float:
    """Return the largest natural frequency while every point of the base is closed and sticks [rad/s].

    A point that opens or slides takes its springs away, which lowers every frequency: K + N' k N + T' k_s T bounds all
    contact states.
    """
    model = build(problem, full)
    normal = model.normal.T @ diags_array(model.stiffness) @ model.normal
    tangential = model.tangential.T @ diags_array(model.shear_stiffness) @ model.tangential
    return largest_frequency(csr_array(model.K + normal + tangential), model.M)
