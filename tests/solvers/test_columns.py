"""Columns on every base: blocks, elements and the exact layers agree; a height is the top but for rounding."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from conftest import thinned

from validation import load_scene, response, solve
from validation.scenes.scene import parse_scene

SITE = Path(__file__).with_name("site.toml").read_text(encoding="utf-8")
BASES = {
    "half-space": {},
    "jointed half-space": {"column.joint": [{"height": 0.0, "stiffness": 3e8}, {"height": 10.0, "stiffness": 1e8}]},
    "rigid": {"column.base": "rigid"},
    "springs": {"column.base": "springs", "column.base_stiffness": 4e8},
}
BASES_AND_ENDS = [
    pytest.param(base, top, marks=[pytest.mark.long] * (top is not bool(b % 2)))
    for b, base in enumerate(BASES)
    for top in (False, True)
]


@pytest.fixture
def site(tmp_path):
    path = tmp_path / "site.toml"
    path.write_text(SITE)
    return load_scene(path)


def standing(site, base):
    """Return the site on another base."""
    data = site.definition()
    if base in ("rigid", "springs"):
        for key in ("base_density", "base_speed"):
            del data["column"][key]
    return parse_scene(data | {"column": data["column"] | {k[7:]: v for k, v in BASES[base].items()}}, base)


# ---- vibrations -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("base", "top"), thinned(BASES_AND_ENDS, 4))
def test_fine_columns_vibrate_as_the_exact_layers(site, base, top):
    layers = [x.model_dump() | {"blocks": 40 * x.blocks} for x in site.column.layer]
    scene = standing(site, base).with_values({"column.layer": layers, "time.gg": 0.99})
    if top:
        given = {"at": "top", "shape": "ricker", "pressure": 1.0, "frequency": 4.0}
        scene = parse_scene(scene.definition() | {"input": given}, "top")
    frequency = [0.5, 2.0, 3.1]
    exact = response(scene, frequency, "layers").columns
    for solver in ("dda", "fem"):
        for name, values in response(scene, frequency, solver, exact=True).columns.items():
            assert np.abs(values - exact[name]).max() < 2e-4 * np.abs(exact[name]).max(), (solver, name)


# ---- what is refused ------------------------------------------------------------------------------------------------


TOPS = itertools.product((0.3, (0.1 + 0.2) * (1 + 5e-10)), ("dda", "fem", "layers", "column-events", "bars-events"))


@pytest.mark.parametrize(("top", "solver"), thinned(TOPS, 3))
def test_a_height_that_is_the_top_but_for_rounding_is_the_top(top, solver):
    layers = [{"thickness": 0.1, "density": 2000.0, "young": 1e8}, {"thickness": 0.2, "density": 2000.0, "young": 1e8}]
    column = {"motion": "pressure", "layer": layers, "heights": [top]}
    if solver.endswith("events"):
        column |= {"law": "unilateral", "stiffness": 1e9}
    scene = parse_scene(
        {
            "column": column,
            "input": {"shape": "half-sine", "velocity": 0.1, "duration": 1e-3},
            "time": {"step": 1e-5, "steps": 20, "alpha": 0.25, "delta": 0.5},
            "run": {"solvers": [solver], "columns": ["displacement", "displacement_1"]},
        },
        "top",
    )
    history = solve(scene, solver).history
    assert history is not None
    columns = history.columns
    np.testing.assert_allclose(columns["displacement_1"], columns["displacement"], atol=1e-15)
