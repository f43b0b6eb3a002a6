"""Unknown keys of a scene: all of them first, in one error, each with the key that was probably meant."""

import re
import tomllib
from pathlib import Path

import pytest

from validation.errors import InputError
from validation.scenes.scene import load_scene, parse_scene

BLOCK = {"block": {"side": 2.0, "density": 2700.0, "young": 1e9}, "contact": {"stiffness": 1e9}}
SCENE = BLOCK | {"load": {"pressure": 5e6}, "time": {"step": 0.002, "steps": 100}}
UNKNOWN = "unknown key"
MEANT = tomllib.loads(Path(__file__).with_name("meant_keys.toml").read_text(encoding="utf-8"))


def with_key(field):
    """Return a scene's data with a key of the value 1 added."""
    data = {table: dict(keys) for table, keys in SCENE.items()}
    place, _, key = field.rpartition(".")
    if field.startswith("sweep."):
        place, _, key = field.partition(".")
    (data.setdefault(place, {}) if place else data)[key] = 1
    return data


@pytest.mark.parametrize(("field", "meant"), MEANT["blocks"].items())
def test_the_key_that_was_meant_is_named(field, meant):
    with pytest.raises(InputError) as refused:
        parse_scene(with_key(field), "x.toml")
    assert (refused.value.rule, refused.value.source) == (UNKNOWN, "x.toml")
    assert refused.value.field == field or field.startswith(f"{refused.value.field}.")  # of a table, the table
    assert refused.value.advice.split()[-1] == f"{meant}?"


def test_all_of_them_come_in_one_error_before_any_other(tmp_path):
    path = tmp_path / "x.toml"
    path.write_text(
        'name = "x"\n[block]\nside = -2.0\ndt = 0.1\n[time]\nstepp = -1\n[sweep]\n"time.gama" = [1]\n'
        "[[gate]]\npear = 1\n[nonsense]\nkey = 1\n"
    )
    with pytest.raises(InputError) as refused:
        load_scene(path)
    assert refused.value.rule == f"{UNKNOWN}s"
    assert refused.value.field == "name, block.dt, time.stepp, sweep.time.gama, gate.0.pear, nonsense"
    assert re.findall(r"(\S+) for ([\w.]+)", refused.value.advice) == [
        *(("title", "name"), ("time.step", "block.dt"), ("time.step", "time.stepp")),
        *(("time.delta", "sweep.time.gama"), ("gate.pair", "gate.0.pear")),
    ]


@pytest.mark.parametrize(("field", "meant"), MEANT["plane"].items())
def test_the_key_of_blocks_in_the_plane_that_was_meant_is_named(field, meant):
    block = {"name": "A", "rectangle": [1.0, 1.0], "velocity": [1.0, 0.0]}
    contact = {"stiffness": 1e9}
    plane = {"young": 1e9, "density": 2500.0, "contact": contact, "block": [block]}
    data = {"plane": plane, "time": {"step": 0.01, "steps": 10}}
    place, _, key = field.rpartition(".")
    {"plane": plane, "plane.block": block, "plane.contact": contact}[place][key] = 1.0
    with pytest.raises(InputError) as refused:
        parse_scene(data, "boxes")
    assert refused.value.advice.split()[-1] == f"{meant}?"
