"""The study of published impacts: its gates hold, and each is bitten by a fault of data or of what is found."""

import math

import pytest
from faults import seams
from faults.fault import Fault, scaled, told
from faults.kill_matrix import cases_of, check_kill_matrix

from validation.studies.impacts import formulas as impacts
from validation.suite.bands import cases
from validation.suite.folders import get_study

BLOCK, BAR = ("block-events",), ("bar-events",)
FAULTS = [
    Fault("block: springs", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=1.01)),
    Fault("block: speed and fall", BLOCK, seams.EVENTS_BLOCK, scaled(velocity=1 + 1e-9, gap=1 + 1e-9)),
    Fault("block: density", BLOCK, seams.EVENTS_BLOCK, scaled(density=1 + 1e-8)),
    Fault("block: density, coarsely", BLOCK, seams.EVENTS_BLOCK, scaled(density=1 + 1e-5)),
    Fault("block: springs a hundredth as stiff", BLOCK, seams.EVENTS_BLOCK, scaled(stiffness=0.01)),
    Fault("bar: springs", BAR, seams.EVENTS_BAR, scaled(base_stiffness=1.01)),
    Fault("bar: gap", BAR, seams.EVENTS_BAR, scaled(gap=1 + 1e-9)),
    Fault("bar: density", BAR, seams.EVENTS_BAR, scaled(density=1 + 1e-8)),
    Fault("bar: springs a hundredth as stiff", BAR, seams.EVENTS_BAR, scaled(base_stiffness=0.01)),
    Fault("dda: gaps", ("dda",), seams.DDA_OPENED, told(lambda r: {"gap": 1.001 * r.gap})),
]


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    gates = get_study("impacts").gates()
    check_kill_matrix(
        get_study("impacts"), cases_of(get_study("impacts"), gates), gates, FAULTS, tmp_path, finished_cases
    )


@pytest.mark.parametrize(("ratio", "known"), [(10, 2.0839173495), (100, 2.00839173495)])
def test_the_closed_form_of_a_release_is_that_of_the_independent_program(ratio, known):
    """At p/E = 10 and 100 the impacts of the bar are stiff: e^(-2 F) is left out."""
    (case,) = (case for case in cases("impact") if case.contact.stiffness == ratio * case.block.young)
    assert impacts.release(case) / impacts.transit(case) == pytest.approx(known, abs=1e-11)


def test_the_scenes_hold_the_published_data():
    inch, pound = 0.0254, 4.4482216152605
    (rod,), (bar,), (mass,) = (tuple(cases(name)) for name in ("ansys-vm265", "siconos-bar", "bouncing-mass"))
    assert rod.block.young == pytest.approx(3e7 * pound / inch**2, rel=1e-12)
    assert rod.block.density == pytest.approx(0.73e-3 * pound / inch**4, rel=1e-12)
    assert (rod.block.velocity, rod.contact.gap) == pytest.approx((-202.2 * inch, 0.01 * inch), rel=1e-12)
    assert impacts.transit(rod) == pytest.approx(10 / math.sqrt(3e7 / 0.73e-3), rel=1e-12)
    assert [bar.block.young, bar.block.density, bar.block.velocity, bar.contact.gap] == [210e9, 7800.0, -0.1, 5e-5]
    landing, leaving, depth = impacts.bounce(mass)
    assert landing == pytest.approx((math.sqrt(41) - 1) / 10)
    assert leaving - landing == pytest.approx(0.2 * (math.pi - math.atan(math.sqrt(41))))
    assert depth == pytest.approx(0.1 + math.sqrt(0.01 + 0.41))
    assert all(impacts.stiffness_ratio(case) == pytest.approx(1e4) for case in (rod, bar))
