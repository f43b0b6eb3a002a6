"""The numbers in alarms and damping budgets, against histories made by hand and closed forms written apart."""

import re
from dataclasses import replace
from types import SimpleNamespace

import pytest
from oracles.made_cases import made_row

from validation.advice.alarms import alarms, fixed_discount
from validation.advice.block_alarms import TENSION
from validation.advice.spectra import ModeDamping, runs
from validation.scenes.scene import load_scene

STEPS = 4
SCENE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": STEPS})


def raised(scene, rows, histories=None):
    """Return the alarms of made cases by kind."""
    kept = {(scene.name, solver): made_row(solver, metrics, scene.name) for solver, metrics in rows.items()}
    finished = SimpleNamespace(rows=kept, history=lambda _, solver: (histories or {}).get(solver))
    return {alarm.kind: alarm for alarm in alarms([scene], finished)}


def pulling(least, when, duration):
    return {"pressure.minimum": least, "pressure.minimum_time": when, "pressure.tension_time": duration}


def test_hidden_tension_is_in_megapascals_with_its_time_and_its_duration():
    rows = {
        "dda": pulling(-0.4321e6, 0.0025, 0.0375),
        "dda-textbook": pulling(-0.5e6, 0.1, 0.2),
        "fem:full": pulling(-0.5e6, 0.1, 0.2),
        "bar": pulling(-1.25e6, 0.015, 0.003),
        "continuum": pulling(-4.0, 0.1, 0.2),  # below a millionth of the load: rounding
        "fem": pulling(-0.5e6, 0.1, "undefined"),
        "layers": pulling(-0.5e6, "undefined", 0.2),
        "bars-events": pulling("undefined", 0.1, 0.2),
    }
    alarm = raised(SCENE, rows)[TENSION]
    assert re.findall(r"[\d.]+", alarm.sentence) == ["0.432", "0.0025", "0.0375", "1.25", "0.015", "0.003"]
    assert dict(alarm.values) == {
        "dda.minimum": -0.4321e6, "dda.time": 0.0025, "dda.duration": 0.0375,
        "bar.minimum": -1.25e6, "bar.time": 0.015, "bar.duration": 0.003,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("pairs", "warned"),
    [
        ([(0.002, 0.98), (0.001, 0.98)], ["0.98"]),
        ([(0.002, 0.98)], []),
        ([(0.002, 1.0), (0.001, 1.0)], []),
        ([(0.002, 0.0), (0.001, 0.0)], []),
        ([(0.002, 0.98), (0.001, 0.97)], []),
    ],
)
def test_a_fixed_discount_is_warned_of_where_dt_varies_and_gg_is_below_one(pairs, warned):
    cases = [SCENE.with_values({"time.step": step, "time.gg": gg}) for step, gg in pairs]
    assert [re.findall(r"0\.\d+", alarm.sentence)[0] for alarm in fixed_discount(cases)] == warned


def test_what_has_no_damping_ratio_of_its_own_is_not_split():
    """At gg < 1 a mode may oscillate that without the discount has a root that is not positive."""
    mode = ModeDamping("contact", 1e3, 0.4, 0.6, 2.0, None, None, 0.1, -0.2)
    split = {(None, None): ["40"], (0.1, 0.3): ["40", "10", "30"], (0.4, 0.0): ["40"]}
    for (algorithmic, kinetic), numbers in split.items():
        text = runs(replace(mode, algorithmic=algorithmic, kinetic=kinetic))
        assert re.findall(r"\d+", text) == numbers
        assert ("kinetic" in text) is (kinetic != 0)
    for ratio in (0.999, 1.0):
        assert ("overdamped" in runs(replace(mode, damping=ratio))) is (ratio == 1.0)
