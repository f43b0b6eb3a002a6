"""Scenes: what is accepted, what is refused, and in which words."""

import copy
import tomllib

import numpy as np
import pytest
from conftest import SCENE

from validation.errors import InputError
from validation.scenes.scene import LONGEST_VALUE, load_scene, parse_assignment, parse_scene


def changed(**changes):
    """Return the small scene with ``section__key`` replaced."""
    data = copy.deepcopy(tomllib.loads(SCENE))
    for name, value in changes.items():
        section, _, key = name.partition("__")
        (data.setdefault(section, {}) if key else data)[key or section] = value
    return data


def parse(**changes):
    return parse_scene(changed(**changes), "x.toml")


def test_a_scheme_refuses_the_numbers_of_newmarks():
    time = parse(time__scheme="chung-hulbert", time__rho_inf=0.8).time
    for weight in ("alpha", "delta"):
        with pytest.raises(InputError) as caught:
            getattr(time, weight)
        assert caught.value.field == f"time.{weight}"
    assert (parse().time.alpha, parse().time.delta) == (0.5, 1.0)


@pytest.mark.parametrize(
    "field", ["plane.block.spin", "plane.block.lid.spin", "plane.block.9.spin", "gate.0.metric", "run.columns"]
)
def test_what_is_no_key_of_a_table_is_not_swept(field):
    data = load_scene("rigid-impact").definition()
    with pytest.raises(InputError) as error:
        parse_scene(data | {"sweep": {field: [1.0]}}, "x")
    assert (error.value.field, error.value.value) == ("sweep", repr(field))


@pytest.mark.parametrize(
    ("sweep", "field", "value"),
    [
        ({"time.step": [0.1, -1]}, "time.step", "-1"),
        ({"time.stop": [0.1]}, "sweep.time.stop", "[0.1]"),
        ({"time.step": [0.1, 0.1]}, "sweep", "scene[time.step=0.1] twice"),
        ({"time.step": [1, 1.0]}, "sweep", "scene[time.step=1] twice"),
        ({"time.gg": [0.9, 1.0], "time.gg_rate": [3.0]}, None, "both"),
    ],
)
def test_a_swept_value_is_checked_like_any_other_and_once(sweep, field, value):
    with pytest.raises(InputError) as error:
        parse(sweep=sweep).expand()
    assert (error.value.field, error.value.value) == (field, value)


def test_keys_that_exclude_each_other_are_not_set_or_swept_together():
    for values in ({"time.gg": 0.9, "time.gg_rate": 3.0}, {"block.side": 1.0, "block.width": 2.0, "block.height": 1.0}):
        with pytest.raises(InputError, match=r"got both$"):
            parse().with_values(values)
    rate = parse(time__gg=0.9, sweep={"time.gg_rate": [3.0, 4.0]}).expand()
    assert [(case.time.gg, case.time.gg_rate) for case in rate] == [(None, 3.0), (None, 4.0)]
    (left,) = parse(sweep={"time.gg": [0.9, 1.0]}).with_values({"time.gg_rate": 3.0}).expand()
    assert (left.time.gg, left.time.gg_rate) == (None, 3.0), "a set key ends the sweep of the key that it excludes"


@pytest.mark.parametrize("field", ["name", "sweep", "gate", 'sweep."time.step"', "gate.0.band"])
def test_what_is_no_value_of_a_scene_is_not_set(field):
    with pytest.raises(InputError) as error:
        parse().with_values({field: [0.1]})
    assert error.value.field == field


def test_files_stand_beside_the_scene_and_a_byte_order_mark_is_no_text(tmp_path):
    text = SCENE.replace("elements = 4", 'mesh = "a.msh"')
    swept = 'a.msh", "b.msh'
    (tmp_path / "s.toml").write_text(f'\ufeff{text}\n[sweep]\n"fem.mesh" = ["{swept}"]\n', encoding="utf-8")
    scene = load_scene(tmp_path / "s.toml")
    assert scene.fem.mesh == str(tmp_path / "a.msh")
    assert [case.fem.mesh for case in scene.expand()] == [str(tmp_path / "a.msh"), str(tmp_path / "b.msh")]


def test_assignments_are_toml_or_words():
    assert parse_assignment("time.step=0.1") == ("time.step", 0.1)
    assert parse_assignment("time.start=consistent") == ("time.start", "consistent")
    assert parse_assignment('fem.mesh="a=b"') == ("fem.mesh", "a=b")
    assert parse_assignment("a=" + "x" * LONGEST_VALUE)[1] == "x" * LONGEST_VALUE
    for text in ("time.step", " =1", "time.step=0.1\n", "time.step=0.1\r", "a=" + "x" * (LONGEST_VALUE + 1)):
        with pytest.raises(InputError) as error:
            parse_assignment(text)
        assert error.value.field == "--set"


def test_a_load_that_rises_gives_the_impulse_of_its_ramp():
    times = np.array([0.1, 0.2, 0.3])
    assert parse(load__ramp=0.2).load.acted(times) == pytest.approx([0.025, 0.1, 0.2])
    assert np.array_equal(parse().load.acted(times), times)
