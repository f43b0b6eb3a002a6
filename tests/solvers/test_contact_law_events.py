"""The exact block on dashpots and under an impact law through its adapter."""

import math

import numpy as np
import pytest

from validation.metrics.contact import imbalance
from validation.scenes.scene import Scene, load_scene
from validation.solvers.registry import get_solver

AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
IMPACT = AVERAGE | {
    "contact.stiffness": math.inf,
    "contact.shear_stiffness": 0.0,
    "contact.rule": "impact",
    "contact.restitution": 0.5,
}


@pytest.fixture
def scene() -> Scene:
    """A pressed block that lifts off and lands."""
    case = load_scene("unlocked").expand()[1]
    return case.with_values({"time.step": 1e-4, "time.steps": 100, "load.gravity": 9.81})


@pytest.mark.parametrize(("values", "loss"), [({"contact.restitution": 0.6}, "dashpot"), (IMPACT, "impact")])
def test_what_contacts_lose_closes_the_energy(scene: Scene, values: dict, loss: str) -> None:
    prepared = get_solver("block-events").prepare(scene.with_values(AVERAGE | values))
    run, record = prepared.run(), prepared.contact_record()
    assert run.outcome.value == "completed"
    assert record.energies[loss][-1] > 1e-3 * record.input_energy
    assert np.all(np.diff(record.energies[loss]) > -1e-10 * record.input_energy)
    assert float(imbalance(record)) < 1e-12  # type: ignore[arg-type]


def test_an_impact_law_reports_its_impacts_and_where_they_accumulate(scene: Scene) -> None:
    prepared = get_solver("block-events").prepare(scene.with_values(IMPACT))
    run, record = prepared.run(), prepared.contact_record()
    assert record.rebounds is not None
    assert {rebound.restitution for rebound in record.rebounds} == {0.5}
    assert [note for note in run.notes if "accumulate at 0.00" in note]
    assert [note for note in run.notes if "whose impulses are no part of the forces" in note]
    motion = prepared.motion  # type: ignore[attr-defined]
    events = (*motion.impacts, *motion.cascades)
    resting = record.impulse[-1] - sum(event.impulse for event in events)
    assert 0 < resting < record.impulse[-1]
    assert record.penetration.max() < 1e-16  # at impacts, whose instants floats round
    kinds = [(switch.time, switch.opens) for switch in prepared.switches() if switch.corner == "M"]
    assert kinds[0][0] == kinds[1][0] == motion.impacts[0].time == pytest.approx(3.2388e-3, rel=1e-4)  # with weight
    assert [opens for _, opens in kinds[:2]] == [False, True]
