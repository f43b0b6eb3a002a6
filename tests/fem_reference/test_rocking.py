"""The rocking of a rigid block: quarter periods, energy."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fem_reference.exact.rocking import RockingBlock, solve

BLOCK = RockingBlock(0.8, 2.0)


def energy(block, angle, rate):
    return rate**2 / 2 + block.p**2 * (np.cos(block.alpha - np.abs(angle)) - math.cos(block.alpha))


def test_free_rocking_comes_down_after_quarter_periods_and_keeps_its_energy_between():
    block = replace(BLOCK, restitution=0.8)
    tilt = 0.6 * block.alpha
    motion = solve(block, 4.0, tilt)
    assert motion.impacts[0] == pytest.approx(block.quarter_period(tilt), rel=1e-11)
    assert [block.quarter_period(share * block.alpha) for share in (0.0, 1.0)] == [0.0, math.inf]
    top = energy(block, *motion.at([0.0]))[0]
    for n, (before, after) in enumerate(pairwise(motion.impacts[:5]), start=1):
        own = energy(block, *motion.at(np.linspace(before, after, 20)[1:-1]))
        assert own == pytest.approx(np.full(18, top * block.ratio ** (2 * n)), rel=1e-9)
        # half a period at the tilt to which the energy that is left carries it
        reached = block.alpha - math.acos(math.cos(block.alpha) + own[0] / block.p**2)
        assert after - before == pytest.approx(2 * block.quarter_period(reached), rel=1e-8)
    signs = np.sign(motion.at((np.array(motion.impacts[:3]) + np.array(motion.impacts[1:4])) / 2)[0])
    assert signs.tolist() == [-1.0, 1.0, -1.0]
    assert not motion.overturned
