"""What `advise` recommends, against closed forms, an elastic bar by its transform and runs made apart."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from validation import load_scene, solve
from validation.advice import goals
from validation.advice.goals import Question, recommend
from validation.advice.overview import overview
from validation.errors import InputError
from validation.models.column.pages import recommended_cut as cut_column
from validation.runs.history import History
from validation.solvers.registry import get_solver
from validation.theory import landing

GRANITE = {
    "block.side": 1.2,
    "block.density": 2650.0,
    "block.young": 5e10,
    "block.poisson": 0.25,
    "load.pressure": 0.0,
    "load.gravity": 9.81,
    "time.step": 1e-3,
}
PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002})


def with_settings(scene, offer, **values):
    return scene.with_values(offer.settings | values)


def test_a_static_block_is_as_far_from_elements_as_it_says_and_at_rest_after_its_steps(monkeypatch):
    monkeypatch.setattr(goals, "STATIC_STEPS", (8.0,))
    monkeypatch.setattr(goals, "ELEMENTS", 4)
    granite = PAPER.with_values(GRANITE)
    (offer,) = recommend(granite, "static", Question())
    case = with_settings(granite, offer, **{"time.steps": offer.steps + 20})
    elements = get_solver("fem").static(case.with_values({"fem.elements": 4}))["displacement"]
    rest = solve(case, "dda").displacement[offer.steps - 1 :]
    assert np.all(np.abs(rest / get_solver("dda").static(case)["displacement"] - 1) <= goals.RESTED)
    assert abs(rest[-1] / elements - 1) == pytest.approx(offer.displacement_error, abs=0.012)
    assert offer.is_reached and offer.settings["block.subdivide"] == [2, 2]  # of one strain a third is missing
    assert offer.settings["contact.stiffness"] == pytest.approx(5e10 / 0.05)  # E w / (h 0.05) of a square


@pytest.mark.long
@pytest.mark.parametrize("keep_springs", [False, True])
def test_an_impact_keeps_the_rebound_of_the_theory_wherever_it_lands(keep_springs):
    plain, conserving = recommend(PAPER, "impact", Question(keep_springs=keep_springs))
    assert (plain.settings["contact.stiffness"] == PAPER.contact.stiffness) is keep_springs
    assert conserving.settings["contact.rule"] == "energy-conserving"
    assert plain.is_reached and conserving.is_reached and conserving.steps < plain.steps
    lands = {"contact.law": "unilateral", "block.velocity": -3.0, "load.pressure": 0.0, "time.steps": plain.steps}
    free = with_settings(PAPER, plain, **lands)
    own = landing.own_landing(landing.stiffness_ratio(free)).restitution
    for phase in (0.1, 0.6):  # others than those that were run
        scene = free.with_values({"contact.gap": 3.0 * phase * plain.settings["time.step"]})
        motion = solve(scene, "dda").displacement
        rebound = (motion[-1] - motion[-2]) / (3.0 * plain.settings["time.step"])
        assert abs(rebound - own) <= 0.05
    exact = solve(scene, "block-events").displacement
    off = np.linalg.norm(motion - exact) / np.linalg.norm(exact)
    assert off == pytest.approx(plain.displacement_error, rel=0.5)


def test_an_impact_is_judged_by_the_worst_of_four_places_of_a_step(monkeypatch):
    """Histories are made: the exact block leaves with 0.9 of its speed, and `dda` is off by a share of each phase."""
    off = {0: 0.01, 1: 0.04, 2: 0.02, 3: 0.03, 4: 0.03}  # by quarters of a step

    def made(scene, solver, values):
        speed, gap = -scene.block.velocity, values.get("contact.gap", 0.0)
        time = values["time.step"] * np.arange(1, values["time.steps"] + 1)
        since = time - gap / speed
        flight = speed * (1.9 * np.maximum(since - 0.02, 0) - since) - gap
        error = off[round(4 * gap / (speed * values["time.step"]))] if "contact.gap" in values else 0.0
        return History(time, {"displacement": (1 + error) * flight})

    monkeypatch.setattr(goals, "history_of_run", made)
    monkeypatch.setattr(goals, "estimated_seconds", lambda *given: 1.0)
    lands = PAPER.with_values({"block.velocity": -3.0, "contact.law": "unilateral"})
    for error, is_coarsest in ((0.05, True), (0.035, False)):
        offers = recommend(lands, "impact", Question(error=error, keep_springs=True))
        assert len(offers) == 2  # with and without energy-conserving contact
        for offer in offers:
            assert 0 <= offer.steps - offer.duration / offer.settings["time.step"] < 1
            assert (offer.displacement_error == pytest.approx(0.04, rel=1e-6)) == is_coarsest
            assert not is_coarsest or offer.force_error == pytest.approx(0.9 * 0.04, rel=1e-6)
            assert offer.is_reached


@pytest.mark.long
def test_a_quake_is_followed_in_the_contact_force_too():
    (offer,) = recommend(PAPER, "quake", Question(error=0.02))
    assert offer.is_reached and offer.force_error is not None and offer.force_error <= 0.02
    assert "sideways" in offer.condition


def test_a_goal_that_does_not_apply_says_why_and_the_others_are_answered(monkeypatch):
    unloaded = PAPER.with_values({"load.pressure": 0.0, "time.steps": 20})
    with pytest.raises(InputError) as static:
        recommend(unloaded, "static", Question())
    with pytest.raises(InputError) as impact:
        recommend(load_scene("quadrilateral"), "impact", Question())
    told = []

    def answered(scene, goal, question):
        if goal in ("static", "impact"):
            raise static.value
        return (goal,)

    monkeypatch.setattr(goals, "recommend", answered)
    question = Question(error=0.03, goals=("static", "wave", "quake"), progress=lambda *done: told.append(done))
    answer = overview(unloaded, question)
    assert (answer.refused, answer.recommendations) == ({"static": static.value.rule}, ("wave", "quake"))
    assert impact.value.rule != static.value.rule and answer.error == 0.03
    assert [done[:2] for done in told] == [(number, 4) for number in range(4)]


@pytest.mark.parametrize(
    ("errors", "every"),
    [({16: 0.16, 8: 0.08, 4: 0.04, 2: 0.02}, 4), ({16: 0.16, 8: 0.01, 4: 0.06, 2: 0.02, 1: 0.01}, 2), ({}, 1)],
)
def test_the_longest_step_keeps_the_error_at_half_of_it_too(errors, every):
    def measured(settings, multiple, steps):
        return (errors[multiple], errors[multiple] / 2) if errors else None

    found = goals.Trials({"time.gg": 0.9}, 0.25, 66, measured).longest_step(16, 0.05)
    assert found.settings == {"time.gg": 0.9, "time.step": 0.25 * every} and found.steps == 66 // every
    assert found.error == errors.get(every, math.inf)


def test_a_long_run_is_timed_by_two_short_ones(monkeypatch):
    clock = [7.0]
    asked = []

    def run(scene, solver):
        asked.append(scene.time.steps)
        clock[0] += 0.3 + 0.01 * scene.time.steps

    monkeypatch.setattr(goals, "solve", run)
    monkeypatch.setattr(goals, "time", SimpleNamespace(perf_counter=lambda: clock[0]))
    for steps, timed in ((240, [240]), (241, [60, 240]), (977, [60, 240])):
        assert goals.estimated_seconds(PAPER, "dda", steps) == pytest.approx(0.3 + 0.01 * steps)
        assert asked == timed
        asked.clear()
    assert goals.estimated_seconds(PAPER, "layers", 5) is None


def test_a_column_is_cut_for_its_wave_and_judged_by_its_exact_motion():
    scene = load_scene("waves-base").expand()[0]
    _, offer = cut_column(scene, 0.2)
    case = with_settings(scene, offer, **{"time.steps": offer.steps, "run.columns": ["displacement"]})
    a, b = (solve(case, name).displacement for name in ("dda", "layers"))
    assert np.linalg.norm(a - b) / np.linalg.norm(b) == pytest.approx(offer.displacement_error, rel=1e-9)
    assert offer.is_reached and "50 Hz" in offer.condition
    with pytest.raises(InputError):
        cut_column(scene.with_values({"time.gg": 0.5}), 0.01, 50.0)
