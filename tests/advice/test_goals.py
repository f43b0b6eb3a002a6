"""What `advise` recommends, against closed forms, an elastic bar by its transform and runs made apart."""

import re
import shlex

import numpy as np
import pytest
from conftest import typed

from validation import load_scene, solve
from validation.advice import goals
from validation.advice.goals import Question, recommend
from validation.advice.overview import overview
from validation.errors import InputError
from validation.models.column.pages import recommended_cut as cut_column
from validation.scenes.scene import parse_assignment
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


def granite():
    return PAPER.with_values(GRANITE)


def with_settings(scene, offer, **values):
    return scene.with_values(offer.settings | values)


def test_a_static_block_is_as_far_from_elements_as_it_says_and_at_rest_after_its_steps():
    (offer,) = recommend(granite(), "static", Question())
    case = with_settings(granite(), offer, **{"time.steps": offer.steps + 20})
    elements = get_solver("fem").static(case.with_values({"fem.elements": 12}))["displacement"]
    rest = solve(case, "dda").displacement[offer.steps - 1 :]
    assert np.all(np.abs(rest / get_solver("dda").static(case)["displacement"] - 1) <= goals.RESTED)
    assert abs(rest[-1] / elements - 1) == pytest.approx(offer.displacement_error, abs=0.012)
    assert offer.is_reached and offer.settings["block.subdivide"] == [2, 2]  # of one strain a third is missing
    modulus, width, height = 5e10, 1.2, 1.2
    assert offer.settings["contact.stiffness"] == pytest.approx(modulus * width / (height * 0.05))


@pytest.mark.parametrize("keep_springs", [pytest.param(False, marks=pytest.mark.long), True])
def test_an_impact_keeps_the_rebound_of_the_theory_wherever_it_lands(keep_springs):
    plain, conserving = recommend(PAPER, "impact", Question(keep_springs=keep_springs))
    assert (plain.settings["contact.stiffness"] == PAPER.contact.stiffness) is keep_springs
    assert conserving.settings["contact.rule"] == "energy-conserving"
    assert plain.is_reached and conserving.is_reached and conserving.steps < plain.steps
    landing_scene = with_settings(PAPER, plain, **{"contact.law": "unilateral", "block.velocity": -3.0})
    own = landing.own_landing(landing.stiffness_ratio(landing_scene)).restitution
    free = landing_scene.with_values({"load.pressure": 0.0, "load.gravity": 0.0, "time.start": "zero"})
    for phase in (0.1, 0.6):  # others than those that were run
        gap = 3.0 * phase * plain.settings["time.step"]
        motion = solve(free.with_values({"contact.gap": gap, "time.steps": plain.steps}), "dda").displacement
        rebound = (motion[-1] - motion[-2]) / (3.0 * plain.settings["time.step"])
        assert abs(rebound - own) <= 0.05
        if phase < 0.5:
            exact = solve(
                free.with_values({"contact.gap": gap, "time.steps": plain.steps}), "block-events"
            ).displacement
            off = np.linalg.norm(motion - exact) / np.linalg.norm(exact)
            assert off == pytest.approx(plain.displacement_error, rel=0.5)


@pytest.mark.long
def test_a_quake_is_followed_in_the_contact_force_too():
    (offer,) = recommend(PAPER, "quake", Question(error=0.02))
    assert offer.is_reached and offer.force_error is not None and offer.force_error <= 0.02
    assert "sideways" in offer.condition


@pytest.mark.parametrize(
    ("scene", "goal"),
    [(PAPER.with_values({"load.pressure": 0.0}), "static"), (load_scene("quadrilateral"), "impact")],
)
def test_a_goal_that_does_not_apply_says_why_and_the_others_are_answered(scene, goal):
    with pytest.raises(InputError) as error:
        recommend(scene, goal, Question())
    others = ("wave",) if goal == "static" else ()
    answer = overview(scene, Question(goals=(goal, *others)))
    assert answer.refused == {goal: error.value.rule}
    assert tuple(offer.goal for offer in answer.recommendations) == others


@pytest.mark.long
def test_every_command_that_is_named_runs():
    words = ("slope-drag", "--set", "time.gg=0.98", "--set", "time.step=0.01", "--set", "time.steps=20")
    page = typed("advise", *words, "--goal", "static").stdout
    commands = re.findall(r"(?:more on .*|next): dda-validate (.*)$", page, re.M)
    assert len(commands) == 4
    for command in commands[:-1]:
        assert typed(*shlex.split(command)).returncode == 0, command
    settings = dict(map(parse_assignment, re.findall(r"--set (\S+)", commands[-1])))
    assert load_scene(words[0]).with_values(settings).time.gg == 1.0


# ---- columns and beams ----------------------------------------------------------------------------------------------


def test_a_column_is_cut_for_its_wave_and_judged_by_its_exact_motion():
    scene = load_scene("waves-base").expand()[0]
    _, offer = cut_column(scene, 0.05)
    case = with_settings(scene, offer, **{"time.steps": offer.steps, "run.columns": ["displacement"]})
    a, b = (solve(case, name).displacement for name in ("dda", "layers"))
    assert np.linalg.norm(a - b) / np.linalg.norm(b) == pytest.approx(offer.displacement_error, rel=1e-9)
    assert offer.is_reached and "50 Hz" in offer.condition
    with pytest.raises(InputError):
        cut_column(scene.with_values({"time.gg": 0.5}), 0.01, 50.0)
