"""Elements on a base that carries no tension: digits on stiff springs and in long flights, coarse meshes."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.elements import make

from fem_reference import Scheme, Unilateral, solve_unilateral

AVERAGE = Scheme(0.25, 0.5, 1.0, 1e-4, "consistent")
CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-4, "consistent")


def test_a_mesh_too_coarse_for_a_stiff_base_is_named():
    # h kappa = 2 p / (n E) of a square with mu = 0
    for p, words in ((1e10, "too coarse for the base spring: h kappa is 2.5, at most 1 shows its ramp"), (3.9e9, None)):
        notes = solve_unilateral(make(elements=8, p=p), replace(CONSTANT, step=0.1), 1).notes
        assert notes[:-1] == (("one column of elements",) if words is None else ("one column of elements", words))
    # c dt over h = 0.25
    assert "wave: 0.243 elements" in solve_unilateral(make(elements=8), CONSTANT, 1).notes[1]


def test_rounding_does_not_turn_a_block_in_a_long_flight():
    """K of the displacement itself would leave eps E u in each element and turn the block by 10 rad: it is rigid."""
    scheme = replace(AVERAGE, step=0.25)
    block = replace(make(elements=2), poisson=0.2, young=4e10, pressure=0.0, gravity=0.0)
    run = solve_unilateral(block, scheme, 40, Unilateral(velocity=1e3), columns=("displacement", "rotation"))
    assert run.columns["displacement"][-1] == pytest.approx(1e4, rel=1e-13)
    assert np.abs(run.columns["rotation"]).max() < 1e-7
