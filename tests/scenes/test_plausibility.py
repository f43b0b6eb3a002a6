"""Values that were probably not meant: which are warned of, and what to write; built-in scenes are left alone."""

import tomllib
import warnings
from pathlib import Path

import pytest
from conftest import thinned
from oracles.stand_ins import assert_kept, summed
from oracles.stated_scenes import made

import validation
from validation.errors import PlausibilityWarning
from validation.scenes import plausibility
from validation.scenes.plausibility import PlausibilityHooks, plausibility_warnings
from validation.scenes.scene import load_scene, parse_scene, scene_names

ROCK = {"block": {"side": 2.0, "density": 2700.0, "young": 3e10}, "contact": {"stiffness": 1e9}}
TABLES = tomllib.loads(Path(__file__).with_name("implausible.toml").read_text(encoding="utf-8"))
KEPT = Path(__file__).with_name("judged.toml")


def rock(**tables):
    """Return a block of rock under a pressure."""
    data = ROCK | {"load": {"pressure": 5e6}, "time": {"step": 0.002, "steps": 5}} | tables
    return parse_scene({"name": "rock"} | data, "rock.toml")


class Numbers:
    """A row of a table that holds for every value, and says the numbers that its sentence may tell."""

    def get(self, limit, otherwise):
        return otherwise

    def __getitem__(self, key):
        return self

    def format(self, **told):
        return " ".join(str(float(value)) for value in told.values() if isinstance(value, float))


def test_every_quantity_that_is_held_against_a_limit_is_what_it_was(tmp_path, monkeypatch):
    quantities = [*plausibility.TABLE]
    sums = {}
    for name, values in TABLES["judged"]:
        scene = made(name, tmp_path).with_values(values)
        hooks = PlausibilityHooks.of(scene)
        told = []
        for without in ((), ("density", "modulus")):  # where neither is told, the wave and the strain of both are
            table = {quantity: [] if quantity in without else [Numbers()] for quantity in quantities}
            monkeypatch.setattr(plausibility, "TABLE", table)
            for value in (*hooks.values(scene), *hooks.sinks(scene)):
                told += [value.field, value.kind, *map(float, value.sentence.partition(",")[0].split())]
        sums[name] = summed(told)
    assert_kept(KEPT, "judged", sums)


@pytest.mark.parametrize("name", thinned(scene_names(), 25))
def test_built_in_scenes_expand_and_are_plausible_or_say_that_they_are_extreme(name):
    scene = load_scene(name)
    assert scene.title and plausibility_warnings(scene) == []
    assert all(not case.sweep for case in scene.expand())
    if scene.extreme:  # and not without need
        assert plausibility_warnings(scene.with_values({"extreme": ""}))


def test_python_warns_once_a_scene_and_not_once_a_solver():
    scene = rock().with_values({"block.young": 31234.0})
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("default")
        for solver in ("dda", "bar"):
            validation.solve(scene, solver)
        validation.damping(scene)
    assert [(warning.category, warning.filename) for warning in caught] == [(PlausibilityWarning, "rock")]
