"""Columns on every base: blocks, elements and the exact layers agree; a height is the top but for rounding."""

from pathlib import Path

import numpy as np
import pytest
from conftest import thinned

from validation import load_scene, response
from validation.scenes.scene import parse_scene

SITE = load_scene(Path(__file__).with_name("site.toml"))
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


def standing(base):
    """Return the site on another base."""
    data = SITE.definition()
    if base in ("rigid", "springs"):
        for key in ("base_density", "base_speed"):
            del data["column"][key]
    return parse_scene(data | {"column": data["column"] | {k[7:]: v for k, v in BASES[base].items()}}, base)


@pytest.mark.parametrize(("base", "top"), thinned(BASES_AND_ENDS, 4))
def test_fine_columns_vibrate_as_the_exact_layers(base, top):
    layers = [x.model_dump() | {"blocks": 40 * x.blocks} for x in SITE.column.layer]
    scene = standing(base).with_values({"column.layer": layers, "time.gg": 0.99})
    if top:
        given = {"at": "top", "shape": "ricker", "pressure": 1.0, "frequency": 4.0}
        scene = parse_scene(scene.definition() | {"input": given}, "top")
    frequency = [0.5, 2.0, 3.1]
    exact = response(scene, frequency, "layers").columns
    for solver in ("dda", "fem"):
        for name, values in response(scene, frequency, solver, exact=True).columns.items():
            assert np.abs(values - exact[name]).max() < 2e-4 * np.abs(exact[name]).max(), (solver, name)
