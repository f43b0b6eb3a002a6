"""`show SCENE`: the model drawn, its parameters, and derived numbers against formulas written here."""

import json

import pytest
from conftest import typed

from validation.scenes.scene import load_scene, scene_names


def shown(*arguments):
    done = typed("show", *arguments, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


FAMILIES = {name.partition("-")[0]: name for name in reversed(scene_names())}  # the first scene of each


@pytest.mark.long  # of some the pages are kept word by word
@pytest.mark.parametrize("name", FAMILIES.values())
def test_a_built_in_scene_is_shown(name):
    found = shown(name)
    assert found["numbers"] and found["cases"] == len(load_scene(name).expand())
    assert typed("show", name).stdout.startswith(f"{name}: ")
