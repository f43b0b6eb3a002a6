"""Histories beside other solvers than DDA, with formulas in the place of their runs."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.kept_answers import said
from oracles.stand_ins import assert_kept, summed
from oracles.swings import motion

from validation import load_scene, solve
from validation.diagnosis import evidence, one_change, other_solvers
from validation.diagnosis.judgement import compare
from validation.diagnosis.other_solvers import (
    RIVALS,
    SolverSearch,
    judged_without_rectangle,
    not_installed,
    rivals_of,
    verdict_of_solvers,
)
from validation.diagnosis.reading import Foreign, Stepping
from validation.diagnosis.readings import Reading, Slip
from validation.errors import InputError

KEPT = Path(__file__).with_name("numbers.toml")
SCENE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 44})
TIME = 0.002 * np.arange(1, 45)
MESHES = {"dda": 0.0, "bar": 0.0, "continuum": 0.0, "fem": 0.03}  # relative error of the swing
BEYOND = 1e10  # N/m of springs, with which no step is stable


def run_of(name, scene):
    """Return the run of a solver: exact ones have no error of a scheme, DDA and elements have."""
    if scene.contact.stiffness > BEYOND:
        raise InputError("unstable")
    history = motion(scene, {"time.gg": scene.time.discount}, name in ("bar", "continuum"))
    columns = [x * (1 + MESHES[name] * np.sin(9 * history.time / TIME[-1])) for x in history.columns.values()]
    if name == "continuum":
        columns = [x * (1 + 0.1 * history.time / TIME[-1]) for x in columns]
    history = replace(history, columns=dict(zip(history.columns, columns, strict=True)))
    return SimpleNamespace(displacement=columns[0], contact_pressure=columns[1], history=history)


def solver(name, refusal=None, missing=None):
    return SimpleNamespace(
        name=name,
        meshed=name == "fem",
        solve=lambda scene: run_of(name, scene),
        refusal=lambda scene: refusal,
        missing=lambda scene: missing,
    )


@pytest.fixture(autouse=True)
def solvers(monkeypatch):
    """Solvers that are formulas, with fewer numbers to begin from; what is put in replaces one."""
    replaced = {}
    monkeypatch.setattr(other_solvers, "get_solver", lambda name: replaced.get(name) or solver(name))
    monkeypatch.setattr(one_change, "get_solver", other_solvers.get_solver)
    monkeypatch.setattr(other_solvers, "STARTS", (0.8, 1.25))
    monkeypatch.setattr(one_change, "DISCOUNTS", (0.99, 0.97))
    return replaced


def recorded(name, **values):
    run = run_of(name, SCENE.with_values({key.replace("__", "."): value for key, value in values.items()}))
    return np.array([run.displacement, run.contact_pressure])


def reading(columns, *corrected):
    return Reading(Stepping(np.full(44, 0.002), np.arange(44)), columns, None, corrected)


def verdict(columns, names=RIVALS, scene=SCENE):
    return verdict_of_solvers(scene, [reading(columns)], names)


CHANGED = [
    ("bar", {}, {}),
    ("continuum", {}, {"exact-in-time": None}),
    ("bar", {"contact.stiffness": 1e9 / 1.04}, {"base-compliance": math.log(1.04)}),
    ("fem", {"block.young": 0.9e9}, {"young-factor": 0.9}),
    ("continuum", {"block.density": 3240.0}, {"density-factor": 1.2, "exact-in-time": None}),
]


def test_the_solver_is_named_with_what_is_changed_in_its_scene():
    for theirs, values, causes in CHANGED:
        one = verdict(recorded(theirs, **values), [theirs])
        assert one.explained and one.search.model == theirs
        assert one.causes == {
            name: value if value is None else pytest.approx(value, rel=2e-5) for name, value in causes.items()
        }
        assert one.best == pytest.approx(values, rel=1e-5)
        assert one.words.keys() >= one.causes.keys() and one.left < 2e-3
        assert ("exact bar" in one.search.model_words) is (theirs == "bar")


def test_where_nothing_explains_a_history_the_nearest_solver_is_told(solvers):
    wave = 1 + 0.2 * np.sin(np.arange(44))
    one = verdict(recorded("bar") * wave, ["continuum", "bar"])
    assert not one.explained and one.search.model == "bar"
    assert verdict(recorded("bar") * wave, []) is None
    for refused in (solver("bar", refusal="no"), solver("bar", missing="no library")):
        solvers["bar"] = refused
        assert verdict(recorded("bar"), ["bar"]) is None
    assert not_installed(SCENE, ["bar", "fem"]) == ("bar is no candidate: it no library",)
    solvers["bar"] = solver("bar", refusal="no", missing="no library")
    assert not_installed(SCENE, ["bar"]) == ()
    damped = SCENE.with_values({"time.gg": 0.99})
    assert verdict(recorded("continuum"), ["continuum"], damped) is None  # which takes minutes
    unstable = SCENE.with_values({"contact.stiffness": 2 * BEYOND})
    assert verdict(recorded("bar"), ["fem"], unstable) is None
    with pytest.raises(InputError):
        verdict(recorded("bar"), ["dda"], unstable)


def test_of_the_readings_that_a_solver_gives_the_one_without_slips_is_taken():
    columns = recorded("bar")
    readings = [reading(columns, Slip("sign", "displacement", -1.0)), reading(columns * 1.001), reading(-columns)]
    one = verdict_of_solvers(SCENE, readings, ["bar"])
    assert one.search.reading is readings[1]


def test_what_a_mesh_leaves_beside_an_exact_solution_is_noise():
    scene = recorded("bar")
    wave = np.sin(0.3 * np.arange(44))
    shape = wave / np.linalg.norm(wave) * np.linalg.norm(scene, axis=1, keepdims=True)
    for size, agrees in ((4e-3, True), (6e-3, False)):  # half a per cent of a coarse mesh
        search = SolverSearch(SCENE, reading(scene + size * shape), "bar")
        assert search.is_noise(scene) is False  # beside nothing that departs by twenty times as much
        far = SolverSearch(SCENE, reading(scene * 2 + 2 * size * shape), "bar")
        assert far.is_noise(scene * 2) is agrees
        assert SolverSearch(SCENE, reading(scene * 2 + 2 * size * shape), "fem").is_noise(scene * 2) is False
        assert SolverSearch(SCENE, reading(scene * 2 + 2 * size * shape), "dda").is_noise(scene * 2) is False


def test_runs_and_candidates_are_those_of_the_solver():
    search = SolverSearch(SCENE, reading(recorded("bar")), "bar")
    assert search.solved({"contact.stiffness": 2 * BEYOND}, 44, False) is None
    assert search.solved({"load.pressure": math.inf}, 44, False) is None
    run = search.solved({"contact.stiffness": 2e9}, 7, False)
    assert run == pytest.approx(recorded("bar", contact__stiffness=2e9)[:, :7])
    shifted = (
        search.solved({"contact.stiffness": 2e9}, 7, True)
        / recorded("bar", contact__stiffness=2e9 * (1 + 1e-12))[:, :7]
    )
    assert np.max(np.abs(shifted - 1)) < 1e-15
    tried = {}
    for name in ("bar", "continuum", "fem"):
        of_solver = SolverSearch(SCENE, reading(recorded(name)), name)
        changes = [[change.id, change.starts, change.changed(0.1)] for change in of_solver.candidates()]
        tried[name] = summed(said(changes, 0.0))
    assert_kept(KEPT, "solvers", tried)


def test_what_is_exact_in_time_departs_from_the_run_of_dda():
    one = verdict(recorded("continuum"), ["continuum"])
    own = recorded("dda")[0]
    expected = evidence.measured(own, recorded("continuum")[0], np.arange(44), 0.0)
    assert one.search.departure(one) == expected and expected.step < 10
    bar = verdict(recorded("bar"), ["bar"])
    assert bar.search.departure(bar) is None


def test_rivals_are_those_that_a_scene_allows():
    assert rivals_of(SCENE) == RIVALS
    for values in ({"block.poisson": 0.2}, {"load.eccentricity": 0.1}):
        assert rivals_of(SCENE.with_values(values)) == ("fem",)


def test_a_block_that_is_no_rectangle_is_judged_by_linear_models():
    polygon = SCENE.with_values({"block.vertices": [[0.0, 0.0], [2.0, 0.0], [1.7, 1.5], [0.2, 1.5]]})
    displacement, pressure = recorded("dda", block__density=2700 * 1.1)
    answer = judged_without_rectangle(polygon, Foreign(TIME, -displacement, pressure))
    assert (answer.causes, answer.values) == (["sign", "density-factor"], {"density-factor": pytest.approx(1.1)})
    assert len(answer.notes) == 2
    with pytest.raises(InputError):
        judged_without_rectangle(polygon, Foreign(TIME**1.01, displacement, pressure))
    with pytest.raises(InputError) as refusal:
        compare(polygon.with_values({"load.pressure": 0.0, "load.gravity": 9.81}), Foreign(TIME, 0 * TIME))
    assert refusal.value.field == "displacement"


def test_a_rival_that_explains_a_history_is_told_with_how_far_dda_is(monkeypatch):
    from validation.diagnosis import judgement

    displacement, pressure = recorded("bar", contact__stiffness=1.2e9)
    monkeypatch.setattr(judgement, "simple", judgement.as_it_is)
    answer = compare(SCENE, Foreign(TIME, displacement, pressure))
    assert (answer.model, answer.causes, answer.values) == (
        "bar",
        ["springs-factor"],
        {"springs-factor": pytest.approx(1.2)},
    )
    assert not [stage for stage in answer.evidence if stage.agrees is False]
    own = solve(SCENE, "dda").displacement
    off = 100 * np.linalg.norm(own - displacement) / np.linalg.norm(displacement)
    assert float(answer.sentence.split()[-3]) == pytest.approx(off, rel=0.06) and "exact bar" in answer.sentence
