"""The study of published impacts: its gates hold, and each is bitten by a fault of data or of what is found."""

import pytest
from faults import seams
from faults.fault import Fault, scaled, told
from faults.kill_matrix import check_study

from validation.studies.impacts import formulas as impacts
from validation.suite.bands import cases

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
    check_study("impacts", FAULTS, tmp_path, finished_cases)


@pytest.mark.parametrize(("ratio", "known"), [(10, 2.0839173495), (100, 2.00839173495)])
def test_the_closed_form_of_a_release_is_that_of_the_independent_program(ratio, known):
    """At p/E = 10 and 100 the impacts of the bar are stiff: e^(-2 F) is left out."""
    (case,) = (case for case in cases("impact") if case.contact.stiffness == ratio * case.block.young)
    assert impacts.release(case) / impacts.transit(case) == pytest.approx(known, abs=1e-11)
