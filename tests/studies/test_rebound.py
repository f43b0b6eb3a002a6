"""The study `rebound`: its gates hold, each is bitten by a fault, and its scenes are what they say."""

import math
from dataclasses import replace

import numpy as np
import pytest
from faults import seams
from faults.fault import Fault, energy_changed, told
from faults.kill_matrix import check_study

from validation.studies.rebound import formulas as rebound
from validation.suite.folders import get_study
from validation.suite.own_solver.gates import applies


def fewer(sound):
    """Lose the last switch."""

    def solve(*a, **k):
        motion = sound(*a, **k)
        return replace(motion, switches=motion.switches[:-1])

    return solve


DDA = ("dda",)
FAULTS = [
    Fault("one more solve counted", DDA, seams.DDA_OPENED, told(lambda r: {"step_solves": r.step_solves + 2})),
    Fault("a rebound a millionth too fast", DDA, seams.DDA_OPENED,
          told(lambda r: {"velocity": r.velocity + 1e-6 * np.maximum(r.velocity, 0.0)})),
    Fault("a few joules too many", DDA, seams.DDA_OPENED, energy_changed("kinetic", lambda e: e + 9e4)),
    Fault("a switch lost", ("block-events",), seams.EVENTS_BLOCK, fewer),
    Fault("map a thousandth high", ("map",), seams.RESTITUTION_STATISTICS,
          told(lambda s: {name: getattr(s, name) + 1e-3 for name in ("mean", "low", "high", "mean_square")})),
]  # fmt: skip


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    check_study("rebound", FAULTS[:-1], tmp_path, finished_cases, lambda gate: gate.scene != rebound.MAP)


def test_the_gates_of_the_map_are_bitten(monkeypatch):
    gates = [gate for gate in get_study("rebound").gates() if gate.scene == rebound.MAP]
    rows = {row.name: row for row in rebound.derived() if row.scene == rebound.MAP}

    def failing():
        values = {gate.id: rows[gate.pair[0]].compute(None)[gate.metric] for gate in gates}
        return {gate.id for gate in gates if not gate.low <= values[gate.id] <= gate.high}

    assert len(gates) == 20 and not failing()
    with monkeypatch.context() as patch:
        FAULTS[-1].seam.wrap(patch, FAULTS[-1].replacement)
        assert failing() == {gate.id for gate in gates}


def test_the_closed_forms_of_a_rigid_contact():
    """(1/2, 1) returns |2 theta - 1|; (1/4, 1/2) 3 - 8 theta up to 1/3, then 4 theta - 1."""
    for theta in (0.05, 0.25, 0.4, 0.77):
        assert rebound.impact_restitution(0.5, 1.0, 1.0, math.inf, theta) == pytest.approx(abs(2 * theta - 1))
        average = 3 - 8 * theta if theta < 1 / 3 else 4 * theta - 1
        assert rebound.impact_restitution(0.25, 0.5, 1.0, math.inf, theta) == pytest.approx(average)


def test_a_users_solver_is_not_asked_for_contact_that_opens():
    opening = [gate for gate in get_study("rebound").gates() if gate.pair == DDA]
    assert opening and not any(applies("rebound", gate) for gate in opening)
