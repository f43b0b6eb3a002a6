"""Unknown keys of a scene: all of them first, in one error, each with the key that was probably meant."""

import copy
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


PLANE = {
    "young": 1e9,
    "density": 2500.0,
    "contact": {"stiffness": 1e9},
    "block": {"name": "A", "rectangle": [1.0, 1.0]},
}
BOXES = {"plane": PLANE, "time": {"step": 0.01, "steps": 10}}
KEYS = [(scene, *row) for kind, scene in (("blocks", SCENE), ("plane", BOXES)) for row in MEANT[kind].items()]


def with_key(scene, field):
    """Return a scene's data with a key of the value 1 added."""
    data = copy.deepcopy(scene)
    first, _, rest = field.rpartition(".") if not field.startswith("sweep.") else field.partition(".")
    table = data
    for name in filter(None, first.split(".")):
        table = table.setdefault(name, {})
    table[rest] = 1
    if scene is BOXES:
        data["plane"]["block"] = [data["plane"]["block"]]
    return data


@pytest.mark.parametrize(("scene", "field", "meant"), KEYS)
def test_the_key_that_was_meant_is_named(scene, field, meant):
    with pytest.raises(InputError) as refused:
        parse_scene(with_key(scene, field), "x.toml")
    error = refused.value
    named = error.field.replace("block.0", "block")
    assert (error.rule, error.source, error.advice.split()[-1]) == (UNKNOWN, "x.toml", f"{meant}?")
    assert named == field or field.startswith(f"{named}.")  # of a table, the table


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
