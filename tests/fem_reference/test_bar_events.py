"""The exact motion of the bar on a no-tension spring: known histories, states at rest."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned

from fem_reference.events.bar_events import solve
from fem_reference.events.switches import TooManySwitchesError
from fem_reference.problem.bar import BarProblem

PAPER = BarProblem(height=2.0, width=2.0, density=2700.0, young=1e9, base_stiffness=2e9, pressure=5e6)
OTHER = BarProblem(height=1.5, width=1.5, density=2400.0, young=3e9, base_stiffness=14e9, pressure=2e6)


def switch_times(motion):
    return [switch.time for switch in motion.switches]


# Switch times [s], opening first, then the mid-height displacement [m] and the contact pressure [Pa] at 3, 6 and
# 9 a/c, from 80 digits of mpmath and from DOP853 on the delay equation. The printed values have 11 to 14 digits.
HISTORIES = [
    (
        PAPER,
        [0.017964507628979, 0.021939461028721, 0.036795023684005],
        [-0.020823334904607, 0.00098044250944556, -0.02038367296426],
        [9816843.61111, 0.0, 12103775.169],
    ),
    (
        replace(PAPER, base_stiffness=2e8),
        [],
        [-0.040434436128232, -0.10289879033026, -0.095775969499755],
        [3296799.53964, 9552769.44911, 8469680.76381],
    ),
    (
        OTHER,
        [0.0069218140380999, 0.0077222679298686, 0.012238800061209, 0.012590286189158],
        [-0.0013151926357872, -0.0005435745686584, -0.00024876401613106],
        [3999646.29205, 2017632.42198, 362338.26179],
    ),
]


@pytest.mark.parametrize(("problem", "switches", "displacement", "pressure"), thinned(HISTORIES, 3))
def test_a_pressed_bar_lifts_off_and_lands_as_computed_elsewhere(problem, switches, displacement, pressure):
    motion = solve(problem, 12 * problem.travel)
    assert motion.closed_at_start
    assert [s.kind for s in motion.switches[:2]] == ["opens", "closes"][: len(motion.switches)]
    assert switch_times(motion)[: len(switches)] == pytest.approx(switches, rel=2e-13)
    assert bool(switches) == bool(motion.switches)
    # a hair earlier: at 9 a/c a front arrives, and a rounded instant may lie behind it
    history = motion.at(np.array([3, 6, 9]) * problem.travel * (1 - 1e-15))
    assert history.displacement == pytest.approx(displacement, rel=1e-12)
    assert history.contact_pressure == pytest.approx(pressure, rel=1e-11, abs=5e-8)


def test_resting_states():
    still = solve(replace(PAPER, pressure=0.0), 0.02)
    assert still.closed_at_start
    assert not still.switches
    assert not still.at([0.01]).displacement.any()
    pulled = solve(replace(PAPER, pressure=-5e6), 0.02)
    assert switch_times(pulled) == pytest.approx([PAPER.travel], rel=1e-15)  # the front lifts the base at once
    hovering = solve(replace(PAPER, pressure=0.0, gap=0.1), 0.02)
    assert not hovering.closed_at_start
    assert not hovering.switches


def test_more_switches_than_are_allowed_end_the_motion():
    assert len(solve(PAPER, 0.023, limit=3).switches) == 2  # one more is the first touch
    with pytest.raises(TooManySwitchesError):
        solve(PAPER, 0.023, limit=2)
