"""The exact motion of the block with friction: energy, the law, and digits of random motions."""

import math

import numpy as np
import pytest
from conftest import thinned
from flint import arb
from oracles.integrated import slipping_problem

from fem_reference.events.block_events import solve
from fem_reference.events.contacts import RIGHT, STICKS
from fem_reference.events.enclosure import bits_of, precision


def limit(problem, normal):
    return math.tan(math.radians(problem.friction or 0)) * normal + problem.cohesion * problem.width / 2


@pytest.mark.parametrize(
    ("seed", "moved"), thinned([(i, moved) for i in (21, 20, 22, 23) for moved in (False, True)], 8)
)
def test_energy_law_and_the_digits_of_random_motions(seed, moved):
    problem = slipping_problem(seed, moved)
    end = 3 * problem.height * math.sqrt(problem.density / problem.young)
    motion = solve(problem, end, digits=30)
    finer = solve(problem, end, digits=70)
    assert motion.switches == finer.switches and motion.digits == 30 and finer.radius < 1e-35 * end
    with precision(bits_of(100)):
        for switch, true in zip(motion.switches, finer.switches, strict=True):
            apart = abs(arb(switch.midpoint) - arb(true.midpoint))
            assert apart < arb(switch.radius + true.radius) + arb(switch.time) * arb("1e-39")  # as printed
    t = np.sort(np.concatenate([np.linspace(0, end, 60), [s.time for s in motion.switches]]))
    history, other = motion.at(t), finer.at(t)
    # a float rounds terms of a series that cancel by up to e^4, sixty radians of a sine by 1e-14
    for name in ("displacement", "velocity", "gap", "normal_force", "shear_force", "slide", "slipped", "friction"):
        a, b = getattr(history, name), getattr(other, name)
        assert np.abs(a - b).max() <= 1e-13 * np.abs(b).max(), name
    off = np.abs(history.displacement - other.displacement)
    assert np.all(off <= history.displacement_radius + other.displacement_radius)
    assert history.displacement_radius.max() < 1e-12 * np.abs(history.displacement).max()
    scale = history.kinetic.max() + history.strain.max() + np.abs(history.load).max()
    assert np.abs(history.energy - history.energy[0]).max() <= 1e-13 * scale
    assert np.diff(history.friction).min() >= -1e-13 * scale
    bound, size = limit(problem, history.normal_force), 1e-12 * np.abs(history.normal_force).max()
    assert np.all(np.abs(history.shear_force) <= history.closed * bound + size)
    slips = np.abs(history.states) == RIGHT
    assert (history.friction[-1] > 0) == slips.any()
    assert slips.any() == ("slips" in {s.kind for s in motion.switches} or 2 in np.abs(motion.nodes[0].states))
    assert np.abs(history.shear_force + np.sign(history.states) * bound)[slips].max(initial=0.0) <= size
    for c in (0, 1):  # the reference goes where the corner slips to, and only then
        moved, states = np.diff(history.slipped[c]), history.states[c, :-1]
        assert np.all(np.sign(states) * moved * (np.abs(states) == RIGHT) >= -1e-14)
        assert np.abs(moved[(states == STICKS) & (history.states[c, 1:] == STICKS)]).max(initial=0.0) <= 1e-14
