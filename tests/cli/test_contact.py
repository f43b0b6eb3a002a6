"""`dda-validate contact`: one page that agrees with the runs behind it; what it does not take is answered helpfully."""

from __future__ import annotations

import json

import pytest
from conftest import typed
from oracles.made_cases import made_row

from validation import load_scene
from validation.advice import contact_page
from validation.cli import contact as command
from validation.engine import measure
from validation.engine.case import Case
from validation.engine.measure import execute
from validation.runs.run import Outcome

SHORT = ("--set", "time.step=0.001", "--set", "time.steps=8", "--set", "contact.stiffness=1e11")


@pytest.mark.long
def test_a_smaller_penetration_asks_for_stiffer_springs() -> None:
    scene = load_scene("unlocked-constant").expand()[0].with_values({"time.steps": 400})
    rows = {"block-events": execute(Case(scene, "block-events"), "", "")[0]}
    now, stiffer = (contact_page.answer(scene, rows, depth)["needed"]["stiffness"] for depth in (1e-4, 1e-5))
    assert stiffer == pytest.approx(100 * now, rel=0.05)


def test_an_impact_law_has_a_page_without_springs_to_choose() -> None:
    stop = ("contact.stiffness=inf", "contact.shear_stiffness=0", 'contact.rule="impact"', "contact.restitution=0.5")
    sets = [word for value in (*stop, "time.step=0.001", "time.steps=8") for word in ("--set", value)]
    done = typed("advise", "contact", "unlocked-average", *sets, "--json")
    assert done.returncode == 0, done.stderr
    page = json.loads(done.stdout)
    assert page["needed"] is None
    assert {"dda", "block-events"} <= set(page["runs"])


def test_each_line_of_the_table_has_its_own_metric_in_its_own_unit() -> None:
    run = {
        "horizontal.final": 9e-3, "switches.count": 6.0,
        "contact.open_share": 0.25, "contact.gap": 2e-3, "contact.penetration": 3e-3,
        "contact.peak_force": 4e6, "contact.impulse": 5e6, "contact.landing_speed": 1.5, "contact.restitution": 0.7,
        "contact.restitution_first": 0.8, "contact.restitution_mean": 0.9, "energy.switching_gain": 0.01,
        "energy.rise": 0.02, "contact.slip": 7e-3, "contact.slip_rate": 8e-3, "energy.lost_algorithmic": 1100.0,
        "energy.lost_kinetic_damping": 1200.0, "energy.lost_switching": 1300.0, "energy.lost_friction": 1400.0,
        "contact.mean_solves": 1.25, "contact.most_solves": 3.0, "horizon.time": 0.05,
        "switches.first_opening": 0.016, "switches.first_closing": 0.02,
    }  # fmt: skip
    scene = load_scene("slope-sliding").expand()[0]
    _, *lines = contact_page.table(scene, {"dda": run})
    assert lines == [
        ("first opening", "0.016 s"), ("first landing", "0.02 s"), ("switches", "6"),
        ("share of the time open", "25 %"), ("largest gap", "2 mm"), ("largest penetration", "3 mm"),
        ("peak contact force", "4 MN"), ("impulse of the contact", "5 MN s"), ("fastest landing", "1.5 m/s"),
        ("restitution, centre of mass", "0.7"),
        ("rate of the gap after / before, first contact", "0.8"),
        ("rate of the gap after / before, mean of contacts", "0.9"),
        ("energy gained by switching", "1 %"), ("energy, greatest above the start", "2 %"),
        ("displacement along the base", "9 mm"), ("slip", "7 mm"),
        ("slip per second, at the end", "8 mm/s"), ("energy lost by the scheme", "1.1 kJ"),
        ("energy lost by gg", "1.2 kJ"), ("energy lost by switching", "1.3 kJ"), ("energy lost by friction", "1.4 kJ"),
        ("solves per step, mean and most", "1.25, 3"), ("repeatable to 1e-6 up to", "0.05 s"),
    ]  # fmt: skip


def test_without_a_run_of_dda_the_status_is_that_of_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    ended = made_row("dda", outcome=Outcome.NO_CONTACT_STATE, notes=("at step 3",))
    monkeypatch.setattr(measure, "execute", lambda case, key, study: (ended, None))
    done = typed("advise", "contact", "unlocked-constant", *SHORT)
    assert done.returncode == 3
    assert f"dda: {Outcome.NO_CONTACT_STATE.sentence} at step 3" in done.stdout


def test_the_landing_is_the_exact_block_s_then_dda_s_then_that_of_a_free_fall() -> None:
    scene = load_scene("unlocked-constant").expand()[0].with_values({"contact.gap": 0.2, "load.gravity": 10.0})
    rows = {name: made_row(name, {"contact.landing_speed": speed})
            for name, speed in ((contact_page.own(), 3.0), (contact_page.exact(), 1.5))}  # fmt: skip
    assert contact_page.landing_speed(scene, rows) == 1.5
    assert contact_page.landing_speed(scene, {contact_page.own(): rows[contact_page.own()]}) == 3.0
    assert contact_page.landing_speed(scene, {}) == pytest.approx(2.0)  # sqrt(2 g h)


def test_exact_motions_have_no_kinetic_damping_and_a_polygon_has_none() -> None:
    scene = load_scene("unlocked-constant").expand()[0]
    for damping in ({"time.gg": 0.9}, {"time.gg_rate": 3.0}):
        run = contact_page.scenes(scene.with_values(damping))
        assert run["dda"].time.discount < 1 == run["block-events"].time.discount == run["bar-events"].time.discount
    turned = scene.with_values({"block.vertices": [[0, 0], [2, 0], [2.2, 2], [0, 2]]})
    row, _ = execute(Case(contact_page.scenes(turned)["block-events"], "block-events"), "", "")
    assert row.outcome == "not applicable"


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
def test_when_a_block_first_opens_and_lands(
    gap: float, velocity: float, opening: object, closing: object, words: tuple[str, str]
) -> None:
    scene = load_scene("unlocked-constant").with_values({"contact.gap": gap, "block.velocity": velocity})
    run = {"switches.first_opening": opening, "switches.first_closing": closing}
    assert tuple(contact_page.first(scene, run, opens) for opens in (True, False)) == words  # type: ignore[arg-type]


@pytest.mark.long
def test_a_slope_says_where_the_exact_block_hops_and_advises_no_landing_unasked() -> None:
    slope = ("field-sliding", "--set", "load.slope=30", "--set", "contact.friction=20", "--set", "time.steps=74")
    hops = typed("advise", "contact", *slope, "--set", "contact.gap=0.5").stdout
    assert "hops        the exact block is open for 98.7 % of the time and moves 0.7038 m" in hops
    assert "by 0.49635 m" in hops and "penetration below" not in hops
    stays = typed("advise", "contact", *slope, "--penetration", "1e-3").stdout
    assert "hops  " not in stays and "A gap may open faster than it closed without any gain of energy" in stays
    assert "Asked for: a penetration below 0.001 m" in stays


def test_every_run_is_announced_before_it_starts() -> None:
    scene = load_scene("unlocked-constant").with_values({"time.step": 0.001, "time.steps": 8})
    scenes = contact_page.scenes(scene)
    calls: list[tuple[int, int, str]] = []
    command._rows(scenes, lambda *call: calls.append(call))
    assert [(done, label.split(", ")) for done, _, label in calls] == [
        (done, [f"at most; {name}", "8 steps"]) for done, name in enumerate(scenes)
    ]
