"""The study of contact that opens: what a printed number is good for, and orders beside those of its gates."""

import itertools
import math

import pytest

from validation import load_scene
from validation.engine.case import Case
from validation.engine.measure import execute
from validation.metrics.catalogue import pair
from validation.suite.bands import half_unit


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
