"""Blocks and step for a wave: what is advised is just good enough, and what the present ones do."""

import numpy as np
import pytest

import validation.cli.entry  # noqa: F401 (declares the commands)
from validation import load_scene, solve
from validation.advice.wave_advice import advise_wave
from validation.errors import InputError
from validation.theory.stepping import Stepping
from validation.theory.waves import Column

COLUMN = load_scene("figures-3-4").with_values(
    {"time.step": 0.01, "block.height": 100.0, "block.width": 1.0, "block.subdivide": [1, 50]}
)


FREE = {"time.allow_unstable": True}
SITE = load_scene("waves-site").with_values(FREE)
JOINT = load_scene("waves-joint").with_values(FREE)
GLUE = load_scene("waves-glue").expand()[0].with_values(FREE)
LINEAR = {"time.alpha": 1 / 6, "time.delta": 0.5}
EXPLICIT = {"time.alpha": 0.0, "time.delta": 0.5}


def with_blocks(scene, blocks):
    """Return a scene whose column or block is cut as advised, and whose unstable steps are refused."""
    if scene.column is None:
        return scene.with_values({"block.subdivide": [1, blocks[0]], "time.allow_unstable": False})
    layers = [layer.model_dump() | {"blocks": n} for layer, n in zip(scene.column.layer, blocks, strict=True)]
    return scene.with_values({"column.layer": layers, "time.allow_unstable": False})


@pytest.mark.parametrize(
    ("scheme", "scene", "frequency"),
    [
        pytest.param(LINEAR, COLUMN.with_values(FREE), 5.0, marks=pytest.mark.long),
        (EXPLICIT, SITE, 8.0),
        (EXPLICIT, JOINT, 250.0),
        ({"time.alpha": 0.2, "time.delta": 0.6, "time.gg_rate": 0.1}, GLUE, 20.0),
    ],
)
def test_a_step_limited_by_stability_is_the_largest_that_the_solver_takes(scheme, scene, frequency):
    """Glue, joints and contact springs set the limit, not the blocks alone."""
    scene = scene.with_values(scheme)
    found = advise_wave(scene, frequency, 0.5)
    assert found.limits_step == "stability"
    case = with_blocks(scene, found.blocks).with_values({"time.steps": 2})
    assert solve(case.with_values({"time.step": found.advised.step}), "dda").time.size == 2
    with pytest.raises(InputError, match="limit"):
        solve(case.with_values({"time.step": found.advised.step * (1 + 1e-5)}), "dda")


def test_where_only_unstable_steps_would_do_the_advice_says_so():
    scene = COLUMN.with_values(FREE | {"time.alpha": 0.2, "time.delta": 0.6, "time.gg": 0.99})
    found = advise_wave(scene, 5.0, 0.5)
    assert (found.advised, found.limits_step) == (None, "stability")
    assert "unstable" in found.advice


@pytest.mark.parametrize(
    ("scheme", "values"),
    [
        ("wbz", {"time.rho_inf": 0.2}),
        ("chung-hulbert", {"time.rho_inf": 0.0}),
        ("leapfrog", {"time.start": "consistent", "time.step": 0.001}),
    ],
)
def test_other_schemes_are_advised_by_their_own_wavenumber(scheme, values):
    scene = COLUMN.with_values({"time.scheme": scheme} | values)
    found = advise_wave(scene, 10.0, wavelengths=5.0, loss=0.2, phase_error=0.2)
    column = Column(2.0, 2700.0, 1e9)
    share, speed_error = column.travelled(Stepping.of(scene), [2 * np.pi * 10.0], found.distance)
    assert found.present.loss == pytest.approx(1 - share[0], rel=1e-6, abs=1e-12)  # but for the glue
    assert np.sign(found.present.delay) == -np.sign(speed_error[0])
    assert (found.advised.loss == pytest.approx(0, abs=1e-12)) == (scheme == "leapfrog")
