"""The exact motion of the block with friction: known histories, an independent integration, identities."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.integrated import slipping_problem

from fem_reference.events.block_events import solve
from fem_reference.events.block_model import BlockProblem
from fem_reference.events.contacts import RIGHT, STICKS

HALF = math.degrees(math.atan(0.5))  # tan(phi) = 0.5
PAPER = BlockProblem(2.0, 2.0, 2700.0, 1e9, 1e9, 5e6, shear_stiffness=1e9)
OFF_CENTRE = replace(PAPER, eccentricity=0.3, friction=HALF)
SIDEWAYS = replace(PAPER, traction=2e6, friction=HALF, poisson=0.25)
INCLINE = replace(PAPER, pressure=0.0, gravity=9.81, slope=20.0, friction=30.0, shear_stiffness=0.4e9)

# First switches [s] with twelve digits, and (u, v, r) at an instant, from DOP853 with events at rtol 3e-14 and 1e-12.
KNOWN = [
    (
        OFF_CENTRE,
        "N closes 0.00239892830043, M closes 0.00407094907289, M slips 0.00745377531356, M sticks 0.00793488628924, "
        "M slips 0.0157425143698, N slips 0.0159420213648, N opens 0.0163181298089, M opens 0.0163241226119",
        {
            0.01: [1.432096486408e-3, -1.344857861701e-2, -1.327505388538e-3],
            0.03: [-3.680080923643e-4, -1.251962754476e-2, -1.923369471946e-3],
        },
    ),
    (
        SIDEWAYS,
        "N closes 0.00283945305465, M closes 0.00386752417274, M slips 0.00601093182843, M sticks 0.00703740618764, "
        "M slips 0.00938196465955, M opens 0.0124246870787",
        {0.03: [5.135338437750e-2, -8.977369811162e-3, -1.753606771872e-2]},
    ),
    (
        INCLINE,
        "M slips 0.0117360653442, N slips 0.014596773248, M opens 0.01461062328, N opens 0.0186019905401, "
        "M closes 0.0193636210678",
        {0.05: [8.660335668094e-4, -9.241387969921e-5, -5.024326498383e-5]},
    ),
]


@pytest.mark.parametrize(("problem", "switches", "values"), thinned(KNOWN, 3))
def test_the_motion_is_that_computed_elsewhere(problem, switches, values):
    motion = solve(problem, max(values))
    known = [one.split() for one in switches.split(", ")]
    found = motion.switches[: len(known)]
    assert [[s.corner, s.kind] for s in found] == [one[:2] for one in known]
    # twelve digits are printed, half a unit of which is 5e-14 s, of an integration that is good to 4e-13 of the run
    assert [s.time for s in found] == pytest.approx([float(one[2]) for one in known], rel=0, abs=6e-14)
    for time, expected in values.items():
        assert motion.at([time]).displacement[:3, 0] == pytest.approx(expected, rel=5e-11)


def limit(problem, normal):
    return math.tan(math.radians(problem.friction or 0)) * normal + problem.cohesion * problem.width / 2


@pytest.mark.parametrize(
    ("seed", "moved"), thinned([(i, moved) for i in (21, 20, 22, 23) for moved in (False, True)], 8)
)
def test_energy_law_and_the_digits_of_random_motions(seed, moved):
    problem = slipping_problem(seed, moved)
    end = 4 * problem.height * math.sqrt(problem.density / problem.young)
    motion, finer = solve(problem, end), solve(problem, end, digits=70)
    assert motion.switches == finer.switches
    t = np.sort(np.concatenate([np.linspace(0, end, 60), [s.time for s in motion.switches]]))
    history, other = motion.at(t), finer.at(t)
    # a float rounds terms of a series that cancel by up to e^4, sixty radians of a sine by 1e-14
    for name in ("displacement", "velocity", "gap", "normal_force", "shear_force", "slide", "slipped", "friction"):
        a, b = getattr(history, name), getattr(other, name)
        assert np.abs(a - b).max() <= 1e-13 * np.abs(b).max(), name
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
