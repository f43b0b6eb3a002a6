"""The adapter of `dda` for columns whose contacts open or slip: columns, switches, record and outcomes of a scene."""

import numpy as np
import pytest
from conftest import thinned

from validation.scenes.scene import load_scene
from validation.solvers.registry import get_solver


@pytest.mark.parametrize(
    ("case", "lowest", "highest"),
    thinned([(0, -23.765, -1.320), (1, -22.386, 2.107), (2, -24.06, -1.71), pytest.param(3, -17.92, -0.013)], 4),
)
def test_residual_slips_of_a_site_are_those_of_an_independent_program(case, lowest, highest):
    scene = load_scene("columns-slips-steps").expand()[case]
    prepared = get_solver("dda").prepare(scene)
    history = prepared.run().history
    digits = 6e-4 if case < 2 else 6e-3
    assert 1e3 * history.columns["slip_1"][-1] == pytest.approx(lowest, abs=digits)
    assert 1e3 * history.columns["slip_5"][-1] == pytest.approx(highest, abs=digits)
    record = prepared.contact_record()
    assert record.slip is not None
    assert record.slip[-1] == np.abs([history.columns[f"slip_{k}"][-1] for k in range(1, 6)]).max()
    assert record.energies["friction"][-1] > 0
    assert not record.open_share.any() and not record.gap.any()
    switches = prepared.switches()
    assert {switch.opens for switch in switches} == {None}
    assert min(switches, key=lambda switch: switch.time).slips
    assert {switch.slips for switch in switches} == {True, False}
