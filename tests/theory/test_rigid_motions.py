"""Quadratures and closed forms of rigid motions against their equations, from Newton's laws once more."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from validation import exact
from validation.theory.edges import edge
from validation.theory.rocking import Rectangle

TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}


# ---- about a corner --------------------------------------------------------------------------------------------------

BOX = Rectangle(0.7, 1.9, 3.7)
ARM2 = (0.7**2 + 1.9**2) / 3  # moment of inertia about a corner over the mass


def rocked(duration, state, k=0.0, event=None):
    """Return the motion of a tilt about a corner by its levers, under k g along the base."""

    def rates(_, state):
        tilt, rate = state
        right = 0.35 * math.cos(tilt) - 0.95 * math.sin(tilt)
        up = 0.95 * math.cos(tilt) + 0.35 * math.sin(tilt)
        return [rate, 3.7 * (k * up - right) / ARM2]

    if event:
        event.terminal = True
    return solve_ivp(rates, (0.0, duration), state, events=event, **TIGHT)


def test_a_box_that_is_let_go_comes_down_and_keeps_its_momentum_about_the_new_corner():
    fall = rocked(9.0, [0.23, 0.0], event=lambda _, state: state[0])
    assert BOX.quarter_period(0.23) == pytest.approx(fall.t[-1], rel=1e-10)
    assert BOX.landing_rate(0.23) == pytest.approx(-fall.y[1, -1], rel=1e-10)
    of_box = {"width": 0.7, "height": 1.9, "tilt": 0.23, "gravity": 3.7}
    assert exact.rocking_quarter_period(**of_box) == pytest.approx(fall.t[-1], rel=1e-10)
    after = rocked(0.4, [0.0, -fall.y[1, -1] * BOX.housner]).y[0, -1]  # on the other corner
    tilts = exact.rocking_tilt([0.9, fall.t[-1] + 0.4], **of_box)
    assert tilts == pytest.approx([rocked(0.9, [0.23, 0.0]).y[0, -1], -after], rel=1e-8)
    for spin in (BOX.critical_spin, 0.4):
        rotation = BOX.alpha if spin > 0.5 else BOX.greatest_rotation(spin)
        lift = math.hypot(0.35, 0.95) * math.cos(BOX.alpha - rotation) - 0.95
        assert ARM2 * spin**2 / 2 == pytest.approx(3.7 * lift, rel=1e-12)
    with pytest.raises(ValueError, match="overturns"):
        BOX.greatest_rotation(1.001 * BOX.critical_spin)
    radius2, own = (0.7**2 + 1.9**2) / 4, (0.7**2 + 1.9**2) / 12
    assert BOX.housner == pytest.approx((own + radius2 * math.cos(2 * BOX.alpha)) / (own + radius2), rel=1e-13)


def test_a_pulse_of_the_base_tilts_a_box_or_overturns_it():
    duration = 0.61
    threshold = BOX.pulse_threshold(duration)
    for k in (0.9 * threshold, 1.2 * threshold):
        pulse = rocked(duration, [0.0, 0.0], k)
        tilt, rate = pulse.y[:, -1]
        assert BOX.pulse_end(k, duration) == pytest.approx(tilt, rel=1e-9)
        assert float(BOX.pulse_rate2(k, np.array(tilt))) == pytest.approx(rate**2, rel=1e-9)
        if k < threshold:
            after = rocked(20.0, [tilt, rate], event=lambda _, state: state[1])
            assert BOX.pulse_peak(k, duration) == pytest.approx(after.y[0, -1], rel=1e-9)
            assert after.y[0, -1] < BOX.alpha
        else:
            after = rocked(20.0, [tilt, rate], event=lambda _, state: state[0] - BOX.alpha)
            assert BOX.pulse_overturning(k, duration) == pytest.approx(duration + after.t[-1], rel=1e-9)
    tilt, rate = rocked(duration, [0.0, 0.0], threshold).y[:, -1]  # it just carries the centre above the corner
    lift = math.hypot(0.35, 0.95) * (1 - math.cos(BOX.alpha - tilt))
    assert ARM2 * rate**2 / 2 == pytest.approx(3.7 * lift, rel=1e-7)


# ---- a first touch, an edge of what holds ----------------------------------------------------------------------------


def test_an_edge_lies_between_what_holds_and_what_does_not():
    assert edge(lambda x: x < 2.7, 1.0, 30.0, 1e-6) == pytest.approx(2.7, rel=1e-6)
    assert 2.7 < edge(lambda x: x > 2.7, 40.0, 1.0, 1e-6) < 2.7 * (1 + 1e-6)
