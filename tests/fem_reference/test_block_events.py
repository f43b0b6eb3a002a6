"""The exact motion of the block with no-tension corners: known histories, an independent integration, a long flight."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from conftest import thinned
from oracles.integrated import integrated_block, random_problem, slipping_problem

from fem_reference.events.block_events import solve
from fem_reference.events.block_model import BlockProblem
from fem_reference.events.contacts import OPEN, RELEASED
from fem_reference.events.switches import TooManySwitchesError

PAPER = BlockProblem(2.0, 2.0, 2700.0, 1e9, 1e9, 5e6)
OTHER = BlockProblem(1.5, 1.5, 2400.0, 3e9, 7e9, 2e6)


def travel(problem):
    return problem.height * float(np.sqrt(problem.density / problem.young))


def switch_times(motion, corner="M"):
    return [switch.time for switch in motion.switches if switch.corner == corner]


# Switch times [s], then v [m] and contact pressure [Pa] at 3, 6 and 9 a/c, from modes in 40 and 55 digits of mpmath
# and from DOP853 with events. The printed values have 14 digits.
HISTORIES = [
    (
        PAPER,
        [0.0032525750597312, 0.016134552097502, 0.021468455011596, 0.03563489393917],
        [-0.019624767959151, 0.00031590245481852, -0.019792101285884],
        [13384420.7848, 0.0, 12124063.0636],
    ),
    (
        replace(PAPER, stiffness=1e10),
        [0.0032525750597312, 0.0047189535282337, 0.005374160611419, 0.0071061595529526, 0.0075986533640999],
        [-0.0048476533988349, -0.0088697687782978, -0.0010994013033985],
        [0.0, 18266488.6556, 0.0],
    ),
    (
        replace(PAPER, stiffness=1e11),
        [0.0032525750597312, 0.0036444191050135, 0.0048646595917341, 0.0052726003696245],
        [-0.003068644722673, -0.0093443226036173, -0.0028873908199839],
        [23168703.7452, 0.0, 37093254.2842],
    ),
    (
        replace(PAPER, stiffness=1e8),
        [0.0032525750597312],
        [-0.04033057058886, -0.10229735564167, -0.094205442534319],
        [3514046.36162, 9315343.22438, 8945681.08903],
    ),
    (
        OTHER,
        [0.0013278582077407, 0.0054491055360487, 0.0072447406133871, 0.012414067088762],
        [-0.001084027898671, -0.00053332069995014, -0.0002011086784352],
        [2295755.40506, 783059.484839, 708455.684826],
    ),
]


@pytest.mark.parametrize(("problem", "switches", "displacement", "pressure"), thinned(HISTORIES, 4))
def test_a_pressed_block_lifts_off_and_lands_as_computed_elsewhere(problem, switches, displacement, pressure):
    motion = solve(problem, 12 * travel(problem))
    assert motion.closed_at_start == (False, False)
    assert switch_times(motion)[: len(switches)] == pytest.approx(switches, rel=2e-13)
    assert switch_times(motion, "N") == switch_times(motion)
    history = motion.at(np.array([3, 6, 9]) * travel(problem))
    assert history.displacement[1] == pytest.approx(displacement, rel=2e-13, abs=1e-17)
    assert history.contact_pressure == pytest.approx(pressure, rel=5e-12)  # printed with twelve digits


def dashpot(seed, zeta):
    """A random block with the dashpot of each corner for c = 2 zeta sqrt(k m) of both, k = 2p."""
    problem = replace(random_problem(seed), shear_stiffness=0.0)
    m = problem.density * problem.width * problem.height
    return replace(problem, damping=zeta * math.sqrt(2 * problem.stiffness * m))


SLIPPING = [(seed, moved) for seed in (1, 8) for moved in (False, True)]
INTEGRATED = [
    *((random_problem(seed), 5) for seed in (5, 0, 1)),
    *((dashpot(*one), 8) for one in [(50, 0.1), (51, 0.8), (52, 0.3)]),
    *((slipping_problem(*one), 5) for one in SLIPPING),
]


@pytest.mark.parametrize(("problem", "travels"), thinned(INTEGRATED, len(INTEGRATED)))
def test_an_independent_integration_with_events_agrees(problem, travels):
    end = travels * travel(problem)
    motion = solve(problem, end)
    # DOP853 at rtol 1e-13 is good to about 1e-11 here; every switch amplifies that, by up to ten in these problems
    switches, y = integrated_block(problem, [int(state) for state in motion.nodes[0].states], end)
    assert switches
    opened = [(corner, state in (OPEN, RELEASED)) for _, corner, state in switches]
    assert [(s.corner, s.kind == "opens") for s in motion.switches] == opened
    assert [s.time for s in motion.switches] == pytest.approx([time for time, _, _ in switches], abs=1e-8 * end)
    history = motion.at([end])
    assert history.displacement[:, 0] == pytest.approx(y[:6], abs=1e-8 * np.abs(y[:6]).max())
    assert history.velocity[:, 0] == pytest.approx(y[6:], abs=1e-7 * np.abs(y[6:]).max())


def test_a_long_flight_keeps_its_digits():
    """Pulled up for 100 radians: v = -q t^2 / (2 rho b), ey = -(q / 2E) (1 - cos w t), w = sqrt(12) c / b."""
    problem = replace(OTHER, pressure=-2e6, gap=1.0)
    end = 100 / np.sqrt(12) * travel(problem)
    motion = solve(problem, end)
    t = np.linspace(0.9, 1.0, 50) * end
    history = motion.at(t)
    with mpmath.workdps(30):
        w = mpmath.sqrt(12 * mpmath.mpf(problem.young) / problem.density) / problem.height
        angle = [float(1 - mpmath.cos(w * mpmath.mpf(x))) for x in t]
    assert not motion.switches
    assert history.displacement[1] == pytest.approx(2e6 / (2 * 2400.0 * 1.5) * t**2, rel=1e-14)
    # 60 rad in a float are rounded by 1e-14, 1000 rad would be by 1e-13
    assert history.displacement[4] == pytest.approx(2e6 / 6e9 * np.array(angle), abs=4e-14 * 2e6 / 3e9)


def test_more_switches_than_are_allowed_end_the_motion():
    with pytest.raises(TooManySwitchesError):
        solve(PAPER, 0.2, limit=3)
