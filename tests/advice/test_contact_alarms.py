"""Alarms and advice of contact that opens: raised where they should be, silent where not, and true of runs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from oracles.made_cases import made_row

from validation import load_scene
from validation.advice import contact
from validation.advice import contact_alarms as kinds
from validation.advice.alarms import Alarm, alarms
from validation.engine.case import Case
from validation.engine.measure import execute
from validation.engine.run import finish
from validation.engine.study import Study
from validation.runs.results import Results
from validation.scenes.scene import Scene, parse_scene
from validation.solvers.rigid.impacts import impact_restitution

PAPER = load_scene("unlocked-constant").expand()[0].with_values({"time.step": 1e-3, "time.steps": 50})
STIFF = {"contact.stiffness": 1e11}
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5}


def raised(scene: Scene, directory: Path, *solvers: str) -> dict[str, Alarm]:
    study = Study("test", "", "", [scene], solvers or ("dda",))
    found = list(alarms([scene], finish(study.cases(), study, Results(directory))))
    return {alarm.kind: alarm for alarm in found if alarm.kind in kinds.KINDS}


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"time.step": 1e-5, "time.steps": 400}, set()),
        ({}, {kinds.LARGE_STEP}),
        ({"time.step": 2e-3}, {kinds.HIDDEN}),
        ({"time.gg": 0.98}, {kinds.LARGE_STEP, kinds.DRAG}),
        ({"time.gg": 0.98, "time.step": 2e-3}, {kinds.HIDDEN}),
        (STIFF | AVERAGE, {kinds.LARGE_STEP, kinds.MAY_GAIN, kinds.GAINED, kinds.PENALTY}),
        (STIFF | {"time.step": 2e-5, "time.steps": 250}, {kinds.PENALTY}),
        ({"time.step": 1e-5, "time.steps": 400, "contact.band": [0.0, 1e-4]}, {kinds.PULLING}),
        ({"time.step": 1e-5, "time.steps": 400, "contact.band": [0.0, 1e-6]}, set()),
        ({"time.step": 1e-5, "time.steps": 400, "contact.band": [1e-3, 0.0]}, {kinds.GAINED}),  # p (1 mm)^2 a landing
        ({"contact.law": "locked"}, set()),
        ({"load.pressure": -1e6}, set()),  # flies off and never lands
        ({"contact.gap": 2.0}, set()),  # has not landed yet
        (STIFF | AVERAGE | {"contact.rule": "implicit"}, {kinds.LARGE_STEP}),
        (STIFF | AVERAGE | {"contact.rule": "energy-conserving"}, set()),
    ],
)
def test_each_alarm_is_raised_where_it_should_be(values: dict[str, Any], expected: set[str], tmp_path: Path) -> None:
    solvers = ("dda", "bar-events") if kinds.PENALTY in expected else ("dda",)
    assert set(raised(PAPER.with_values(values), tmp_path, *solvers)) == expected


def test_a_peak_not_far_above_that_of_the_bar_is_no_alarm(tmp_path: Path) -> None:
    scene = PAPER.with_values({"contact.stiffness": 2.2e9, "time.step": 2e-5, "time.steps": 400})
    assert not raised(scene, tmp_path, "dda", "bar-events")  # 1.4 times and less, of springs stiffer than the bar


def test_the_numbers_of_the_alarms(tmp_path: Path) -> None:
    large = raised(PAPER.with_values(STIFF), tmp_path)[kinds.LARGE_STEP]
    assert large.values["omega"] == pytest.approx(math.sqrt(8e11 / 10800) * 1e-3)  # 8.6
    assert "arbitrary, from 0" in large.sentence
    assert large.values["mean"] == pytest.approx(0.5, abs=0.05)
    soft = raised(PAPER, tmp_path)[kinds.LARGE_STEP]
    assert "arbitrary" not in soft.sentence and soft.values["omega"] == pytest.approx(0.8607, abs=1e-4)
    pulls = raised(PAPER.with_values({"contact.band": [0.0, 1e-3]}), tmp_path)[kinds.PULLING]
    assert pulls.values["pull"] == pytest.approx(2e6)  # 2 p f0, a fifth of the load


HARD = STIFF | {"time.step": 1e-5}
LANDED = {"contact.gap": 1e-3, "switches.first_closing": 5e-3}


@pytest.mark.parametrize(
    ("kind", "values", "metrics", "words"),
    [
        (kinds.GAINED, {}, {"energy.switching_gain": 0.25}, "have added 25 % to the energy"),
        (kinds.DRAG, {"time.gg": 0.98}, {"contact.open_share": 0.4}, "40 % of the time: speeds fall with the time "
         "constant 0.05 s"),
        (kinds.PENALTY, HARD, {"contact.peak_force": 6e7}, "6e+07 N, is 4 times that of the exact bar"),
        (kinds.PULLING, {"contact.band": [0.0, 1e-3]}, {}, "up to 2e+06 N, 20 % of the load"),
        (kinds.HIDDEN, {"time.step": 2e-3}, {}, "dt = 0.002 s is beyond 0.001897 s"),
        (kinds.MAY_GAIN, STIFF | AVERAGE, LANDED, "delta = 0.5 with w_c dt = 8.61"),
        (kinds.LARGE_STEP, STIFF, LANDED, "w_c dt = 8.61, w_c = sqrt(8 p / m): the restitution of a contact is "
         "arbitrary, from 0.014 to 0.95"),
    ],
)  # fmt: skip
def test_a_sentence_tells_the_numbers_of_its_run(
    kind: str, values: dict[str, Any], metrics: dict[str, float], words: str
) -> None:
    rows = {"dda": made_row("dda", metrics), "bar-events": made_row("bar-events", {"contact.peak_force": 1.5e7})}
    told = {alarm.kind: alarm.sentence for alarm in kinds.contact_alarms(PAPER.with_values(values), rows)}
    assert words in told[kind]


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"load.gravity": 9.81 * 50, "contact.stiffness": 7e9},
        {"time.alpha": 0.3, "time.delta": 0.6, "time.gg": 0.9},
        {"block.young": 3e9, "block.density": 2400.0, "block.side": 1.5},
    ],
)
def test_the_opening_is_hidden_from_the_limit_on(values: dict[str, Any]) -> None:
    scene = PAPER.with_values(values)
    limit = contact.hidden_from(scene)
    assert limit is not None
    for factor, opens in ((0.999, True), (1.001, False)):
        row, _ = execute(Case(scene.with_values({"time.step": factor * limit, "time.steps": 1}), "dda"), "", "")
        assert (row.metrics["contact.gap"] > 0) == opens  # type: ignore[operator]


def test_the_opening_is_hidden_at_the_known_limits() -> None:
    assert contact.hidden_from(PAPER) == pytest.approx(1.8973665961e-3, rel=1e-10)
    assert contact.hidden_from(PAPER.with_values(AVERAGE)) == pytest.approx(2.6832815730e-3, rel=1e-10)
    for none in ({"contact.gap": 0.1}, {"block.velocity": -1.0}, {"load.gravity": 2000.0}, {"load.pressure": -1.0}):
        assert contact.hidden_from(PAPER.with_values(none)) is None


def test_the_opening_is_hidden_by_the_height_and_not_the_width() -> None:
    data = PAPER.definition()
    del data["block"]["side"]
    oblong = parse_scene(data | {"block": data["block"] | {"width": 3.0, "height": 1.25}}, "oblong")
    assert contact.hidden_from(oblong) == pytest.approx(1.8973665961e-3 * 1.25 / 2, rel=1e-10)


@pytest.mark.parametrize(
    "scheme", [{}, AVERAGE, AVERAGE | {"contact.rule": "implicit"}, {"time.alpha": 0.3025, "time.delta": 0.6}]
)
@pytest.mark.parametrize("error", [0.01, 0.05])
def test_the_step_that_is_advised_keeps_the_restitution_asked_for(scheme: dict[str, Any], error: float) -> None:
    scene = PAPER.with_values(scheme)
    found = contact.needed(scene, 3.757, error, 1e-4)
    off = max(abs(found.restitution.low - 1), abs(found.restitution.high - 1))
    assert 0.3 * error < off < 1.1 * error
    there = scene.with_values({"contact.stiffness": found.stiffness, "time.step": found.step})
    assert contact.omega(there) == pytest.approx(found.omega)


def test_the_springs_that_are_advised_keep_the_penetration_asked_for() -> None:
    """A block that is dropped penetrates by V sqrt(m / (8 p)) in its first contact."""
    fallen = PAPER.with_values({"load.pressure": 0.0, "block.velocity": -1.0, "time.step": 1e-5, "time.steps": 100})
    found = contact.needed(fallen, 1.0, 0.05, 1e-4)
    assert found.stiffness == pytest.approx(10800 / 8e-8)
    row, _ = execute(Case(fallen.with_values({"contact.stiffness": found.stiffness}), "block-events"), "", "")
    assert row.metrics["contact.penetration"] == pytest.approx(1e-4, rel=0.05)
    assert contact.needed(PAPER, 0.0, 0.05, 1e-4).stiffness == pytest.approx(1e7 / 2e-4)  # the load alone


def test_springs_are_raised_until_the_exact_block_stays_above_the_penetration() -> None:
    tried: list[float] = []

    def probe(p: float) -> float:
        tried.append(p)
        return 3e-4 * (tried[0] / p) ** 0.5  # three times too deep at first

    found = contact.needed(PAPER, 1.0, 0.05, 1e-4, probe)
    assert found.first_guess == tried[0] == pytest.approx(10800 / 8e-8)
    assert found.stiffness == pytest.approx(9 * tried[0]) and found.depth == pytest.approx(1e-4)
    assert contact.omega(PAPER.with_values({"contact.stiffness": found.stiffness, "time.step": found.step})) == (
        pytest.approx(found.omega)
    )
    never = contact.needed(PAPER, 1.0, 0.05, 1e-4, lambda p: 2e-4)
    assert never.depth == 2e-4 and never.stiffness > 1e4 * never.first_guess
    assert contact.needed(PAPER, 1.0, 0.05, 1e-4, lambda p: None).depth is None


def test_the_stated_examples() -> None:
    """At p = 100E and 5 %: 7.4 us at (1/2, 1) and 73 us at (1/4, 1/2)."""
    stiff = PAPER.with_values(STIFF)
    assert contact.needed(stiff, 1.0, 0.05, 1e-4).step_now == pytest.approx(7.4e-6, abs=5e-8)
    assert contact.needed(stiff.with_values(AVERAGE), 1.0, 0.05, 1e-4).step_now == pytest.approx(73e-6, abs=6e-7)


def test_forces_of_an_impact() -> None:
    scene = PAPER.with_values(STIFF | {"load.pressure": 0.0, "block.velocity": -2.0, "time.step": 1e-6})
    row, _ = execute(Case(scene.with_values({"time.steps": 400}), "block-events"), "", "")
    assert row.metrics["contact.peak_force"] == pytest.approx(contact.impact_force(scene, -2.0), rel=0.02)
    assert contact.wave_force(scene, -2.0) == pytest.approx(2700 * 608.5806194501846 * 2 * 2)
    assert scene.block.mass == 10800


def test_the_restitution_of_a_phase_lies_in_the_range_of_the_map() -> None:
    found = contact.restitution(PAPER, math.inf)
    assert found is not None and (found.low, found.high) == pytest.approx((0.0, 1.0), abs=1e-12)
    assert impact_restitution(0.5, 1.0, 1.0, math.inf, 0.25) == pytest.approx(0.5)
    constant = contact.restitution(PAPER, 10.0)
    rules = {rule: PAPER.with_values(AVERAGE | {"contact.rule": rule}) for rule in ("implicit", "energy-conserving")}
    assert contact.restitution(rules["implicit"], 10.0) == constant
    assert contact.restitution(rules["energy-conserving"], 10.0) == contact.Restitution(1.0, 1.0, 1.0, 1.0)
    assert contact.restitution(PAPER.with_values({"time.alpha": 0.1, "time.delta": 0.9}), 1.0) is None
