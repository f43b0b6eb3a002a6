"""Bad input is one line of source, field, rule, value and advice, each of which a program can read as well."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from validation.errors import InputError
from validation.scenes.scene import Scene, load_scene, parse_assignment, parse_scene


@pytest.mark.parametrize(
    ("parts", "text"),
    [
        ({}, "must be positive"),
        ({"field": "block.side"}, "block.side: must be positive"),
        ({"source": "x.toml", "field": "block.side", "value": -2}, "x.toml: block.side: must be positive, got -2"),
        (
            {"source": "x.toml", "value": 0, "advice": "make it larger"},
            "x.toml: must be positive, got 0; make it larger",
        ),
    ],
    ids=str,
)
def test_the_line_is_made_of_the_parts_that_there_are(parts: dict[str, object], text: str) -> None:
    error = InputError("must be positive", **parts)  # type: ignore[arg-type]
    assert str(error) == text
    assert {name: getattr(error, name) for name in parts} == parts
    copy = pickle.loads(pickle.dumps(error))  # as it comes back from a worker
    assert (str(copy), copy.rule, copy.field) == (text, "must be positive", error.field)


@pytest.mark.parametrize(
    ("values", "field", "value"),
    [
        ({"block.young": -1.0}, "block.young", "-1.0"),
        ({"block.colour": 1}, "block.colour", "1"),
        ({"block.density": "x"}, "block.density", "'x'"),
        ({"time.steps": 0}, "time.steps", "0"),
        ({"block.young.x": 1}, "block.young.x", "1"),
    ],
    ids=str,
)
def test_a_defect_of_a_scene_says_where_it_is(scene: Scene, values: dict[str, object], field: str, value: str) -> None:
    with pytest.raises(InputError) as refused:
        scene.with_values(values)
    assert (refused.value.source, refused.value.field, refused.value.value) == (scene.name, field, value)


def test_a_rule_on_the_whole_scene_says_its_field(scene: Scene) -> None:
    with pytest.raises(InputError) as refused:
        scene.with_values({"contact.friction": 20.0})
    assert refused.value.field == "contact"
    assert refused.value.rule.startswith("friction goes with law")


def test_what_is_missing_is_said_with_its_field() -> None:
    with pytest.raises(InputError) as refused:
        parse_scene({"name": "x"}, "x.toml")
    assert (refused.value.field, refused.value.rule, refused.value.value) == ("time", "is required", "nothing")


def test_files_and_options_are_told_from_keys() -> None:
    with pytest.raises(InputError) as refused:
        load_scene("nowhere.toml")
    assert (str(refused.value.source), refused.value.field) == ("nowhere.toml", None)
    with pytest.raises(InputError) as refused:
        parse_assignment("no equals sign")
    assert (refused.value.source, refused.value.field) == (None, "--set")


def test_all_missing_keys_are_said_at_once() -> None:
    with pytest.raises(InputError) as error:
        parse_scene({"block": {"side": 2.0}, "load": {"pressure": 1e6}, "time": {"steps": 9}}, "s")
    assert error.value.field == "block.density, block.young, time.step"


def test_a_decimal_comma_of_a_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "s.toml"
    path.write_text("[block]\ndensity = 2,650\n")
    with pytest.raises(InputError) as error:
        load_scene(path)
    assert error.value.advice == "2,650: a number has a point, and no comma"
