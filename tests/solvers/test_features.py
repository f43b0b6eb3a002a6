"""What each solver takes and refuses by name, by `features.toml`: features, and those that do not go together."""

import tomllib
from pathlib import Path

import pytest

from validation import response, solve
from validation.errors import InputError
from validation.scenes import features
from validation.scenes.scene import load_scene, parse_scene
from validation.solvers.registry import BUILT_IN, get_solver

LOCKED = load_scene("figures-3-4").with_values({"time.step": 1e-3, "time.steps": 3, "fem.elements": 2})
TABLES = tomllib.loads(Path(__file__).with_name("features.toml").read_text(encoding="utf-8"))
APART = [
    (solver, first, second)
    for first, others in TABLES["apart"].items()
    for second, solvers in others.items()
    for solver in solvers
]


def block_with(directory, *names):
    """Return the locked block with the values of features; a record of its base stands in the directory."""
    record = directory / "base.csv"
    record.write_text("time,x,y\n0,0,0\n0.01,1e-3,2e-4\n0.5,0,0\n")
    tables = [(section, table) for name in names for section, table in TABLES["block"][name].items()]
    values = {f"{section}.{key}": value for section, table in tables for key, value in table.items()}
    if "load.base_motion" in values:
        values["load.base_motion"] = str(record)
    return LOCKED.with_values(values)


def scene_of(feature, directory):
    if feature == features.COLUMN:
        return load_scene("waves-base").expand()[0]
    if feature == features.PLANE:
        return load_scene("patch-strip").expand()[0]
    if feature == features.MOVING_BLOCKS:
        return parse_scene(TABLES["plane"], feature)
    if feature in TABLES["column"]:
        layer = {"thickness": 2.0, "density": 2e3, "young": 1e9, "blocks": 2, "velocity": -1.0}
        column = {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "layer": [layer]}
        run = {"solvers": ["dda"], "columns": ["displacement"]}
        time = {"step": 1e-4, "steps": 5}
        return parse_scene({"column": column | TABLES["column"][feature], "time": time, "run": run}, feature)
    return block_with(directory, feature)


def test_a_feature_is_refused_by_name_by_all_solvers_but_some(tmp_path):
    for feature in (feature.name for feature in features.FEATURES):
        scene = scene_of(feature, tmp_path)
        assert feature in features.of(scene)
        refusals = {name: get_solver(name).refusal(scene) for name in BUILT_IN}
        takes = [name for name, refusal in refusals.items() if refusal is None or feature not in refusal]
        assert takes == [name for name in BUILT_IN if name in TABLES["takes"][feature]], feature
        refused = [name for name, refusal in refusals.items() if refusal is not None]
        for name in refused[:1]:
            with pytest.raises(InputError) as error:
                solve(scene, name)
            assert refusals[name] in str(error.value)


def test_what_does_not_go_together_is_refused_by_both_names(tmp_path):
    for solver, first, second in APART:
        scene = block_with(tmp_path, first, second)
        with pytest.raises(InputError, match=rf"{first}.*{second}"):
            solve(scene, solver)
        if features.linear(scene):
            with pytest.raises(InputError, match=rf"{first}.*{second}"):
                response(scene, 1.0, solver)
