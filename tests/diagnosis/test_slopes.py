"""`compare` on slopes: the law that a history obeys, from programs that are not the suite's."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import thinned
from oracles.sliding_block import SLIDER, history

from validation import load_scene, solve
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign, Stepping, read
from validation.diagnosis.readings import Reading
from validation.diagnosis.slopes import SlopeSearch
from validation.errors import InputError

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "ntdda"
FILE = EXAMPLE / "ntdda-phi22-slope20-dt2ms_meas.m"
LOAD, WEIGHT, SLOPE = 1e6, 10800 * 9.81, math.radians(20)
SOFT = 3e-3  # of the normal springs: the base of such a program
BANDS = {"band": 1e-3, "opening_band": 1e-6}  # m


def scene(**changes):
    return load_scene(EXAMPLE / "slope.toml").with_values({k.replace("__", "."): v for k, v in changes.items()})


def foreign(found):
    return Foreign(found.time, found.displacement, sideways=found.sideways)


def program(**changes):
    """A program that adds the block's weight, straight down, on a base that yields a little."""
    force = (LOAD * math.sin(SLOPE), -LOAD * math.cos(SLOPE) - WEIGHT)
    data = {"phi": 22.0, "dt": 2e-3, "steps": 300, "force": force, "p": 1e9 * (1 - SOFT)}
    return history(replace(SLIDER, **(data | changes)))


def sound(**changes):
    """A program without weight on a base that does not yield: the scene's own model."""
    plain = {"steps": 500, "force": (LOAD * math.sin(SLOPE), -LOAD * math.cos(SLOPE)), "p": 1e9}
    return program(**(plain | changes))


def judged(found, **changes):
    return compare(scene(**changes), foreign(found))


@pytest.mark.long
def test_a_run_of_ntdda_is_named_by_lagged_friction_and_weight():
    answer = compare(scene(), read(FILE))
    assert answer.causes == ["lagged-friction", "base-compliance", "own-weight"]
    assert answer.values["own-weight"] == pytest.approx(1, abs=0.01)
    assert answer.values["base-compliance"] == pytest.approx(2e-3, rel=0.2)  # of its other history: 0.15 to 0.26 %
    held = answer.evidence[-1].numbers
    assert (held["lagged"] or 1.0) < 1e-3 < 0.1 < (held["consistent"] or 0.0)
    assert answer.departure.kind == "offset"


CASES = [(1e-2, 30), (2e-4, 22)]


@pytest.mark.long
@pytest.mark.parametrize(("step", "phi"), CASES)
def test_creep_and_sliding_of_such_a_program_are_named(step, phi):
    steps = 100 if step == 1e-2 else 800 if step < 1e-3 else 300
    found = program(dt=step, phi=phi, steps=steps, lagged=True, **BANDS)
    answer = judged(found, time__step=step, contact__friction=phi)
    flies = step < 5e-4  # else no corner opens, and a dead band has no effect
    band = ["dead-band"] if flies else []
    assert answer.causes == ["lagged-friction", *band, "base-compliance", "own-weight"]
    assert answer.values["own-weight"] == pytest.approx(1, abs=1e-3)
    if flies:
        assert 0.9 * BANDS["band"] < answer.values["dead-band"] <= BANDS["band"]


@pytest.mark.parametrize(("step", "phi"), thinned(CASES, 3))
def test_a_sound_program_is_the_same_model(step, phi):
    found = sound(dt=step, phi=phi, steps=100 if step == 1e-2 else 500)
    answer = judged(found, time__step=step, contact__friction=phi)
    assert answer.causes == []
    assert not answer.departs


@pytest.mark.long
def test_a_small_bias_adds_up_and_is_named():
    """Cohesion of less than one per cent of the limit of friction at a step, and some per cent of the motion."""
    answer = judged(sound(cohesion=2e4))
    assert (answer.causes, answer.values) == (["cohesion"], {"cohesion": pytest.approx(2e4, rel=1e-4)})
    assert {stage.name: stage.agrees for stage in answer.evidence}["friction"] is False


@pytest.mark.long
def test_what_is_in_no_catalogue_is_not_explained():
    answer = judged(program(lagged=True, steps=120, height=2.5))
    assert answer.causes == ["unexplained"] and answer.nearest is not None and answer.slips == ()


def test_displacements_in_millimetres_are_a_unit_of_both_columns():
    found = sound(steps=40)
    both = ("displacement", "horizontal_displacement")
    answer = compare(scene(), Foreign(found.time, 1e3 * found.displacement, sideways=1e3 * found.sideways))
    assert answer.causes == ["unit"]
    assert answer.remedy.split()[1] == ",".join(f"{name}=0.001" for name in both)
    assert [(slip.column, slip.factor) for slip in answer.slips] == [(name, 1e3) for name in both]
    swapped = compare(scene(), Foreign(found.time, found.sideways, sideways=found.displacement))
    assert swapped.causes == ["swapped"]
    assert swapped.remedy.split() == ["--columns", f"{both[0]}={both[1]},{both[1]}={both[0]}"]


@pytest.mark.parametrize(
    ("changes", "value"),
    [
        ({"run__geometry": "updated"}, "large rotation"),
        ({"time__alpha": 0.0, "time__delta": 0.5, "time__step": 1e-4}, "alpha = 0"),
        ({"contact__gap": 1e-3}, "another scene"),
    ],
)
def test_scenes_that_it_does_not_take_are_refused(changes, value):
    with pytest.raises(InputError) as refusal:
        judged(program(steps=20), **changes)
    assert refusal.value.value == value


def test_a_history_needs_both_directions_and_every_step_in_seconds_of_one_scene():
    found = program(steps=40)
    halved = Foreign(found.time[::2], found.displacement[::2], sideways=found.sideways[::2])
    for given_scene, given, field in (
        (scene(), Foreign(found.time, found.displacement), "horizontal_displacement"),
        (scene(), halved, "time"),
        (scene(time__step=1e-3), foreign(found), "time"),
        (scene().model_copy(update={"sweep": load_scene("slope-sliding").sweep}), foreign(found), "sweep"),
        (scene(), replace(foreign(found), time=1e3 * found.time), "time"),
    ):
        with pytest.raises(InputError) as refusal:
            compare(given_scene, given)
        assert refusal.value.field == field
    assert "--scale time=0.001" in refusal.value.advice


def test_a_run_that_makes_much_of_rounding_tells_up_to_a_step():
    """Rounding grows at each switch: where it takes over differs between programs, but not before row 20."""
    shaken = scene(time__alpha=0.25, time__delta=0.5, time__start="consistent", time__step=1e-2, time__steps=80)
    others = {"contact.stiffness": 1e9 * (1 + 2e-13), "run.columns": list(SlopeSearch.NAMES)}
    run = solve(shaken.with_values(others), "dda")
    place = np.array([run.history.columns[name] for name in SlopeSearch.NAMES])
    moved = np.where(np.arange(80) < 20, 0.0, 1e-5) * np.max(np.abs(place), axis=1, keepdims=True)
    for columns, is_scene in ((place, True), (place + moved, False)):
        steps = Stepping(np.full(80, 1e-2), np.arange(80))
        search = SlopeSearch(shaken, Reading(steps, columns, np.zeros(columns.shape)))
        assert search.is_scene() is is_scene and 20 < search.rows < 80
