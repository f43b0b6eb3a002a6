r"""What the memory of the acceleration puts into a mode when a load comes on at once.

A mode of W = w dt starts from rest under a load that deflects it by x_s, A0 = w^2 x_s where the start is consistent. In
exact time E = v^2/2 + w^2 x^2/2 - w^2 x_s x stays at zero, and the load gives G = w^2 x_s^2 / 2 until the mode is at
rest. A scheme that remembers its acceleration may put E far above zero in the first step:
Chung and Hulbert's at rho_inf = 0 has

    E1 / G = W^6 / (16 (2 + W^2)^2),

1 % at W = 1.08 and W^2 / 16 for long steps. Newmark's has none where alpha = delta/2 or the step is short; from
A0 = 0 an unconditionally stable scheme puts in 0.3 % at most. The modes of a block add, each by its share of the
static response.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.theory.stages import Stages, step_end

STEPS = 10  # in which the greatest energy is looked for; it is that of the first one


def greatest_rise(stages: Stages, omegas_dt: Sequence[float], shares: Sequence[float]) -> float:
    """Return the greatest energy of some modes together above that of a consistent start, over what the load gives [-].

    Of each mode W = w dt is in `omegas_dt`, its share of the static response in `shares`.
    """
    square = np.array(omegas_dt) ** 2  # x_s and dt are 1
    motion = (0 * square, 0 * square, square)
    greatest = 0.0
    for _ in range(STEPS):
        motion = step_end(stages, *motion, square, square)
        position, velocity, _ = motion
        over_given = (velocity**2 + square * position**2 - 2 * square * position) / square
        greatest = max(greatest, float(over_given @ np.array(shares)))
    return greatest
