"""What a start puts in, against the histories of the blocks and a closed form; what switching gains, by scheme."""

import numpy as np
import pytest
from oracles.made_cases import made_row

from validation.advice.columns import column_alarms
from validation.advice.contact_alarms import GAINED, gained
from validation.advice.overshoot import OVERSHOOT, overshoot_alarms, start_rise
from validation.runs.contact import STORED
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver

CH = {"time.scheme": "chung-hulbert", "time.rho_inf": 0.0, "time.start": "consistent", "time.steps": 20}
BLOCK = load_scene("figures-3-4").with_values({"time.step": 0.01, "contact.law": "unilateral"})


def measured_rise(scene):
    prepared = get_solver("dda").prepare(scene)
    prepared.keeps_contact_record = True
    prepared.run()
    record = prepared.contact_record()
    energy = np.sum([record.energies[name] for name in STORED], axis=0)
    return max(0.0, float(np.max(energy)) - record.start_energy) / record.input_energy


@pytest.mark.parametrize(
    ("stiffness", "step", "rise"),
    [(1e9, 0.01906, 5.371), (1e9, 0.01, 1.341), (1e9, 0.002, 0.02173), (1e10, 0.01, 1.981)],
)
def test_a_start_raises_the_energy_as_the_modes_say(stiffness, step, rise):
    scene = BLOCK.with_values(CH | {"contact.stiffness": stiffness, "time.step": step})
    assert start_rise(scene) == pytest.approx(measured_rise(scene), rel=1e-9) == pytest.approx(rise, rel=1e-3)
    (alarm,) = overshoot_alarms(scene, {"dda": made_row("dda", {})})
    assert alarm.kind == OVERSHOOT and alarm.values["rise"] == start_rise(scene)


@pytest.mark.parametrize(
    "changes",
    [
        {"time.start": "zero"},
        {"time.step": 0.001},
        {"load.ramp": 0.1},
        {"contact.gap": 0.01},
        {"time.scheme": "composite"},
    ],
)
def test_no_start_is_blamed_that_adds_nothing(changes):
    assert not list(overshoot_alarms(BLOCK.with_values(CH | changes), {"dda": made_row("dda", {})}))


SPLIT = {"energy.given": 100.0, "energy.switching_gain": 0.585, "energy.lost_switching": -58.5, "switches.count": 4.0}


@pytest.mark.parametrize(
    ("changes", "algorithmic", "gain"),
    [
        ({}, 70.0, 0.585),  # of (1/2, 1) the split is an energy
        (CH, 70.0, None),  # the scheme has lost 11.5 J together
        (CH, 50.0, 0.085),
        ({"time.alpha": 0.5625}, 70.0, None),
    ],
)
def test_what_switching_gains(changes, algorithmic, gain):
    alarms = list(gained(BLOCK.with_values(changes), made_row("dda", SPLIT | {"energy.lost_algorithmic": algorithmic})))
    assert [alarm.values["gain"] for alarm in alarms] == pytest.approx([] if gain is None else [gain])


@pytest.mark.parametrize(("share", "kinds"), [(-0.0116, set()), (0.2, {GAINED})])
def test_a_column_is_blamed_for_what_it_has_gained(share, kinds):
    scene = load_scene("columns-weight")
    row = made_row("dda", {"energy.given": 1.0, "energy.switching_gain": share, "switches.count": 9.0})
    assert {alarm.kind for alarm in column_alarms(scene, row)} == kinds
