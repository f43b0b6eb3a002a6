"""The study of contact that opens: its gates hold, and each is bitten by a fault of the exact motions."""

import itertools
import math
from dataclasses import replace
from types import SimpleNamespace

import pytest
from faults import seams
from faults.fault import Fault, scaled, told
from faults.kill_matrix import check_study

from validation import load_scene
from validation.engine.case import Case
from validation.engine.measure import execute
from validation.metrics.catalogue import pair
from validation.suite.bands import half_unit


def pressed(found):
    """Return a history with 1e-3 Pa more on the contact."""
    return replace(found, contact_pressure=found.contact_pressure + 1e-3)


def carrying(sound):
    """Return a motion whose contact is pressed a little, where it is open as well."""

    def solve(problem, end, **options):
        motion = sound(problem, end, **options)
        names = ("switches", "touches", "simultaneous", "radius", "bars", "impacts", "cascades", "problem")
        known = {name: getattr(motion, name) for name in names if hasattr(motion, name)}
        return SimpleNamespace(at=lambda t: pressed(motion.at(t)), **known)

    return solve


def off_in_the_middle(sound):
    """Return closed forms of which that of the mid-height is off."""

    def forms(x2):
        own, across, middle = sound(x2)
        return own, across, (1 + 1e-6) * middle

    return forms


BLOCK, BAR = ("block-events",), ("bar-events",)
FAULTS = [  # of the data by parts in 1e11 and less, which move every number by about as much
    Fault("block: springs", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=1 + 4e-11)),
    Fault("block: density", BLOCK, seams.EVENTS_BLOCK, scaled(density=1 + 4e-11)),
    Fault("block: load", BLOCK, seams.EVENTS_BLOCK, scaled(pressure=1 + 4e-12)),
    Fault("bar: springs", BAR, seams.EVENTS_BAR, scaled(base_stiffness=1 + 1e-9)),
    Fault("bar: density", BAR, seams.EVENTS_BAR, scaled(density=1 + 4e-11)),
    Fault("bar: load", BAR, seams.EVENTS_BAR, scaled(pressure=1 + 4e-12)),
    Fault("block: an open contact carries something", BLOCK, seams.EVENTS_BLOCK, carrying),
    Fault("bar: an open contact carries something", BAR, seams.EVENTS_BAR, carrying),
    Fault("block: springs 1 % stiff", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=1.01)),
    Fault("block: springs 10 % stiff", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=1.1)),
    Fault("fem: mass 1e-6 heavy", ("fem",), seams.FEM_OPENED_COLUMN, told(lambda model: {"M": (1 + 1e-6) * model.M})),
    Fault("bar: mid-height 1e-6 off", ("bar",), seams.BAR_OPENED, off_in_the_middle),
]


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    check_study("opening", FAULTS, tmp_path, finished_cases)


@pytest.mark.parametrize(
    ("printed", "half"),
    [("-0.04033057058886", 5e-15), ("3514046.36162", 5e-6), ("-9.871e-3", 5e-7), ("41", 0.5), (1e7, 0.0)],
)
def test_the_uncertainty_of_a_printed_number_is_half_a_unit_of_its_last_digit(printed, half):
    assert half_unit(printed) == pytest.approx(half, rel=1e-9)


# ---- orders of the pairs beside those of the study's gates -----------------------------------------------------------

HALVINGS = 3  # mesh widths, of which neighbours give an order


def histories_of(scene, *solvers):
    """Return the histories of some solvers on one scene."""
    histories = [execute(Case(scene, solver), "", "")[1] for solver in solvers]
    assert None not in histories
    return [history for history in histories if history is not None]


def local_orders(alpha, delta, degree):
    """Return the order of `fem` to `bar` for each halving of elements that are at first as long as the front.

    The paper's block on p = E from A0 = 0, dt = 0.5 ms, over 0.05 s.
    """
    scheme = {"time.alpha": alpha, "time.delta": delta, "time.step": 5e-4, "time.steps": 100, "fem.degree": degree}
    scene = load_scene("unlocked-mesh").expand()[0].with_values(scheme)
    b = scene.block
    front = math.sqrt(alpha * b.young / b.density) * scene.time.step
    coarsest = math.floor(2.0 / front)
    errors = [
        pair("displacement.l2", *histories_of(scene.with_values({"fem.elements": coarsest * 2**level}), "fem", "bar"))
        for level in range(HALVINGS)
    ]
    return [math.log2(coarse / fine) for coarse, fine in itertools.pairwise(errors)]


@pytest.mark.parametrize("degree", [pytest.param(1, marks=pytest.mark.long), 2])
def test_elements_as_long_as_the_front_do_under_constant_acceleration(degree):
    assert local_orders(0.5, 1.0, degree) == pytest.approx([2.0 * degree] * 2, abs=0.1)
