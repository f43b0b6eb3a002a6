"""A rigid box about its corner against the integrated pendulum."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

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
