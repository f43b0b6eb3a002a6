"""The exact block on dashpots and under an impact law: an independent program, closed forms, what is proven."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned

from fem_reference.events.block_events import solve
from fem_reference.events.block_impacts import Hops
from fem_reference.events.block_model import BlockProblem
from fem_reference.events.switches import AccumulationError, TooManySwitchesError

PAPER = BlockProblem(2.0, 2.0, 2700.0, 1e9, 1e9, 5e6)
RIGID = replace(PAPER, stiffness=math.inf, restitution=0.0)


def dashpot(problem, zeta, mass_share=1.0):
    """With the dashpot of each corner for c = 2 zeta sqrt(k m) of both, k = 2p and m a share of the mass."""
    m = mass_share * problem.density * problem.width * problem.height
    return replace(problem, damping=zeta * math.sqrt(2 * problem.stiffness * m))


def at_events(motion, corner="M"):
    return [(switch.time, switch.kind) for switch in motion.switches if switch.corner == corner]


# -- numbers computed elsewhere: piecewise closed forms


def test_the_plastic_block():
    motion = solve(RIGID, 0.05)
    displacement = motion.at([0.01, 0.02, 0.05]).displacement[1]
    assert displacement == pytest.approx([-0.00350963748, -0.00744841152, -0.00275254957], rel=2e-9)
    times = [time for time, _ in at_events(motion)]
    assert times[:3] == pytest.approx([3.2525750597e-3, 11.1812975e-3, 14.8279748e-3], rel=1e-8)
    assert [kind for _, kind in at_events(motion)][:3] == ["closes", "opens", "closes"]
    assert motion.impacts[0].impulse == pytest.approx(10145.031, abs=1e-3)
    assert motion.impacts[0].impulse == pytest.approx(10800 / 4 * motion.impacts[0].approach, rel=1e-15)
    assert not motion.cascades


# -- closed forms


def closed_restitution(zeta):
    """e(zeta) of a rigid mass on a spring and dashpot that never pull."""
    if zeta < 1:
        s = math.sqrt(1 - zeta**2)
        return math.exp(-zeta / s * math.atan2(2 * zeta * s, 2 * zeta**2 - 1))
    if zeta == 1:
        return math.exp(-2)
    s = math.sqrt(zeta**2 - 1)
    return math.exp(-zeta / s * math.log((zeta + s) / (zeta - s)))


@pytest.mark.parametrize("zeta", thinned([0.3, 1.0, 1.5, 0.999999999], 2))
def test_a_rigid_block_rebounds_with_the_closed_form(zeta):
    """A clipped dashpot lets go at any zeta; equal and nearly equal roots are no case of their own."""
    problem = dashpot(replace(PAPER, young=math.inf, pressure=0.0, velocity=-1.3), zeta)
    motion = solve(problem, 0.05)
    assert [kind for _, kind in at_events(motion)] == ["opens"]
    history = motion.at(np.linspace(0, 0.05, 200))
    assert history.velocity[1, -1] / 1.3 == pytest.approx(closed_restitution(zeta), rel=1e-13)
    assert np.all(history.normal_force >= 0)
    released = history.gap[0, np.flatnonzero(history.closed[0] == 0)[0]]
    assert released < 0  # it lets go before the spring has come back


# -- identities


@pytest.mark.parametrize("velocity", thinned([-5.46, -5.6, -5.76], 3))
def test_a_released_corner_presses_again_before_its_gap_opens(velocity):
    """A rigid block under an acceleration g that lets go at w_1 rises evenly slower; p w + c w' is zero again at w_2.

    With w_1 = -c w_1'/p this is w_1 + w_2 = -2 (c/p)^2 g, where w' is still positive: -p w_2/c.
    """
    problem = dashpot(replace(PAPER, young=math.inf, velocity=velocity), 0.2)
    motion = solve(problem, 0.06)
    assert [kind for _, kind in at_events(motion)] == ["opens", "closes"]
    history = motion.at([time for time, _ in at_events(motion)])
    relaxation = problem.damping / problem.stiffness
    assert history.gap[0, 1] < 0
    assert history.gap[0].sum() == pytest.approx(-2 * relaxation**2 * 1e7 / 10800, rel=1e-12)
    assert history.gap_velocity[0] == pytest.approx(-history.gap[0] / relaxation, rel=1e-11)


# -- what is proven of flows and hops


def test_accumulation_that_is_not_proven_is_refused(monkeypatch):
    monkeypatch.setattr(Hops, "find_accumulation", lambda *_: None)
    with pytest.raises(AccumulationError, match="not proven") as caught:
        solve(replace(RIGID, restitution=0.3), 0.02)
    assert 0.004 < caught.value.time < 0.00402


def test_impacts_count_against_the_limit():
    with pytest.raises(TooManySwitchesError):
        solve(replace(RIGID, restitution=1.0), 0.05, limit=20)
