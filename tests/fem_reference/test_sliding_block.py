"""Newmark's sliding block: an independent integration."""

import numpy as np
import pytest
from conftest import thinned
from scipy.integrate import solve_ivp

from fem_reference.exact.sliding_block import SlidingBlock, moved, recorded, solve

SLOPE = SlidingBlock(20.0, 30.0)


def integrated(block, base, end):
    """The slide at the end by DOP853 with events, on the equation of motion alone."""
    slide = rate = 0.0
    for segment in base:
        t, last = segment.start, min(segment.end, end)
        rate -= segment.jump
        while t < last:
            slide, rate, t = swept(block, segment, (slide, rate), t, last)
    return slide


def swept(block, segment, start, t, last):
    def pushed(now):
        return float(segment.acceleration(now - segment.start))

    excess = block.driving - pushed(t + 1e-9)
    way = int(np.sign(start[1])) or (int(np.sign(excess)) if abs(excess) > block.resistance else 0)

    def motion(now, y):
        return [y[1], block.push(way) - pushed(now) if way else 0.0]

    def change(now, y):
        return way * y[1] + (now - t < 1e-9) if way else block.resistance - abs(block.driving - pushed(now))

    change.terminal, change.direction = True, -1
    options = {"rtol": 1e-12, "atol": 1e-14, "events": [change], "max_step": 0.01}
    done = solve_ivp(motion, (t, last), start, "DOP853", **options)
    rate = 0.0 if len(done.t_events[0]) else float(done.y[1, -1])
    return float(done.y[0, -1]), rate, float(done.t[-1])


def random_base(seed):
    rng = np.random.default_rng(seed)
    t = np.concatenate([[0], np.cumsum(rng.uniform(0.05, 0.3, 8))])
    return recorded(t, rng.uniform(-8, 8, 9)) if seed % 2 else moved(t, np.cumsum(rng.normal(0, 0.03, 9)))


@pytest.mark.parametrize("seed", thinned([1, 4, 2, 5], 4))
def test_an_independent_integration_agrees(seed):
    base = random_base(seed)
    motion = solve(SLOPE, base, 2.0)
    assert motion.slip > 0
    for end in (0.7, 1.3, 2.0):
        assert motion.at([end])[0] == pytest.approx(integrated(SLOPE, base, end), abs=1e-7)


def test_a_slide_that_rounding_alone_would_begin_at_the_end_of_a_row_does_not_go_on_for_ever():
    rng = np.random.default_rng(237)
    t = np.concatenate([[0], np.cumsum(rng.uniform(0.05, 0.3, 20))])
    t[5] = t[4]
    motion = solve(SlidingBlock(0.0, 30.0, 9.81, 0.3), recorded(t, rng.uniform(-8, 8, 21)), 4.0)
    times = [time for time, _ in motion.switches]
    assert times == sorted(times)
    assert motion.slip > 0
