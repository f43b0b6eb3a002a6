"""Closed forms of rigid boxes against other formulas, and against plain integration in small steps."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from validation.theory.boxes import (
    ShakenBox,
    SpringImpact,
)
from validation.theory.rocking import Rectangle


@pytest.mark.parametrize(("box", "share"), [(Rectangle(0.7, 2.9, 9.81), 0.83), (Rectangle(1.3, 1.9, 3.7), 0.97)])
def test_a_box_about_its_corner_turns_as_the_integrated_pendulum(box, share):
    radius = math.hypot(box.width, box.height) / 2
    inertia_over_mass = (box.width**2 + box.height**2) / 3
    spin = box.critical_spin
    assert inertia_over_mass * spin**2 / 2 == pytest.approx(box.gravity * (radius - box.height / 2), rel=1e-12)

    def rates(_, state):
        torque = box.gravity * (box.height / 2 * math.sin(state[0]) - box.width / 2 * math.cos(state[0]))
        return [state[1], torque / inertia_over_mass]

    end = 2 * box.quarter_period(box.greatest_rotation(share * spin))
    time = np.linspace(0, end, 2001)
    turned = solve_ivp(rates, (0, end), [0.0, share * spin], t_eval=time, rtol=1e-11, atol=1e-12).y[0]
    assert max(turned) == pytest.approx(box.greatest_rotation(share * spin), rel=1e-5)
    assert turned[-1] == pytest.approx(0.0, abs=1e-7)
    with pytest.raises(ValueError, match="overturns"):
        box.greatest_rotation(1.001 * spin)


@pytest.mark.parametrize(
    "box",
    [
        ShakenBox(-0.03, 1.5, 0.2, 9.81),  # sticks in between
        ShakenBox(0.2, 3.0, 0.05, 3.7),  # hardly follows
    ],
)
def test_the_slip_on_shaken_ground_is_that_of_small_steps(box):
    duration = 2.0
    step = 4e-4
    velocity = 0.0
    displacement = 0.0
    expected = []
    for n in range(1, round(duration / step) + 1):
        wanted = box.ground_velocity(n * step) - velocity
        velocity += max(-box.grip * step, min(box.grip * step, wanted))
        displacement += velocity * step
        if n % 250 == 0:
            expected.append(displacement)
    time = 0.1 * np.arange(1, 21)
    largest = float(np.max(np.abs(box.slip(time))))
    assert largest > 0.005
    np.testing.assert_allclose(box.displacement(time), expected, atol=1e-2 * largest)
    np.testing.assert_allclose(box.slip(time) + box.ground(time), expected, atol=1e-2 * largest)


@pytest.mark.parametrize("impact", [SpringImpact(1700.0, 4e5, 9.81, 1.3), SpringImpact(20.0, 9e4, 1.62, 0.4)])
def test_the_landing_on_a_spring_is_that_of_its_equation(impact):
    def rates(_, state):
        return [state[1], impact.gravity - impact.stiffness / impact.mass * state[0]]

    time = np.linspace(0, impact.duration, 4001)
    sinking = solve_ivp(rates, (0, time[-1]), [0.0, impact.speed], t_eval=time, rtol=1e-11, atol=1e-13).y
    np.testing.assert_allclose(impact.sinking(time), sinking[0], atol=1e-8)
    assert impact.stiffness * max(sinking[0]) == pytest.approx(impact.peak_force, rel=1e-6)
    assert sinking[0][-1] == pytest.approx(0.0, abs=1e-8)
    assert sinking[1][-1] == pytest.approx(-impact.speed, rel=1e-6)
