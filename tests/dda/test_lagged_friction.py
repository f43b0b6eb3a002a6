"""The friction of common programs: the creep that they show, and where it comes from."""

import math

import numpy as np

from dda import Block, Material, Scheme, Unilateral, UnilateralModel, solve_unilateral

BANDS = (1e-3, 1e-6)  # of a model of 10 m: 2e-4 and 2e-7 of half of that
TURNED = math.radians(20)
FORCE = (1e6 * math.sin(TURNED), 1e6 * math.cos(TURNED) + 10800 * 9.81)  # 1 MN through the centroid, and the weight
# A third-party program (the Berkeley line of DDA for Windows), phi = 22 deg, dt = 2 ms: x of the centroid after
# 10, 20, ... 50 steps; its base is a block on springs, 0.2 % softer than none.
PROGRAM = {10: 1.583e-3, 20: 2.796e-3, 30: 3.521e-3, 40: 4.331e-3, 50: 5.154e-3, 250: 18.717e-3}


def stable(phi, rules="lagged", band=BANDS):
    """Return a block on a base under a force at 18.1 degrees, below its friction angle phi (deg)."""
    law = Unilateral(1e9, 4e8, band=band, friction=math.tan(math.radians(phi)), rules=rules)
    gravity, slope = math.hypot(*FORCE) / 10800, math.degrees(math.atan2(*FORCE))
    square = Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0))
    return UnilateralModel(square, law, gravity=gravity, slope=slope)


def creep(model, dt, time=0.5):
    """Return the history of x."""
    result = solve_unilateral(model, Scheme(0.5, 1.0, 1.0, dt), round(time / dt), ["horizontal_displacement"])
    assert result.outcome == "completed"
    return result.columns["horizontal_displacement"]


def test_a_history_of_a_program_is_met_step_by_step():
    x = creep(stable(22), 2e-3)
    own, program = np.array([x[n - 1] for n in PROGRAM]), np.array([*PROGRAM.values()])
    assert np.max(np.abs(own - program)[:5]) < 5e-6  # its base, 0.2 % of 2 mm that the block moves to and fro
    assert np.max(np.abs(own / program - 1)) < 0.025  # later, two histories with as many slips are not one
    consistent = creep(stable(22, "consistent", (0.0, 0.0)), 2e-3, time=0.1)
    assert abs(consistent[-1] / PROGRAM[50] - 1) > 0.4
