r"""Self-adaptive kinetic damping: the discount of each step from the kinetic energies of the two steps before it.

With T_n = V_n' M V_n / 2 at the end of step n, step n + 1 starts with the velocity gg_(n+1) V_n,

    gg_(n+1) = 1                                    where T_n >= T_(n-1),
    gg_(n+1) = max(floor, sqrt(T_n / T_(n-1)))      where it falls,

one discount for all unknowns; the first step starts from rest. gg is continuous in the ratio, and does not change with
the size of the load, but the motion is no longer linear: loads do not superpose.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from dda.model.arrays import Array
from dda.scheme.newmark import Scheme, rest, staged_step, step_matrices


def adapted_modes(
    scheme: Scheme, frequencies: Array, load: Array, steps: int, floor: float
) -> tuple[Array, Array, Array]:
    """Step all modes together from rest under a constant modal load, by a scheme whose own discount is 1.

    Return D of every mode and step, (n, steps), the gg that each step starts with, and the kinetic energy taken up to
    its end [J], (steps,).

    Parameters
    ----------
    frequencies, load : (n,) array
        w [rad/s] and load of the mass-normalised modes.
    """
    dt = scheme.step
    k = (dt * frequencies) ** 2
    F = dt * dt * load
    S = step_matrices(scheme, np.ones_like(k), k)
    still = 0 * k
    state = rest(scheme, F, still, k)
    modes = np.empty((len(k), steps))
    discount = np.empty(steps)
    loss = np.empty(steps)
    before = now = 0.0  # dt sqrt(2 T)
    for n in range(steps):
        discount[n] = max(floor, now / before) if now < before else 1.0
        loss[n] = (1 - discount[n] ** 2) * (now / dt) ** 2 / 2
        state = staged_step(replace(scheme, gg=float(discount[n])), S, k, [F], [still], state)
        modes[:, n] = state[0]
        before = now
        now = math.hypot(*state[1].tolist())
    return modes, discount, np.cumsum(loss)
