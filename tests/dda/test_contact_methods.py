"""Clipped dashpots, impulses with a restitution, passes of an augmented Lagrangian."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dda import (
    Block,
    Material,
    Scheme,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    solve_unilateral,
)

MASS = 1.3 * 0.9 * 2350.0
PAPER = UnilateralModel(Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, 0.0)), Unilateral(1e9), 5e6)


@pytest.mark.parametrize(("alpha", "delta"), [(0.25, 0.5), (9 / 16, 1.0)])
def test_a_load_that_rises_drives_a_block_onto_a_stop(alpha, delta):
    dt = 1.7e-3
    block = Block.rectangle(1.3, 0.9, Material(2350.0, 1e22, 0.0))
    model = UnilateralModel(block, Unilateral(math.inf, gap=2.9e-3), 3e5, ramp=0.013)
    options = UnilateralOptions("impact", restitution=0.37, energies=True)
    result = solve_unilateral(model, Scheme(alpha, delta, 1.0, dt), 14, options=options)
    share = np.clip(dt * np.arange(15) / 0.013, 0.0, 1.0)
    theta = math.sqrt(alpha)
    impulse = 3e5 * 1.3 * dt * np.cumsum((1 - theta) * share[:-1] + theta * share[1:])
    assert result.velocity[:6] == pytest.approx(-impulse[:6] / MASS, rel=1e-9)
    assert result.velocity[-1] > -0.1 * impulse[-1] / MASS
    assert np.abs(sum(result.energies.values())).max() < 1e-9 * result.energies["impact"][-1]


@pytest.mark.parametrize(("dt", "rC"), [(1e-2, 9.75042), (2e-3, 0.715198), (1e-3, 0.271164), (1e-4, 0.00368836)])
def test_what_a_pass_leaves_of_the_penetration(dt, rC):
    """Passes of a first step: ln(|w_f| / tolerance) / ln(1 + r C) with r = 2p of both corners."""
    model = replace(PAPER, contact=Unilateral(1e9), pressure=0.0, velocity=-1.0)
    scheme = Scheme(0.5, 1.0, 1.0, dt)
    options = UnilateralOptions("augmented", penetration=1e-6 * dt)
    result = solve_unilateral(model, scheme, 1, options=options)
    assert result.step_passes[0] == math.ceil(math.log(1e6) / math.log(1 + rC))
    limited = solve_unilateral(model, scheme, 1, options=replace(options, pass_limit=2))
    assert limited.outcome == "pass limit exceeded" and len(limited.time) == 0
    assert limited.step_cuts.size == 0 and limited.notes[-1] == "pass limit exceeded at step 1"
