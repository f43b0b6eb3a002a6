"""What `compare` says of few steps on a slope: causes, first steps, digits, noise, and the suite's own run."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.sliding_block import SLIDER, history

from validation import load_scene, solve
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign, Stepping
from validation.diagnosis.readings import Reading
from validation.diagnosis.slopes import SlopeSearch, habits_of, search_of
from validation.errors import InputError

SCENE = load_scene(Path(__file__).parents[2] / "docs" / "examples" / "ntdda" / "slope.toml")
LOAD, WEIGHT, SLOPE = 1e6, 10800 * 9.81, math.radians(20)


def program(weight=0.0, **changes):
    """A program of someone else's in which a share of the block's weight acts straight down."""
    force = (LOAD * math.sin(SLOPE), -LOAD * math.cos(SLOPE) - weight * WEIGHT)
    return history(replace(SLIDER, phi=22.0, dt=2e-3, steps=16, force=force, **changes))


def judged(found, sign=1.0):
    return compare(SCENE, Foreign(found.time, found.displacement, sideways=sign * found.sideways))


LAGS = {"lagged": True}
SPRINGS = {"p": 2e9, "ps": 8e8}


@pytest.mark.parametrize(
    ("theirs", "sign", "causes", "first"),
    [
        (LAGS, 1, ["lagged-friction"], 6),
        pytest.param(SPRINGS | LAGS, -1, ["sign", "springs-factor", "lagged-friction"], 1, marks=pytest.mark.long),
        pytest.param(SPRINGS, 1, ["springs-factor"], 1, marks=pytest.mark.long),
        pytest.param({"weight": 0.5} | LAGS, 1, ["unexplained"], 1, marks=pytest.mark.long),
    ],
)
def test_few_steps_tell_the_law(theirs, sign, causes, first):
    answer = judged(program(**theirs), sign)
    assert answer.causes == causes
    assert answer.values == ({"springs-factor": pytest.approx(2, rel=1e-6)} if "springs-factor" in causes else {})
    assert answer.departure.step == first


@pytest.mark.long
def test_few_digits_tell_the_law():
    found = program(lagged=True)
    u = np.array([float(f"{x:.3e}") for x in found.sideways])
    units = 10.0 ** (np.floor(np.log10(np.abs(u))) - 3)
    answer = compare(SCENE, Foreign(found.time, found.displacement, sideways=u, sideways_rounding=units))
    assert answer.causes == ["lagged-friction"]


# ---- the suite's own run --------------------------------------------------------------------------------------------


def own(scene):
    history = solve(scene.with_values({"run.columns": list(SlopeSearch.NAMES)}), "dda").history
    return np.array([history.columns[name] for name in SlopeSearch.NAMES])


def beside(scene, place):
    steps = Stepping(np.full(scene.time.steps, scene.time.step), np.arange(scene.time.steps))
    return SlopeSearch(scene, Reading(steps, place, np.zeros(place.shape)))


@pytest.mark.parametrize("steps", [120, 60])
def test_noise_is_no_departure_and_a_shape_is_one(steps):
    scene = SCENE.with_values({"time.steps": steps})
    place = own(scene)
    noise = np.random.default_rng(1).standard_normal(place.shape) * np.max(np.abs(place), axis=1, keepdims=True)
    exact = beside(scene, place)
    assert exact.is_scene() and exact.left(exact.scene_run) == 0
    assert beside(scene, place + 1e-3 * noise).is_scene()
    wrong_row = place + 1e-3 * noise
    wrong_row[:, steps // 2] *= 1.02
    assert not beside(scene, wrong_row).is_scene()
    assert not beside(scene, place + 3e-2 * noise).is_scene()
    assert not beside(scene, place * (1 + 1e-3)).is_scene()


def test_a_run_that_makes_much_of_rounding_tells_up_to_a_step():
    values = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent", "time.step": 1e-2, "time.steps": 80}
    scene = SCENE.with_values(values)
    place = own(scene.with_values({"contact.stiffness": scene.contact.stiffness * (1 + 2e-13)}))
    search = beside(scene, place)
    # Rounding grows at each switch: where it takes over differs between programs, but not before the later difference.
    assert search.is_scene() and 20 < search.rows < 80
    moved = np.where(np.arange(80) < 20, 0.0, 1e-5) * np.max(np.abs(place), axis=1, keepdims=True)
    assert not beside(scene, place + moved).is_scene()


@pytest.mark.parametrize("along", [pytest.param(True, marks=pytest.mark.long), False])
def test_weight_and_a_softer_base_are_run(along):
    """The springs along the base are softer as those across it, or the scene's."""
    found = program(1.0, p=0.997e9, ps=4e8 * (0.997 if along else 1.0))
    search = search_of(SCENE, Foreign(found.time, found.displacement, sideways=found.sideways))
    ((habits, run),) = habits_of(search)
    assert run.explains and not search.is_scene()
    assert math.exp(-habits.softness) == pytest.approx(0.997, rel=1e-6)
    assert habits.along is along
    assert 0 <= habits.error < 1e-6


def test_a_scene_of_many_values_or_another_unit_of_time_is_refused():
    found = program()
    many = SCENE.model_copy(update={"sweep": load_scene("slope-sliding").sweep})
    for scene, factor, field in ((many, 1, "sweep"), (SCENE, 1e3, "time")):
        with pytest.raises(InputError) as refusal:
            compare(scene, Foreign(factor * found.time, found.displacement, sideways=found.sideways))
        assert refusal.value.field == field
    assert "--scale time=0.001" in refusal.value.advice
