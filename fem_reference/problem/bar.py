"""The bar on a base spring that carries no tension: its data, and which problems it stands for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fem_reference.problem.checks import require_numbers
from fem_reference.problem.problem import Problem

POSITIVE = ("height", "width", "density", "young", "base_stiffness")


@dataclass(frozen=True)
class BarProblem:
    """An elastic bar that is dropped on or pressed against a no-tension base spring.

    At t = 0 the bar is unstrained, its base a gap above the spring, and all loads are switched on.
    """

    height: float  # H [m]
    width: float  # W [m], unit thickness
    density: float  # rho [kg/m3]
    young: float  # axial modulus: E in plane stress, E / (1 - mu^2) in plane strain [Pa]
    base_stiffness: float  # k = 2 p [N/m]
    pressure: float = 0.0  # q on the top [Pa], downwards, from t = 0 on
    gravity: float = 0.0  # downwards [m/s2]
    gap: float = 0.0  # g0 under the base at t = 0 [m]
    velocity: float = 0.0  # at t = 0 [m/s], upwards positive

    def __post_init__(self) -> None:
        require_numbers(self, POSITIVE, ("gap",))

    @property
    def travel(self) -> float:
        """Time H / c of a wave from top to base [s]."""
        return self.height / math.sqrt(self.young / self.density)

    @property
    def kappa(self) -> float:
        """Stiffness of the spring over that of the bar, k H / (E W) [-]."""
        return self.base_stiffness / self.young * (self.height / self.width)


def no_bar(problem: Problem) -> str | None:
    """Why a block under vertical loads does not move as a bar, in words; None if it does."""
    if problem.rectangle is None:
        return "the block is not an upright rectangle loaded opposite its base"
    if problem.poisson != 0:
        return f"Poisson's ratio is {problem.poisson!r}, and the block contracts sideways unless it is 0"
    if problem.foundation != "distributed":
        return f"the foundation is {problem.foundation!r}, and the base moves as one only if it is 'distributed'"
    return None
