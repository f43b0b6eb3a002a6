r"""Self-adaptive kinetic damping: the discount of each step from the kinetic energies before it.

With T_n = V_n' M V_n / 2 at the end of step n, the velocity at the start of step n + 1 is gg_(n+1) V_n,

    gg_(n+1) = 1                                    where T_n >= T_(n-1),
    gg_(n+1) = max(floor, sqrt(T_n / T_(n-1)))      where it falls,

the same for all nodes; the first step starts from rest. The motion is not linear and is stepped without any saving in
time.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.sparse import csr_array

from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Problem, Scheme
from fem_reference.scheme.stage import Motion

ADAPTIVE_COLUMNS = ("discount", "kinetic_damping_loss")
"""Further columns: gg that a step starts with [-], kinetic energy that it has taken up to the step's end [J]."""


class AdaptiveDiscount:
    """The discount of each step under a constant load, of a scheme without a damping of its own, and what it takes."""

    def __init__(self, problem: Problem, scheme: Scheme, M: csr_array, floor: float) -> None:
        require(0 <= floor <= 1, "floor", "must be from 0 to 1", floor)
        require(scheme.table is None, "scheme", "must be 'newmark' where the discount adapts", scheme.name)
        require(scheme.gg == 1, "gg", "must be 1 where the discount adapts", scheme.gg)
        others = {"viscous damping": scheme.damped, "a moving base": problem.motion is not None, "a ramp": problem.ramp}
        there = [name for name, is_there in others.items() if is_there]
        rule = "excludes viscous damping, a moving base and a ramp"
        require(not there, "adaptive discount", rule, " and ".join(there))
        self.M = M
        self.floor = floor
        self.before = 0.0  # kinetic energy at the end of the step before the last one [J]
        self.discounts: list[float] = []
        self.losses: list[float] = []

    def __call__(self, state: Motion) -> float:
        """Discount of the step that begins with a state."""
        energy = float(state.V @ (self.M @ state.V)) / 2
        gg = max(self.floor, math.sqrt(energy / self.before)) if energy < self.before else 1.0
        self.before = energy
        self.discounts.append(gg)
        self.losses.append((1 - gg**2) * energy)
        return gg

    def columns(self, scale: float) -> dict[str, Array]:
        """Return `ADAPTIVE_COLUMNS`, the energies times a scale."""
        return {"discount": np.array(self.discounts), "kinetic_damping_loss": scale * np.cumsum(self.losses)}
