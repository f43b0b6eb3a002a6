"""What is refused of a scene of each kind, as a table: `refused.toml`."""

import copy
import tomllib
from pathlib import Path

import pytest

from validation.errors import InputError
from validation.scenes.scene import parse_scene

TABLES = tomllib.loads(Path(__file__).with_name("refused.toml").read_text(encoding="utf-8"))


def holder(data, field):
    """Return the table that a dotted key stands in, and what of the key is left."""
    *path, key = field.split(".")
    for name in path:
        data = data[int(name)] if isinstance(data, list) else data.setdefault(name, {})
    return data, key


def changed(data, values):
    """Return the tables of a scene with other values by dotted keys."""
    data = copy.deepcopy(data)
    for field, value in values.items():
        table, key = holder(data, field)
        if isinstance(table, list):
            table.append(value)
        else:
            table[key] = value
    return data


def scene_of(kind):
    """Return the tables of a scene that is allowed."""
    scene = TABLES["scene"].get(kind) or changed(TABLES["scene"]["small"], TABLES["like_small"][kind])
    parse_scene(copy.deepcopy(scene), "x")
    return scene


@pytest.mark.parametrize("kind", [*TABLES["scene"], *TABLES["like_small"]])
def test_what_does_not_go_together_is_refused(kind):
    allowed = scene_of(kind)
    for row in TABLES[kind]:
        row = row if isinstance(row, dict) else dict(zip(("set", "field", "value"), row, strict=False))
        data = copy.deepcopy(allowed)
        for field in row.get("without", []):
            table, key = holder(data, field)
            del table[key]
        with pytest.raises(InputError) as caught:
            parse_scene(changed(data, row.get("set", {})), "x")
        error = caught.value
        named = row.get("field") or [*row["set"]][-1]
        assert named in (error.field, f"{error.field}.{error.rule.split()[0]}"), row
        assert str(error.value) == row.get("value", str(error.value)), row
        assert str(error).startswith("x: ") and "\n" not in str(error), row
