"""Values that were probably not meant: which are warned of, and what to write; built-in scenes are left alone."""

from __future__ import annotations

import json
import re
import warnings
from pathlib import Path
from typing import Any

import pytest
from conftest import typed

import validation
from validation.errors import PlausibilityWarning
from validation.scenes.plausibility import implausible_values, plausibility_warnings
from validation.scenes.scene import Scene, load_scene, parse_scene, scene_names

ROCK = {"block": {"side": 2.0, "density": 2700.0, "young": 3e10}, "contact": {"stiffness": 1e9}}
SLIDING = {"law": "unilateral", "stiffness": 1e9}
# what a scene states otherwise than rock: its field and kind, and the line that is said to write
CASES = [
    ({"block.density": 2.7}, "block.density", "density", "write density = 2700"),
    ({"block.density": 26.5}, "block.density", "density", "write density = 2701"),
    ({"block.young": 30}, "block.young", "modulus", "write young = 30e9"),
    ({"block.young": 30000}, "block.young", "modulus", "write young = 30000e6"),
    ({"block.young": 5e6, "load.pressure": 1e5}, "block.young", "wave", "write young = 5e+09"),
    ({"block.young": 3e13}, "block.young", "wave", "write young = 3e+10"),
    ({"load.pressure": 5e9}, "load.pressure", "strain", "write pressure in Pa"),
    ({"load.pressure": 0.0, "load.traction": 2e9}, "load.traction", "strain", "write traction in Pa"),
    ({"load.gravity": 9.81e5, "block.young": 3e10}, "load.gravity", "strain", "write gravity = 9.81"),
    ({"contact": SLIDING | {"friction": 0.577}}, "contact.friction", "friction", "write friction = 29.98"),
    (
        {"contact": SLIDING | {"damping_ratio": 5.0}},
        "contact.damping_ratio",
        "damping ratio",
        "write damping_ratio = 0.05",
    ),
    ({"load.gravity": -9.81}, "load.gravity", "gravity", "write gravity = 9.81"),
    ({"load.gravity": 1.0}, "load.gravity", "gravity", "write gravity = 9.81"),
    ({"load.gravity": 9810.0}, "load.gravity", "gravity", "write gravity = 9.81"),
    ({"time.gg": 0.02}, "time.gg", "gg", "write gg = 0.98"),
    ({"time.gg_rate": 5e3}, "time.gg_rate", "gg", "2 w1 xi"),
    ({"time.alpha": 1.0, "time.delta": 0.5}, "time.alpha", "scheme", "write alpha = 0.5 and delta = 1"),
    ({"contact.stiffness": 50.0}, "contact.stiffness", "stiffness", "such as 3e+10 to 3e+11"),
    ({"contact.stiffness": 1e-3, "load.pressure": 0.0}, "contact.stiffness", "stiffness", "such as 3e+10"),
    ({"load.pressure": 1.0}, "load.pressure", "pressure", "write pressure = 1e6"),
    ({"contact": SLIDING | {"friction": 30.0, "cohesion": 0.5}}, "contact.cohesion", "pressure", "cohesion = 0.5e6"),
    ({"load.pressure": -5e6}, "load.pressure", "pressure", "write pressure = 5e+06"),
    ({"contact.stiffness": 1e25}, "contact.stiffness", "stiffness", "or inf where contact opens"),
    ({"time.delta": 5.0}, "time.delta", "scheme", "write alpha = 0.5, delta = 1"),
    ({"contact": SLIDING | {"friction": 89.9}}, "contact.friction", "friction", "leave friction out"),
    ({"contact": SLIDING | {"band": [5.0, 5.0]}}, "contact.band", "gap", "0.001 for 1 mm"),
    ({"contact": SLIDING | {"shear_stiffness": 1e-3}}, "contact.shear_stiffness", "stiffness", "= 1e+09"),
    ({"block.subdivide": [2, 2], "block.glue_ratio": 1e-5}, "block.glue_ratio", "stiffness", "1 to 1e6"),
    ({"block.side": 1200.0}, "block.side", "size", "write side = 1.2"),
    ({"block.density": 26500.0}, "block.density", "density", "write density = 2701"),
    ({"block.poisson": -0.25}, "block.poisson", "poisson", "write poisson = 0.25"),
    ({"time.step": 2.0}, "time.step", "step", "write step in s"),
    ({"load.ramp": 50.0}, "load.ramp", "ramp", "write ramp in s"),
    ({"damping.stiffness": 0.05}, "damping.stiffness", "damping ratio", "a1 = 2 xi / w"),
    ({"contact": SLIDING | {"gap": 25.0}}, "contact.gap", "gap", "0.001 for 1 mm"),
    ({"block.velocity": 500.0, "contact": SLIDING}, "block.velocity", "velocity", "in m/s"),
    ({"contact": SLIDING | {"friction": 4.9}}, "contact.friction", "friction", "write the angle in degrees"),
]


def rock(**tables: Any) -> Scene:
    """Return a block of rock under a pressure."""
    data = ROCK | {"load": {"pressure": 5e6}, "time": {"step": 0.002, "steps": 5}} | tables
    return parse_scene({"name": "rock"} | data, "rock.toml")


@pytest.mark.parametrize(("values", "field", "kind", "advice"), CASES)
def test_a_value_in_another_unit_is_named_with_what_to_write(
    values: dict[str, Any], field: str, kind: str, advice: str
) -> None:
    (found,) = implausible_values(rock().with_values(values))
    assert (found.field, found.kind) == (field, kind)
    assert advice in found.sentence and 'extreme = "why"' in found.sentence


@pytest.mark.parametrize("name", scene_names())
def test_built_in_scenes_are_plausible_or_say_that_they_are_extreme(name: str) -> None:
    scene = load_scene(name)
    assert plausibility_warnings(scene) == []
    if scene.extreme:  # and not without need
        assert plausibility_warnings(scene.with_values({"extreme": ""}))


def test_python_warns_once_a_scene_and_not_once_a_solver() -> None:
    scene = rock().with_values({"block.young": 31234.0})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        for solver in ("dda", "bar"):
            validation.solve(scene, solver)
        validation.damping(scene)
    assert [(warning.category, warning.filename) for warning in caught] == [(PlausibilityWarning, "rock")]


def test_commands_warn_on_standard_error_once(tmp_path: Path) -> None:
    lines = ['title = "t"', "[block]", "side = 2.0", "density = 2.7", "young = 3e10", "[contact]", "stiffness = 1e9"]
    scene = tmp_path / "mine.toml"
    scene.write_text("\n".join([*lines, "[load]", "pressure = 5e6", "[time]", "step = 0.002", "steps = 5\n"]))
    results = ["--results", str(tmp_path / "results")]
    parts = [["advise", "damping"], ["advise", "step", "--damping", "0.05"], ["advise", "rayleigh"]]
    for words in (["show"], ["solve"], *parts, ["run", *results]):
        done = typed(*words, str(scene))
        assert re.findall(r"^warning: mine: (\S+)", done.stderr, re.M) == ["block.density"], words
        assert done.returncode == 0, words
    data = json.loads(typed("show", str(scene), "--json").stdout)
    assert len(data["warnings"]) == 1
    scene.write_text('extreme = "foam"\n' + scene.read_text())
    assert typed("solve", str(scene)).stderr.count("warning") == 0
