"""Bad input is one line of source, field, rule, value and advice, each of which a program can read as well."""

import pytest

from validation.errors import InputError
from validation.scenes.scene import load_scene


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
def test_a_defect_of_a_scene_says_where_it_is(scene, values, field, value):
    with pytest.raises(InputError) as refused:
        scene.with_values(values)
    assert (refused.value.source, refused.value.field, refused.value.value) == (scene.name, field, value)


def test_a_decimal_comma_of_a_file_is_named(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text("[block]\ndensity = 2,650\n")
    with pytest.raises(InputError) as error:
        load_scene(path)
    assert error.value.advice == "2,650: a number has a point, and no comma"
