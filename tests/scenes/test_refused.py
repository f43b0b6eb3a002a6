"""What is refused of a scene of each kind, as tables: `refused_kinds.toml`, and `refused.toml` of a block."""

import copy
import tomllib
from pathlib import Path

import pytest

from validation.errors import InputError
from validation.scenes.scene import parse_scene

TABLES = tomllib.loads(Path(__file__).with_name("refused_kinds.toml").read_text(encoding="utf-8"))
ROWS = [(kind, row) for kind in TABLES["scene"] for row in TABLES[kind]]


def holder(data, field):
    """Return the table that a dotted key stands in, and what of the key is left."""
    *path, key = field.split(".")
    for name in path:
        data = data[int(name)] if isinstance(data, list) else data.setdefault(name, {})
    return data, key


@pytest.mark.parametrize(("kind", "row"), ROWS, ids=lambda value: str(value)[:60])
def test_what_does_not_go_together_is_refused(kind, row):
    data = copy.deepcopy(TABLES["scene"][kind])
    parse_scene(copy.deepcopy(data), "x")
    for field in row.get("without", []):
        table, key = holder(data, field)
        del table[key]
    for field, value in row.get("set", {}).items():
        table, key = holder(data, field)
        table[key] = value
    with pytest.raises(InputError) as caught:
        parse_scene(data, "x")
    error = caught.value
    assert error.field == row.get("field", error.field)
    assert error.value == row.get("value", error.value)
    assert row.get("says", "") in str(error).replace("column: ", "")
