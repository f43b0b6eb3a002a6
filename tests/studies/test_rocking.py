"""The studies of rocking and toppling: closed forms against scipy, numbers of the text."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from validation.studies.toppling import formulas as toppling
from validation.suite.bands import cases
from validation.theory.rocking import Rectangle

PRECISELY = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14, "dense_output": True}


def rigid(block, k, start, end, slope=0.0):
    """Return the motion of a rigid block about a corner by DOP853, with its events: flat, over the corner."""

    def rate(t, y):
        angle = block.alpha - slope - y[0]
        return [y[1], block.rate2 * (k(t) * math.cos(angle) - math.sin(angle))]

    def flat(t, y):
        return float(y[0])

    def over(t, y):
        return float(y[0] - block.alpha)

    flat.direction = -1
    return solve_ivp(rate, (0, end), [start, 0.0], events=(flat, over), max_step=0.01, **PRECISELY)


def test_quarter_periods_and_falls_are_those_of_the_differential_equation():
    for height, tilt in ((2.0, 1e-3), (8.0, 1e-3), (4.0, 0.2)):
        block = Rectangle(2.0, height, 9.81)
        exact = rigid(block, lambda t: 0.0, tilt, 2.0).t_events[0][0]
        assert block.quarter_period(tilt) == pytest.approx(exact, rel=1e-9)
    tower, slope = Rectangle(10.0, 25.0, 9.81), math.radians(40.0)
    motion = rigid(tower, lambda t: 0.0, 0.0, 3.0, slope)
    duration = tower.fall_time(slope - tower.alpha, 0.5)
    assert motion.sol(duration)[0] == pytest.approx(0.5, rel=1e-8)
    rates = motion.sol(np.linspace(0, duration, 4001))[1]
    squared = np.trapezoid(rates**2, dx=duration / 4000)
    assert tower.squared_rate(slope - tower.alpha, duration) == pytest.approx(squared, rel=1e-6)


def test_the_numbers_of_the_page_are_those_of_the_closed_forms():
    page = (Path(__file__).parents[2] / "docs/rotation.md").read_text(encoding="utf-8")
    text = " ".join(page.split())
    blocks = [Rectangle(2.0, height, 9.81) for height in (2.0, 4.0, 8.0)]
    rows = [line.split("|")[2:5] for line in page.splitlines() if line.startswith("|")]
    times, constant, ratios = ([float(word) for word in row] for row in rows[2:5])
    assert times == [round(block.quarter_period(1e-3), 5) for block in blocks]
    small = [math.sqrt(2e-3 * (b.width**2 + b.height**2) / 3 / (b.gravity * b.width / 2)) for b in blocks]
    assert constant == [round(value, 5) for value in small]
    assert ratios == [round(block.housner, 3) for block in blocks]
    (growing,), standing = cases("toppling-growth"), [case.load.slope for case in cases("toppling-threshold")]
    assert "by 0.51 % at dt = 20 ms" in text and growing.time.step == 0.02 and standing == [21.6, 22.0]
    assert toppling.growth(growing) == pytest.approx(0.0051, abs=1e-4)  # DDA's is gated beside it
    upright = growing.with_values({"block.tilt": 0.0})
    assert "released on its lower corner with a tilt of 1 deg" in text and growing.block.tilt == -1.0
    assert "(0.47 % from no tilt" in text and toppling.growth(upright) == pytest.approx(0.0047, abs=5e-5)
    assert f"tan(b) = a/h at {math.degrees(math.atan(10 / 25)):.2f} deg" in text


@pytest.mark.parametrize("size", [0.9, 1.02])
def test_pulses_overturn_as_the_differential_equation_says(size):
    block, duration = Rectangle(1.0, 4.0, 9.81), 0.36
    k = size * block.pulse_threshold(duration)
    during = rigid(block, lambda t: k, 0.0, duration)
    angle, rate = during.y[:, -1]
    assert block.pulse_end(k, duration) == pytest.approx(angle, rel=1e-9)

    def free(t, y):
        return [y[1], -block.rate2 * math.sin(block.alpha - y[0])]

    after = solve_ivp(free, (0, 1.5), [angle, rate], **PRECISELY)
    tilts = after.sol(np.linspace(0, 1.5, 20001))[0]
    if size < 1:
        assert block.pulse_peak(k, duration) == pytest.approx(np.max(tilts), rel=1e-7) and np.max(tilts) < block.alpha
    else:
        assert after.sol(block.pulse_overturning(k, duration) - duration)[0] == pytest.approx(block.alpha, rel=1e-7)
