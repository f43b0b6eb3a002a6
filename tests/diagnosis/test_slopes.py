"""`compare` on slopes: the law that a history obeys, from programs that are not the suite's."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import thinned
from oracles.sliding_block import SLIDER, history

from validation import load_scene
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign, read
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


CASES = [(1e-2, 30), (2e-3, 15), (2e-4, 22)]


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


@pytest.mark.long
@pytest.mark.parametrize(("step", "phi"), CASES[1:])
def test_a_base_with_mass_of_its_own_does_not_hide_the_law(step, phi):
    """A base 18 times as heavy as the block that adds 0.2 % to the static displacement, as that of ntdda does."""
    steps = 800 if step < 1e-3 else 300
    found = program(dt=step, phi=phi, steps=steps, lagged=True, **BANDS, p=1e9, base=(18.0, 8e11))
    answer = judged(found, time__step=step, contact__friction=phi)
    band = ["dead-band"] if step < 5e-4 else []
    assert answer.causes == ["lagged-friction", *band, "base-compliance", "own-weight"]
    assert answer.values["base-compliance"] == pytest.approx(2e-3, rel=0.3)


@pytest.mark.parametrize(("step", "phi"), thinned(CASES, 3))
def test_a_sound_program_is_the_same_model(step, phi):
    found = sound(dt=step, phi=phi, steps=100 if step == 1e-2 else 500)
    answer = judged(found, time__step=step, contact__friction=phi)
    assert answer.causes == []
    assert not answer.departs


AVERAGE = {"time__alpha": 0.25, "time__delta": 0.5}
SWINGS = [(5e-3, True), (1e-3, False)]


@pytest.mark.long
@pytest.mark.parametrize(("step", "consistent"), SWINGS)
def test_a_sound_program_without_damping_is_the_same_model(step, consistent):
    """At 5 ms from a consistent start two programs fall apart after 200 steps by their rounding alone."""
    steps = 500 if step == 5e-3 else 250
    found = sound(dt=step, steps=steps, alpha=0.25, delta=0.5, consistent=consistent)
    start = "consistent" if consistent else "zero"
    answer = judged(found, time__step=step, time__start=start, **AVERAGE)
    assert answer.causes == []
    assert not answer.departs
    falls_apart = (step, consistent) == (5e-3, True)
    assert any(stage.name == "horizon" for stage in answer.evidence) == falls_apart


@pytest.mark.long
def test_noise_hides_no_model():
    found = sound(steps=300)
    noise = np.random.default_rng(1).standard_normal((2, 300)) * 1e-3 * np.max(np.abs(found.displacement))
    shaken = Foreign(found.time, found.displacement + noise[0], sideways=found.sideways + noise[1])
    assert compare(scene(), shaken).causes == []
    # tan(22 deg) over tan(21.5 deg); noise of 0.1 % leaves the other numbers several times as much
    wrong = compare(scene(contact__friction=21.5), shaken)
    assert wrong.causes == ["friction-factor"]
    assert wrong.values["friction-factor"] == pytest.approx(1.02567, rel=2e-3)


LIGHT = {"force": (0.0, 0.0), "g": 9.81}
LIGHT_SCENE = {"load__gravity": 9.81, "load__slope": 15.2, "contact__friction": 15.0}


def factor_on_friction(theirs, ours):
    """Return tan(phi) of a history over that of its scene, phi in degrees."""
    return math.tan(math.radians(theirs)) / math.tan(math.radians(ours))


# what the history was made with, what its scene has, and the number that is wrong with its value
BIASES = [
    ({"p": 1.01e9}, {}, "normal-springs-factor", 1.01),
    ({"dt": 1e-3, "gg": 0.999}, {}, "gg", 0.999),
    ({"dt": 5e-4, "ps": 4.4e8}, {}, "shear-springs-factor", 1.1),
    # the scene's load is its weight, which is heavier with the block
    (
        {"rho": 2970.0, "force": (1.1 * LOAD * math.sin(SLOPE), -1.1 * LOAD * math.cos(SLOPE))},
        {},
        "density-factor",
        1.1,
    ),
    ({"cohesion": 2e4}, {}, "cohesion", 2e4),
    (LIGHT | {"slope": 15.2, "phi": 15.1}, LIGHT_SCENE, "friction-factor", factor_on_friction(15.1, 15)),
    (LIGHT | {"slope": 15.1, "phi": 15.0}, LIGHT_SCENE, "slope-factor", 15.1 / 15.2),
]


@pytest.mark.long
@pytest.mark.parametrize(("theirs", "ours", "cause", "value"), BIASES)
def test_a_small_bias_adds_up_and_is_named(theirs, ours, cause, value):
    """Each leaves less than one per cent of the limit of friction at a step, and some per cent of the motion."""
    answer = judged(sound(steps=200, **theirs), time__step=theirs.get("dt", 2e-3), **ours)
    assert answer.causes == [cause]
    assert answer.values[cause] == pytest.approx(value, rel=1e-4)
    assert answer.departs
    stages = {stage.name: stage for stage in answer.evidence}
    assert stages["horizontal_displacement"].agrees is False  # of the scene as it is, whatever another number explains
    assert (stages["friction"].agrees is False) == (cause in ("friction-factor", "shear-springs-factor", "cohesion"))


@pytest.mark.long
def test_springs_that_give_the_rows_of_a_base_are_told_beside_it():
    answer = judged(program())  # its springs are softer by a factor that nobody types
    assert answer.causes == ["base-compliance", "own-weight"]
    assert [one["causes"] for one in answer.alike] == [["normal-springs-factor"]]
    assert answer.alike[0]["values"]["normal-springs-factor"] == pytest.approx(1 - SOFT, rel=1e-5)


@pytest.mark.long
def test_what_surrounds_a_block_is_named_only_where_nothing_else_is_left():
    assert judged(program(phi=22.1, steps=80)).causes == ["unexplained"]
    assert judged(program(p=1e9, base=(18.0, 8e11), steps=80)).causes == ["base-compliance", "own-weight"]


@pytest.mark.long
@pytest.mark.parametrize("lagged", [True, False])
def test_a_factor_on_springs_across_the_base_alone_is_no_factor_on_all(lagged):
    for p, ps, of_all in ((1.1e9, 4e8, False), (2e9, 6e8, False), (1.1e9, 4.4e8, True)):
        causes = judged(sound(p=p, ps=ps, lagged=lagged, steps=60)).causes
        assert ("springs-factor" in causes) == of_all, (p, ps)


@pytest.mark.long
def test_a_lagged_program_is_what_a_lagged_scene_asks_for():
    found = program(lagged=True, **BANDS, dt=2e-4, steps=600)
    changes = {"time__step": 2e-4, "contact__rules": "lagged", "contact__band": list(BANDS.values())}
    assert judged(found, **changes).causes == ["base-compliance", "own-weight"]
    assert judged(program(), contact__rules="lagged").causes == ["unexplained"]


TRAPS = [
    ({"phi": 24.2}, True),
    ({"force": (LOAD * math.sin(0.38), -LOAD * math.cos(0.38))}, False),
    ({"height": 2.5}, True),
    ({"phi": 0.1}, False),
]


@pytest.mark.long
@pytest.mark.parametrize(("trap", "lagged"), TRAPS)
def test_what_is_in_no_catalogue_is_not_explained(trap, lagged):
    answer = judged(program(lagged=lagged, steps=60, **trap))
    assert answer.causes == ["unexplained"]
    assert answer.departs
    assert answer.nearest is not None
    assert answer.slips == ()  # without friction it slides a thousand times as far, which is no unit


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


@pytest.mark.long
def test_another_factor_on_all_springs_and_a_turned_sign_are_named():
    found = program(p=2e9, ps=8e8, lagged=True)
    answer = judged(found)
    assert answer.causes == ["springs-factor", "lagged-friction", "own-weight"]
    assert answer.values["springs-factor"] == pytest.approx(2, rel=1e-6)
    turned = compare(scene(), Foreign(found.time, found.displacement, sideways=-found.sideways))
    assert turned.causes == ["sign", *answer.causes]
    assert turned.departure.step == 1


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


def test_a_history_needs_both_directions_and_every_step():
    found = program(steps=40)
    halved = Foreign(found.time[::2], found.displacement[::2], sideways=found.sideways[::2])
    for changes, given, field in (
        ({}, Foreign(found.time, found.displacement), "horizontal_displacement"),
        ({}, halved, "time"),
        ({"time__step": 1e-3}, foreign(found), "time"),
    ):
        with pytest.raises(InputError) as refusal:
            compare(scene(**changes), given)
        assert refusal.value.field == field
