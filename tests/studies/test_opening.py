"""The study of contact that opens: its gates hold, and each is bitten by a fault of the exact motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from faults import seams
from faults.fault import Fault, scaled, told
from faults.kill_matrix import check_kill_matrix

from validation.studies.opening import OPENING, half_unit


def pressed(found: Any) -> Any:
    """Return a history with 1e-3 Pa more on the contact."""
    return replace(found, contact_pressure=found.contact_pressure + 1e-3)


def carrying(sound: Callable[..., Any]) -> Callable[..., Any]:
    """Return a motion whose contact is pressed a little, where it is open as well."""

    def solve(problem: Any, end: float) -> Any:
        motion = sound(problem, end)
        return SimpleNamespace(switches=motion.switches, at=lambda t: pressed(motion.at(t)))

    return solve


def off_in_the_middle(sound: Callable[..., Any]) -> Callable[..., Any]:
    """Return closed forms of which that of the mid-height is off."""

    def forms(x2: Any) -> Any:
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
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path: Path, finished_cases: Path) -> None:
    cases = [case for case in OPENING.cases() if case.solver != "fenicsx"]  # not judged
    check_kill_matrix(OPENING, cases, OPENING.gates(), FAULTS, tmp_path, finished_cases)


@pytest.mark.parametrize(
    ("value", "half"), [(-0.04033057058886, 5e-15), (3514046.36162, 5e-6), (-0.0052, 0.0), (1e7, 0.0)]
)
def test_the_uncertainty_of_a_printed_number_is_half_a_unit_of_its_last_digit(value: float, half: float) -> None:
    assert half_unit(value) == pytest.approx(half, rel=1e-9)
