"""A user's columns in other units, with another sign, or as a force: each slip is named, and nothing sound is."""

import itertools

import numpy as np
import pytest
from conftest import thinned

from validation.runs.run import Outcome
from validation.solvers.foreign import run_of_columns
from validation.solvers.registry import get_solver

COLUMNS = ("displacement", "contact_pressure")
SI = {  # how much of it makes one s, one m, one Pa: written down here once more
    "time": {"milliseconds": 1000.0, "microseconds": 1000.0**2},
    "displacement": {"mm": 1000.0, "cm": 100.0, "micrometres": 1000.0**2, "km": 1 / 1000.0},
    "horizontal_displacement": {"mm": 1000.0, "cm": 100.0, "micrometres": 1000.0**2, "km": 1 / 1000.0},
    "rotation": {"degrees": 180 / np.pi, "mrad": 1000.0},
    "contact_pressure": {"kPa": 1 / 1000.0, "MPa": 1 / 1000.0**2, "GPa": 1 / 1000.0**3, "bar": 1 / 100000.0},
}
ASIDE = ("horizontal_displacement", "rotation")
SIDEWAYS = {"load.traction": 1e5, "load.eccentricity": 0.2, "run.columns": ["displacement", *ASIDE]}
NAMES = [(column, unit) for column, units in SI.items() for unit in units]
VARIANTS = {  # the unit must be seen on any scene, and under a solver that is off by some percent or damped otherwise
    "paper": {},
    "long steps": {"time.step": 0.01, "contact.stiffness": 1e10},
    "pulled": {"load.pressure": -2e5, "time.gg": 0.9},
}


def columns_of(scene, times=None):
    """Return the sound history of a scene, some of its columns multiplied."""
    history = get_solver("dda").solve(scene).history
    found = {"time": history.time, **history.columns}
    return {name: values * (times or {}).get(name, 1.0) for name, values in found.items()}


@pytest.mark.parametrize(
    ("column", "unit", "size", "variant"),
    thinned(((*name, size, variant) for name in NAMES for size in (0.85, 1.2) for variant in VARIANTS), 11),
)
def test_another_unit_is_named(scene, column, unit, size, variant):
    if column == "time":
        size = 1.0  # the instants are the scene's own
    scene, factor = scene.with_values(VARIANTS[variant] | (SIDEWAYS if column in ASIDE else {})), SI[column][unit]
    run = run_of_columns(scene, columns_of(scene, {column: size * factor}))
    assert run.outcome is Outcome.WRONG_UNITS
    assert f"{column} is {factor:g} " in run.notes[0] and run.notes[0].endswith(f" {unit}?")


def test_another_sign_is_named(scene):
    for column, values in itertools.product(COLUMNS, VARIANTS.values()):
        varied = scene.with_values(values)
        run = run_of_columns(varied, columns_of(varied, {column: -1.0}))
        assert run.outcome is Outcome.WRONG_UNITS and f"sign: {column} " in run.notes[0]


@pytest.mark.parametrize("width", [0.4, 1.6, 2.0, 7.0])
def test_a_force_instead_of_a_pressure_is_named_by_the_base(scene, width):
    scene = scene.with_values({"block.width": width, "block.height": 1.5})
    run = run_of_columns(scene, columns_of(scene, {"contact_pressure": width}))
    assert run.outcome is Outcome.WRONG_UNITS
    words = f"wrong units: contact_pressure is {width:g} times what is expected, the length of the base: a force?"
    assert run.notes == (words,)
    # a displacement off by the same factor is bad, but no force
    assert run_of_columns(scene, columns_of(scene, {"displacement": width})).outcome is Outcome.COMPLETED


@pytest.mark.parametrize(
    "times",
    [
        {},
        {"displacement": 0.5},
        {"displacement": 10.0},  # no unit is ten times another here
        {"contact_pressure": 1.05},  # nearly one: not the base's length of 2 m
        {"contact_pressure": 1.9, "displacement": 3.0},
        {"contact_pressure": 2.0, "displacement": 1.5},  # one spring in place of two, on a base of 2 m
        {"contact_pressure": 0.0},
    ],
    ids=str,
)
def test_a_bad_answer_in_si_is_no_slip_of_units(scene, times):
    assert run_of_columns(scene, columns_of(scene, times)).outcome is Outcome.COMPLETED


def test_a_history_without_the_displacement_has_no_shape(scene):
    run = run_of_columns(scene, {"velocity": columns_of(scene)["displacement"]})
    assert run.outcome is Outcome.WRONG_SHAPE and "velocity" in run.notes[0]
    assert "step 0" in run_of_columns(scene, {"displacement": np.zeros(scene.time.steps + 1)}).notes[0]


def test_time_is_judged_before_the_columns(scene):
    run = run_of_columns(scene, columns_of(scene, {"time": 1e3, "displacement": 1e3}))
    assert "1000" in run.notes[0]
    late = columns_of(scene) | {"time": columns_of(scene)["time"] + scene.time.step}
    assert run_of_columns(scene, late).outcome is Outcome.WRONG_SHAPE
