"""Metrics of a contact: closed forms on made records, identities on runs, and the horizon of two correct codes."""

from dataclasses import replace

import numpy as np
import pytest

from validation.engine.horizon import shadow
from validation.metrics.catalogue import solo
from validation.metrics.measurable import Measurable
from validation.metrics.pairs import relative_max
from validation.metrics.values import NOT_REPORTED, UNDEFINED
from validation.runs.contact import ContactRecord
from validation.runs.history import History
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver, solve

STEP = 0.5
ONES = np.ones(4)
MADE = ContactRecord(  # a mass of 2 kg that comes down with 3 m/s, touches in the second step and leaves with 1 m/s
    time=STEP * np.arange(1.0, 5.0),
    force=np.array([0.0, 8.0, 0.0, 0.0]),
    impulse=np.array([0.0, 8.0, 8.0, 8.0]),
    penetration=np.array([0.0, 0.25, 0.0, 0.0]),
    gap=np.array([1.5, 0.0, 0.5, 1.0]),
    open_share=np.array([1.0, 0.0, 1.0, 1.0]),
    start_velocity=-3.0,
    start_energy=9.0,
    input_energy=10.0,
    velocity=np.array([-3.0, 2.0, 1.0, 1.0]),
    energies={
        "kinetic": np.array([9.0, 0.0, 1.0, 1.0]),
        "strain": 0.0 * ONES,
        "springs": np.array([0.0, 12.0, 0.0, 0.0]),
        "load": 0.0 * ONES,
        "algorithmic": np.array([0.0, 1.0, 4.0, 4.0]),
        "kinetic damping": np.array([0.0, 0.0, 1.5, 1.5]),
        "switching": np.array([0.0, -4.0, 2.5, 2.5]),
    },
    solves=np.array([1.0, 2.0, 2.0, 1.0]),
    cuts=np.array([0.0, 1.0, 0.0, 0.0]),
)
EXPECTED = {
    "contact.impulse": 8.0,
    "contact.peak_force": 8.0,
    "contact.penetration": 0.25,
    "contact.gap": 1.5,
    "contact.open_share": 0.75,
    "contact.mean_solves": 1.5,
    "contact.p99_solves": 2.0,
    "contact.most_solves": 2.0,
    "contact.cuts": 1.0,
    "contact.restitution": 1 / 3,
    "energy.rise": 0.3,
    "energy.switching_gain": -0.25,
    "energy.imbalance": 0.0,
    "energy.kinetic": 1.0,
    "energy.springs": 0.0,
    "energy.lost_algorithmic": 4.0,
    "energy.lost_kinetic_damping": 1.5,
    "energy.lost_switching": 2.5,
}


def measured(record):
    return solo(Measurable(History(np.zeros(0), {}), STEP, contact=record), ("switches",))


def test_each_metric_of_a_made_contact_is_its_closed_form():
    balanced = MADE.energies | {"springs": np.array([0.0, 12.0, 0.0, 0.0])}
    found = measured(replace(MADE, energies=balanced))
    assert {name: found[name] for name in EXPECTED} == pytest.approx(EXPECTED)


def test_one_step_in_a_hundred_may_take_more_solves():
    solves = np.ones(1000)
    solves[:20] = 2.0
    solves[0] = 9.0
    found = measured(replace(MADE, solves=solves))
    assert (found["contact.p99_solves"], found["contact.most_solves"]) == (2.0, 9.0)
    solves[10:] = 1.0
    assert measured(replace(MADE, solves=solves))["contact.p99_solves"] == 1.0


def test_slip_and_changes_of_state_are_counted():
    found = measured(replace(MADE, slip=np.array([0.0, 1e-3, 2e-3, 5e-3])))
    assert found["contact.slip"] == 5e-3
    assert found["contact.slip_rate"] == pytest.approx(3e-3 / STEP)  # of the last of four steps alone
    assert measured(MADE)["contact.slip"] == measured(MADE)["contact.slip_rate"] == NOT_REPORTED
    states = {"state_m": np.array([1.0, 2.0, 2.0, 0.0]), "state_n": np.array([1.0, 1.0, -2.0, 1.0])}
    seen = solo(Measurable(History(np.arange(4.0), states), STEP, contact=MADE), ("switches",))
    assert seen["contact.state_changes"] == 4
    assert measured(MADE)["contact.state_changes"] == NOT_REPORTED


def test_what_is_not_reported_or_has_no_meaning_says_so():
    assert {measured(None)[key] for key in EXPECTED} == {NOT_REPORTED}
    bare = replace(MADE, velocity=None, energies={}, solves=None, cuts=None)
    assert measured(bare)["contact.restitution"] == measured(bare)["energy.rise"] == NOT_REPORTED
    flying = replace(MADE, force=0 * MADE.force, rebounds=())
    assert measured(flying)["contact.restitution"] == measured(flying)["contact.restitution_mean"] == UNDEFINED
    assert measured(replace(MADE, input_energy=0.0))["energy.rise"] == UNDEFINED


def test_another_code_is_apart_by_little_more_than_rounding():
    scene = load_scene("cost-opening").with_values({"time.steps": 60})
    other = shadow(get_solver("dda"), scene, False)
    assert 1e-14 < relative_max(other.displacement, solve(scene, "dda").displacement) < 1e-10
