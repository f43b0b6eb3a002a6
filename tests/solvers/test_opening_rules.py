"""Sub-blocks on contact that opens, through the adapter `dda`: what they report."""

import numpy as np
import pytest

from validation.metrics.contact import imbalance
from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver


@pytest.fixture
def scene():
    """A pressed block that lands, opens and lands again."""
    case = load_scene("unlocked").expand()[1]
    return case.with_values({"time.step": 1e-4, "time.steps": 150, "load.gravity": 9.81, "block.velocity": -0.2})


# ---- sub-blocks -----------------------------------------------------------------------------------------------------

COLUMNS = ["displacement", "contact_pressure", "gap_m", "gap_n", "normal_force_m", "shear_force_n", "solves", "cuts"]


def test_sub_blocks_report_what_their_contact_did(scene):
    case = scene.with_values({"run.columns": COLUMNS, "block.subdivide": [2, 2], "time.steps": 120})
    prepared = get_solver("dda").prepare(case)
    run, record = prepared.run(), prepared.contact_record()
    assert run.history is not None and run.history.columns["solves"].max() >= 2 and prepared.switches()
    assert record.force == pytest.approx(2.0 * run.history.contact_pressure, rel=1e-12)
    assert set(np.unique(record.open_share)) <= {0.0, 0.5, 1.0} and float(imbalance(record)) < 1e-9
