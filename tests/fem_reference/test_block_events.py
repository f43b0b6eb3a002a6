"""The exact motion of the block with no-tension corners: an independent integration."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.integrated import integrated_block, random_problem, slipping_problem

from fem_reference.events.block_events import solve
from fem_reference.events.contacts import OPEN, RELEASED


def travel(problem):
    return problem.height * float(np.sqrt(problem.density / problem.young))


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
