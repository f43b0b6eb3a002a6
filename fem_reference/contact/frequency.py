"""The largest frequency of a block on a base that opens: every point of it closed and sticking."""

from __future__ import annotations

from fem_reference.contact.points import build
from fem_reference.contact.system import with_springs
from fem_reference.problem.problem import Problem
from fem_reference.scheme.eigen import largest_frequency


def highest_closed_frequency(problem: Problem, full: bool = False) -> float:
    """Return the largest natural frequency while every point of the base is closed and sticks [rad/s].

    A point that opens or slides takes its springs away, which lowers every frequency: the springs of all bound every
    contact state.
    """
    system = build(problem, full).system("glued")
    return largest_frequency(with_springs(system.K, system.B, system.rows.compliance), system.M)
