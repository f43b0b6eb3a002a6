"""The cause of a failure: named where it is certain, silent elsewhere."""

import math

import numpy as np
import pytest

from validation.diagnosis.hooks import DiagnosisHooks
from validation.gates.gate import Status
from validation.problems import cause as module
from validation.problems import models
from validation.problems.bands import standard
from validation.problems.cause import NOT_EXPLAINED, cause
from validation.problems.judge import judge
from validation.problems.problem import problem
from validation.runs.history import History
from validation.solvers.registry import get_solver

AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
IDS = {
    "contact.stiffness": "springs-factor",
    "block.young": "young-factor",
    "load.pressure": "load-factor",
}


def datum(name, key):
    """Return a datum of a problem's scene."""
    section, _, entry = key.partition(".")
    return getattr(getattr(problem(name).scene, section), entry)


def fine(name, values, times=32, scheme=AVERAGE):
    """Return another scene's motion at the steps of a problem."""
    scene = problem(name).scene.with_values(scheme | values)
    finer = {"time.step": scene.time.step / times, "time.steps": scene.time.steps * times}
    found = get_solver("dda").solve(scene.with_values(finer)).history
    return History(found.time[times - 1 :: times], {k: x[times - 1 :: times] for k, x in found.columns.items()})


def named(name, found):
    asked = problem(name)
    held = standard(asked)
    assert judge(asked, found, held).status is Status.FAIL
    return cause(asked, found, held)


@pytest.fixture(autouse=True)
def without_compare(monkeypatch):
    """Leave out what takes tens of seconds where nothing explains a history."""
    monkeypatch.setattr(module, "compared", lambda scene, history: None)


def test_ddas_habit_and_another_integrator():
    asked = problem("locked")
    habit = named("locked", get_solver("dda").solve(asked.scene).history)
    assert (habit.ids, habit.values["alpha"]) == (("scheme",), 0.5)
    passing = fine("locked", {}, round(asked.scene.time.step / habit.passing_step), scheme={})
    assert judge(asked, passing).status is Status.PASS
    interchanged = asked.scene.with_values({"time.alpha": 1.0, "time.delta": 0.5})
    slip = named("locked", get_solver("dda").solve(interchanged).history)
    assert slip.ids == ("scheme",) and models.INTERCHANGED in slip.sentence
    average = named("locked", fine("locked", {}, 1))
    assert (average.ids, average.values["alpha"]) == (("scheme",), 0.25)


@pytest.mark.long
@pytest.mark.parametrize(
    ("key", "factor", "times"),
    [
        ("contact.stiffness", 1.05, 32),
        ("block.density", 1.2, 32),
        ("block.young", 1e-3, 128),
        # steps so fine that the motion of stiffer springs or of less mass is exact as well
        ("contact.stiffness", 1e3, 128),
        ("load.pressure", 1e-3, 128),
    ],
)
def test_a_wrong_datum_in_an_exact_program(key, factor, times):
    found = named("locked", fine("locked", {key: factor * datum("locked", key)}, times))
    # another density has the motion of another time, which is said
    cause = "time-factor" if key == "block.density" else IDS[key]
    assert found.ids == (cause,)
    assert found.values[cause] == pytest.approx(factor**-0.5 if key == "block.density" else factor, rel=2e-3)


def test_what_gives_the_same_rows_has_one_name():
    """A program may be wrong in Poisson's ratio, the speed below the base or an inertia: no datum of its own."""
    scene = problem("column").scene
    found = {number.id: number for number in DiagnosisHooks.of(scene).numbers(scene)}
    doubled = scene.with_values(found["base-factor"].changed(scene, 2.0))
    assert doubled.column.impedance == pytest.approx(2 * scene.column.impedance)
    assert "impedance" in found["base-factor"].name
    assert "Poisson" in found["young-factor"].name
    for name, words in (("rocking", "moment of inertia"), ("sliding", "gravity")):
        scene = problem(name).scene
        named = {number.id: number.name for number in DiagnosisHooks.of(scene).numbers(scene)}
        assert words in named["gravity-factor"]


def test_columns_that_are_still_or_no_numbers():
    exact = standard(problem("locked")).exact
    still = named("locked", History(exact.time, {k: 0 * x for k, x in exact.columns.items()}))
    holes = {k: np.where(exact.time > 0.05, math.nan, x) for k, x in exact.columns.items()}
    broken = named("locked", History(exact.time, holes))
    assert " 26 " in broken.sentence  # the first step that has none
    assert (still.ids, broken.ids) == (("nothing-moves",), ("not-finite",))


