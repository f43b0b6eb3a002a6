"""`dda-validate contact`: one page that agrees with the runs behind it; what it does not take is answered helpfully."""

import json

import pytest
from conftest import typed
from oracles.made_cases import made_row

from validation import load_scene
from validation.advice import contact_page
from validation.engine import measure
from validation.engine.case import Case
from validation.engine.measure import execute
from validation.runs.run import Outcome

SHORT = ("--set", "time.step=0.001", "--set", "time.steps=8", "--set", "contact.stiffness=1e11")


def test_an_impact_law_has_a_page_without_springs_to_choose():
    stop = ("contact.stiffness=inf", "contact.shear_stiffness=0", 'contact.rule="impact"', "contact.restitution=0.5")
    sets = [word for value in (*stop, "time.step=0.001", "time.steps=4") for word in ("--set", value)]
    done = typed("advise", "contact", "unlocked-average", *sets, "--json")
    assert done.returncode == 0, done.stderr
    page = json.loads(done.stdout)
    assert page["needed"] is None
    assert {"dda", "block-events"} <= set(page["runs"])


def test_without_a_run_of_dda_the_status_is_that_of_a_failure(monkeypatch):
    ended = made_row("dda", outcome=Outcome.NO_CONTACT_STATE, notes=("at step 3",))
    monkeypatch.setattr(measure, "execute", lambda case, key, study: (ended, None))
    done = typed("advise", "contact", "unlocked-constant", *SHORT)
    assert done.returncode == 3
    assert f"dda: {ended.outcome.sentence} {ended.notes[0]}" in done.stdout


def test_exact_motions_have_no_kinetic_damping_and_a_polygon_has_none():
    scene = load_scene("unlocked-constant").expand()[0]
    for damping in ({"time.gg": 0.9}, {"time.gg_rate": 3.0}):
        run = contact_page.scenes(scene.with_values(damping))
        assert run["dda"].time.discount < 1 == run["block-events"].time.discount == run["bar-events"].time.discount
    turned = scene.with_values({"block.vertices": [[0, 0], [2, 0], [2.2, 2], [0, 2]]})
    row, _ = execute(Case(contact_page.scenes(turned)["block-events"], "block-events"), "", "")
    assert row.outcome is Outcome.NOT_APPLICABLE


@pytest.mark.parametrize(
    ("gap", "velocity", "opening", "closing", "words"),
    [
        (0.0, 0.0, 0.016, 0.003, ("at once", "0.003 s")),
        (0.0, 0.0, "undefined", 0.003, ("at once", "0.003 s")),
        (0.0, 0.0, 0.016, 0.02, ("0.016 s", "0.02 s")),
        (0.0, -1.0, 0.009, "undefined", ("0.009 s", "at once")),
        (0.1, -1.0, 0.2, 0.1, ("0.2 s", "0.1 s")),
        (0.1, 0.0, "undefined", "undefined", ("never", "never")),
    ],
)
def test_when_a_block_first_opens_and_lands(gap, velocity, opening, closing, words):
    scene = load_scene("unlocked-constant").with_values({"contact.gap": gap, "block.velocity": velocity})
    run = {"switches.first_opening": opening, "switches.first_closing": closing}
    assert tuple(contact_page.first(scene, run, opens) for opens in (True, False)) == words
