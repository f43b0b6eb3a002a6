"""A step that is too long is told from the scheme alone, for every scene that has modes, and no other one."""

import tomllib
from pathlib import Path

import pytest

from validation.advice.coarse import AGREEMENT, SAMPLED, coarse_alarms
from validation.scenes.scene import Scene

GRANITE = {
    "block": {"side": 1.2, "density": 2650.0, "young": 5e10, "poisson": 0.25},
    "contact": {"stiffness": 5e11},
    "load": {"gravity": 9.81, "pressure": 1e6},
    "time": {"step": 1e-3, "steps": 200},
}
COLUMN = {
    "column": {"motion": "shear", "layer": [{"thickness": 10.0, "density": 2000.0, "young": 2e9, "blocks": 20}]},
    "input": {"shape": "ricker", "velocity": 0.1, "frequency": 2.0},
    "time": {"step": 1e-3, "steps": 200},
}


def scene(base=GRANITE, **changes):
    tables = {name: dict(table) for name, table in base.items()}
    for key, value in changes.items():
        table, _, field = key.partition("__")
        if value is None:
            tables[table].pop(field, None)
        else:
            tables[table] = value if not field else tables.get(table, {}) | {field: value}
    return Scene.model_validate({"name": "granite", **tables})


def kinds(case):
    return {alarm.kind for alarm in coarse_alarms(case)}


KINDS = {"AGREEMENT": AGREEMENT, "SAMPLED": SAMPLED}
ROWS = tomllib.loads(Path(__file__).with_name("coarse.toml").read_text(encoding="utf-8"))["row"]


@pytest.mark.parametrize("row", ROWS, ids=str)
def test_a_step_that_is_too_long_is_told_without_a_run(row):
    case = scene(COLUMN if row.get("column") else GRANITE, **row.get("set", {}))
    assert kinds(case) == {KINDS[name] for name in row["raised"]}