@pytest.mark.long
@pytest.mark.parametrize("name", ["locked", "opening", "column"])
def test_no_cause_of_a_random_history_is_wrong(name):
    """Two wrong things at once, or noise: no single one may be named.

    None of eight a problem, 24 in all: were one in eight named wrongly, that would happen once in 24 times.
    """
    exact = standard(problem(name)).exact
    rng = np.random.default_rng(len(name))
    for _ in range(8):
        wobble = 1 + 0.2 * rng.standard_normal() * np.sin(rng.uniform(0.3, 2.0) * np.arange(len(exact.time)))
        noise = 0.2 * rng.standard_normal()
        seen = {}
        for key, x in exact.columns.items():
            seen[key] = wobble * x + noise * np.abs(x).max() * rng.standard_normal(len(x))
        found = History(exact.time, seen)
        if judge(problem(name), found).status is Status.FAIL:
            assert cause(problem(name), found, standard(problem(name))).sentence.startswith(NOT_EXPLAINED)


@pytest.mark.long
def test_a_discount_beside_the_usual_scheme_is_named():
    found = named("locked", get_solver("dda").solve(problem("locked").scene.with_values({"time.gg": 0.97})).history)
    assert found.ids == ("scheme", "gg")
    assert found.values["gg"] == pytest.approx(0.97, rel=1e-4)


UNITS = [
    ("opening", "displacement", 1e3),
    ("locked", "contact_pressure", 1e-6),
    ("column", "displacement_1", 1e2),
]


@pytest.mark.parametrize(("name", "column", "factor"), [pytest.param(*UNITS[0], marks=pytest.mark.long), *UNITS[1:]])
def test_a_column_in_other_units_is_named(name, column, factor):
    exact = standard(problem(name)).exact
    found = named(name, History(exact.time, {**exact.columns, column: factor * exact.columns[column]}))
    assert (found.ids, found.values) == (("unit",), {column: factor})


@pytest.mark.long
def test_a_unit_is_not_named_where_something_else_is_wrong():
    name, column, factor = UNITS[1]
    exact = standard(problem(name)).exact
    late = {key: np.append(0.0, x[:-1]) * (factor if key == column else 1.0) for key, x in exact.columns.items()}
    assert "unit" not in named(name, History(exact.time, late)).ids
    loaded = {key: factor * x for key, x in exact.columns.items()}
    assert "unit" not in named(name, History(exact.time, loaded)).ids  # which a load does as well


# ---- columns whose contacts open or slip ----------------------------------------------------------------------------

OF_BARS = ("cradle", "joint", "spall")  # whose exact motions take seconds, and a search among them a minute


def exactly(name, values):
    """Return the exact motion of a problem's scene with other values."""
    posed = problem(name)
    return get_solver(posed.truth.name).solve(posed.scene.with_values(values)).history


def of_layers(name, key, factor):
    """Return the values that change a datum of all layers by a factor, where it is a number."""
    layers = problem(name).scene.definition()["column"]["layer"]
    return {
        "column.layer": [
            layer | ({key: layer[key] * factor} if isinstance(layer.get(key), float) else {}) for layer in layers
        ]
    }


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("mass-ratio", {}),
        pytest.param("stack", AVERAGE, marks=pytest.mark.long),
        pytest.param("joint", {}, marks=pytest.mark.long),
    ],
)
def test_schemes_of_columns_on_contacts_are_named(name, values):
    posed = problem(name)
    run = get_solver("dda").solve(posed.scene.with_values(values)).history
    if judge(posed, run).status is Status.FAIL:
        identified = cause(posed, run, standard(posed))
        assert identified.ids == ("scheme",)
        assert identified.values["alpha"] == values.get("time.alpha", 0.5)
        assert (" blocks" in identified.sentence) is (name in OF_BARS)  # rigid ones have no error of their number


@pytest.mark.long
def test_a_wrong_datum_of_a_column_on_contacts_is_named():
    identified = named("cradle", exactly("cradle", of_layers("cradle", "young", 0.8)))
    assert identified.ids == ("young-factor",)
    assert identified.values["young-factor"] == pytest.approx(0.8, rel=1e-3)


@pytest.mark.long
def test_half_the_strength_of_a_joint_is_named_beside_the_usual_scheme():
    posed = problem("joint")
    weak = posed.scene.with_values({"column.joint": [{"height": 40.0, "stiffness": 1e9, "strength": 5e4}]})
    run = get_solver("dda").solve(weak).history
    assert any("strength" in identifier for identifier in cause(posed, run, standard(posed)).ids)


@pytest.mark.parametrize("name", ["mass-ratio", pytest.param("joint", marks=pytest.mark.long)])
def test_columns_on_contacts_in_millimetres_are_named(name):
    exact = standard(problem(name)).exact
    lengths = [key for key in exact.columns if key.startswith(("displacement", "gap", "slip"))]
    scaled = {key: x * (1e3 if key in lengths else 1.0) for key, x in exact.columns.items()}
    identified = named(name, History(exact.time, scaled))
    assert (identified.ids, identified.values) == (("unit",), dict.fromkeys(lengths, 1e3))
