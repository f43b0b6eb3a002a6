"""Histories beside scenes with a column whose contacts open or slip: right or silent, never wrong."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from oracles.scheme_histories import rounded

from validation import solve
from validation.diagnosis import columns
from validation.diagnosis.beside import RunVerdict
from validation.diagnosis.columns import ColumnSearch
from validation.diagnosis.judgement import compare
from validation.diagnosis.one_change import of_scene
from validation.diagnosis.reading import Foreign, steppings
from validation.diagnosis.readings import Reading, Slip
from validation.errors import InputError
from validation.scenes.scene import parse_scene

DIGITS = 8


def scene_of(column, layer, time, **tables):
    data = {
        "column": {"layer": [{"thickness": 3.0, "density": 2500.0, "young": 1e9, "blocks": 3} | layer], **column},
        "time": {"alpha": 0.25, "delta": 0.5, "start": "consistent"} | time,
        "run": {"solvers": ["dda"], "columns": ["displacement", "contact_pressure"]},
        **tables,
    }
    return parse_scene(data, "stack")


DROPPED = scene_of(
    {"motion": "pressure", "law": "unilateral", "stiffness": 1e9, "gap": 5e-4, "gravity": 9.81}
    | {"joint": [{"height": 0.0, "stiffness": 1e9, "gap": 2e-3}]},
    {"young": math.inf, "velocity": -1.0},
    {"step": 8e-5, "steps": 200},
)
SHEARED = scene_of(
    {"motion": "shear", "law": "frictional", "stiffness": 1e9, "strength": 2e4},
    {},
    {"step": 5e-4, "steps": 160},
    input={"at": "base", "shape": "half-sine", "velocity": 0.2, "duration": 0.03},
)


SOFT_BASE = {"height": 0.0, "stiffness": 7e8, "gap": 2e-3}


def history(scene, values, digits, every=1):
    """Return the history of a scene with other values, as a file holds it."""
    run = solve(scene.with_values(values), "dda")
    rows = slice(every - 1, None, every)
    return Foreign(run.time[rows], *(rounded(x[rows], digits) for x in (run.displacement, run.contact_pressure)))


def judged(scene, digits=DIGITS, pressure=True, **values):
    foreign = history(scene, {key.replace("__", "."): value for key, value in values.items()}, digits)
    return compare(scene, foreign if pressure else replace(foreign, pressure=None))


@pytest.mark.parametrize("scene", [DROPPED, pytest.param(SHEARED, marks=pytest.mark.long)])
def test_the_scene_s_own_history_is_the_scene_s(scene):
    answer = judged(scene.with_values({"time.steps": 60}))
    assert (answer.causes, answer.departs, answer.departure) == ([], False, None)
    assert answer.misfit < 1e-6
    assert all(stage.agrees for stage in answer.evidence)


@pytest.mark.long
@pytest.mark.parametrize(
    ("scene", "values", "cause", "number"),
    [
        (SHEARED, {"column__strength": 1.5e4}, "strength-factor", 0.75),
        (SHEARED, {"column__strength": 2e-5}, "no-friction", None),  # and no factor of almost nothing
        (DROPPED, {"column__joint": [SOFT_BASE]}, "springs-factor", 0.7),
    ],
)
def test_one_thing_changed_is_named_with_its_number(scene, values, cause, number):
    answer = judged(scene, **values)
    is_named(answer, cause, number)
    assert (" 0 m" in answer.sentence) == ("column__joint" in values)


def is_named(answer, cause, number):
    assert answer.causes == [cause]
    assert answer.departs and answer.departure.step >= 1
    assert answer.values.get(cause) == (number if number is None else pytest.approx(number, rel=1e-5))
    assert answer.misfit < 1e-6


def test_one_of_few_candidates_is_named(monkeypatch):
    few = [one for one in of_scene(DROPPED, ()) if one.id in ("start", "gg")]
    monkeypatch.setattr(ColumnSearch, "candidates", lambda search: few)
    answer = judged(DROPPED.with_values({"time.steps": 40}), time__gg=0.99)
    is_named(answer, "gg", 0.99)
    assert any(stage.agrees is False for stage in answer.evidence)  # a fault explained is a fault


def beside(scene, foreign):
    reading = Reading(steppings(foreign, scene.time.step)[0], np.array([foreign.displacement, foreign.pressure]))
    return ColumnSearch(reading.scene_of(scene), reading)


def test_steps_of_a_program_are_runs_at_parts_of_the_step():
    search = beside(DROPPED, history(DROPPED, {"time.steps": 40}, DIGITS))
    half = {"time.step": DROPPED.time.step / 2}
    fine = solve(DROPPED.with_values(half | {"time.steps": 80}), "dda")
    both = search.run(half, 40)
    assert both == pytest.approx(np.array([fine.displacement[1::2], fine.contact_pressure[1::2]]))
    locked = search.result({columns.BONDED: True}, 40)
    assert locked.columns["displacement"][-1] != pytest.approx(search.scene_run[0, -1])
    assert search.run({"time.step": -1.0}, 40) is None


SIGN = (Slip("sign", "displacement", -1.0),)
NAMED = {"explained": True, "causes": {"gg": 0.9}, "words": {"gg": "WORDS"}}
ALIKE = {"explained": False, "alike": [{"causes": ["gg"], "values": {}, "further_scene": ""}]}
READINGS = [  # which of two readings are the scene's own, their slips, what else explains the first, causes, alike
    ((True, True), ((), ()), {"explained": False}, [], []),
    ((False, True), ((), SIGN), {"explained": False}, ["sign"], []),
    ((False, True), ((), SIGN), NAMED, ["unexplained"], [["gg"], ["sign"]]),
    ((False, True), ((), SIGN), ALIKE, ["unexplained"], [["gg"], ["sign"]]),
    ((False, False), ((), SIGN), NAMED, ["gg"], []),
    ((False, False), (SIGN, SIGN), {"explained": False}, ["unexplained"], []),
]


def test_a_slip_of_sign_is_named_where_nothing_else_explains_the_rows(monkeypatch):
    foreign = history(DROPPED, {"time.steps": 40}, DIGITS)
    searches = [beside(DROPPED, foreign), beside(DROPPED, foreign)]
    monkeypatch.setattr(columns, "searches_of", lambda *given: searches)
    for are_own, slips, verdict, causes, alike in READINGS:
        for search, is_own, corrected in zip(searches, are_own, slips, strict=True):
            search.reading = replace(search.reading, corrected=corrected)
            search.is_scene = lambda tolerance, is_own=is_own: is_own
            search.explanations = lambda: []
        monkeypatch.setattr(columns, "verdict_of", lambda one, found, verdict=verdict: RunVerdict(one, **verdict))
        answer = compare(DROPPED, foreign)
        assert (answer.causes, [one["causes"] for one in answer.alike]) == (causes, alike)


def test_rows_behind_the_horizon_are_not_judged(monkeypatch):
    """With a shift of 1e-4 for 1e-12 the horizon lies inside the run; what comes behind it may be anything."""
    monkeypatch.setattr(columns, "SHIFT", 1e-4)
    foreign = history(DROPPED, {}, DIGITS)
    search = beside(DROPPED, foreign)
    assert 0 < search.rows < DROPPED.time.steps
    foreign.displacement[search.rows :] *= 2.0
    answer = compare(DROPPED, foreign)
    assert answer.causes == []
    (stage,) = (stage for stage in answer.evidence if stage.name == "horizon")
    assert stage.agrees is None
    assert stage.numbers["rows"] == search.rows


def test_a_file_that_ends_where_more_solves_are_needed_than_ever_before_says_so():
    """Six rigid blocks that touch, thrown on their base, need seven solves in the step of the impact."""
    thrown = scene_of(
        {"motion": "pressure", "law": "unilateral", "stiffness": 1e9}
        | {"joint": [{"height": 0.0, "stiffness": 1e9, "gap": 2.05e-3}]},
        {"thickness": 6.0, "blocks": 6, "young": math.inf, "velocity": -1.0},
        {"step": 1e-4, "steps": 40},
    )
    foreign = history(thrown, {"time.steps": 20}, DIGITS)
    (note,) = compare(thrown, foreign).notes
    assert {"20", "40", "6"} <= set(re.findall(r"\d+", note))
    limited = thrown.with_values({"column.solve_limit": 5})
    (note,) = compare(limited, history(thrown, {}, DIGITS)).notes
    assert re.findall(r"\d+", note) == ["5", "21"]


def test_times_that_are_not_uniform_are_refused():
    foreign = history(DROPPED, {}, DIGITS)
    with pytest.raises(InputError, match="uniform"):
        compare(DROPPED, replace(foreign, time=foreign.time**1.01))
