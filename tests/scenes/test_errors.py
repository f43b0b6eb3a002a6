"""Bad input is one line of source, field, rule, value and advice, each of which a program can read as well."""

import pytest

from validation.errors import InputError
from validation.scenes.scene import load_scene


def test_a_decimal_comma_of_a_file_is_named(tmp_path):
    path = tmp_path / "s.toml"
    path.write_text("[block]\ndensity = 2,650\n")
    with pytest.raises(InputError) as error:
        load_scene(path)
    assert error.value.advice.startswith("2,650: ")
