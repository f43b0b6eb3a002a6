"""Contact that opens through the adapters of elements and bar: columns, switches, records."""

import numpy as np
import pytest

from validation import solve
from validation.metrics.catalogue import pair
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver


@pytest.fixture
def scene():
    """A block dropped by its own weight, under a pressure; 64 quadratic elements resolve its front."""
    case = load_scene("unlocked").expand()[1]
    values = {"time.step": 2e-4, "time.steps": 200, "fem.elements": 64, "load.gravity": 9.81}
    return case.with_values(values | {"block.velocity": -0.2, "contact.gap": 1e-4, "run.solvers": ["fem", "bar"]})


def test_the_bar_opens_under_weight_and_is_what_elements_tend_to(scene):
    columns = ["displacement", "contact_pressure", "gap_m", "gap_n", "normal_force_m", "normal_force_n"]
    prepared = get_solver("bar").prepare(scene.with_values({"run.columns": columns}))
    run = prepared.run()
    history, elements = run.history, solve(scene, "fem").history
    assert history is not None and elements is not None and list(history.columns) == columns
    for name in ("displacement.l2", "pressure.l2"):
        found = pair(name, elements, history)
        assert isinstance(found, float) and 0 < found < 1e-6
    opens = [switch for switch in prepared.switches() if switch.opens]
    assert opens and np.all(history.columns["gap_m"][round(opens[0].time / 2e-4)] > 0)
    records = [prepared.contact_record(), get_solver("fem").prepare(scene).contact_record()]
    for name in ("force", "impulse", "penetration", "gap", "open_share", "velocity"):
        own, mesh = (getattr(record, name) for record in records)
        assert np.abs(own - mesh).max() <= 1e-4 * np.abs(own).max() > 0, name
    assert records[0].rebounds is not None and records[0].energies == {}
    both = history.columns["normal_force_m"] + history.columns["normal_force_n"]
    assert both == pytest.approx(2.0 * history.contact_pressure, rel=1e-15)
