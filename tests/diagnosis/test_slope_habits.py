"""The habits of other programs on a slope, with a formula in the place of the runs."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.kept_answers import said
from oracles.stand_ins import assert_kept, summed

from validation import load_scene
from validation.diagnosis import slopes
from validation.diagnosis.beside import RunVerdict
from validation.diagnosis.evidence import Departure
from validation.diagnosis.numbers import fixed
from validation.diagnosis.one_change import Fitted
from validation.diagnosis.reading import Foreign, Stepping
from validation.diagnosis.readings import Reading
from validation.diagnosis.slopes import Habits, SlopeSearch, answer_on, habits_of, verdict_on

KEPT = Path(__file__).with_name("numbers.toml")
STEPS = 40
SCENE = load_scene(Path(__file__).parents[2] / "docs" / "examples" / "ntdda" / "slope.toml")
SCENE = SCENE.with_values({"time.steps": STEPS})
STEP = SCENE.time.step
AREA = 4.0
MASS = SCENE.block.density * AREA
OPENS = 9  # row after which a corner is open, as long as it is not deeper than its dead band
DEEPER = 1e-4  # m a row


def motion(values, steps):
    """Return columns of a block that swings on its springs and slides, whose corner lands by its dead band."""

    def of(key):
        section, _, entry = key.partition(".")
        return values.get(key, getattr(getattr(SCENE, section), entry, None))

    n = np.arange(1, steps + 1)
    time = of("time.step") * n
    slope = math.radians(of("load.slope"))
    weight = MASS * of("load.gravity")
    across = weight * math.cos(slope)
    along = weight * math.sin(slope)
    springs = across / (2 * of("contact.stiffness"))
    decay = 12.0 * of("time.delta") / of("time.gg") ** 40
    swing = 1 - np.exp(-decay * time) * np.cos(time * math.sqrt(2 * of("contact.stiffness") / MASS))
    down = springs * swing + across / (4 * of("block.young")) * (1 - np.exp(-60.0 * time))
    limit = across * math.tan(math.radians(of("contact.friction") or 0.0))
    stretch = along / (2 * of("contact.shear_stiffness"))
    slip = max(along - 0.8 * limit, 0.0) / MASS * time**2 / 2 - 2 * (of("contact.cohesion") or 0.0) / MASS * time**3
    if of("contact.rules") == "lagged":
        slip = slip + 2e-6 * limit / (MASS * 9.81) * np.maximum(n - 5, 0)
    depth = DEEPER * (n - OPENS - 3)  # of the corner that opens, below the base
    is_open = (n > OPENS) & (depth <= of("contact.band")[0])
    landed = 1 + 0.05 * ((n > OPENS) & ~is_open)
    place = {"displacement": -down * landed, "horizontal_displacement": stretch * swing + slip}
    place |= {"state_m": np.where(is_open, 0.0, 1.0), "gap_m": np.where(is_open, -depth, -down)}
    place |= {"state_n": np.ones(steps), "gap_n": -down - depth}
    return place


class Formula(SlopeSearch):
    """Runs by the formula, of a program with `theirs`."""

    apart = 0.0

    def columns(self, values, steps, *names):
        if values.get("fails"):
            return None
        place = motion({"time.gg": 1.0} | values, steps)
        return np.array([place[name] for name in names])

    def solved(self, values, steps, is_shifted):
        columns = self.columns(values, steps, *self.NAMES)
        return columns if columns is None or not is_shifted else columns * (1 + 1e-13)


def made(values, steps=STEPS):
    place = motion({"time.gg": 1.0} | values, steps)
    return np.array([place[name] for name in SlopeSearch.NAMES])


def beside(recorded):
    steps = recorded.shape[1]
    return Formula(SCENE, Reading(Stepping(np.full(steps, STEP), np.arange(steps)), recorded, np.zeros(recorded.shape)))


@pytest.fixture(autouse=True)
def few_starts(monkeypatch):
    monkeypatch.setattr(slopes, "SOFTNESSES", (0.0, -0.5))
    monkeypatch.setattr(slopes, "STAGES", (8, 16, 30, 40))
    monkeypatch.setattr(slopes, "BANDS", (0.1, 10.0, 8))


COMPLIANCE = math.expm1(0.003) * 2 / 3  # the springs give way twice as much as the block
THEIRS = [
    (Habits("lagged"), {"lagged-friction": None}),
    (Habits("consistent", weight=1.0, softness=0.003), {"base-compliance": COMPLIANCE, "own-weight": 1.0}),
    (
        Habits("lagged", weight=1.0, softness=0.003, along=False),
        {"lagged-friction": None, "base-compliance": COMPLIANCE, "own-weight": 1.0},
    ),
    (Habits("lagged", softness=-math.log(1.5), along=False), {"normal-springs-factor": 1.5, "lagged-friction": None}),
    (Habits("lagged", 1.23e-3, weight=1.0), {"lagged-friction": None, "dead-band": 1.2e-3, "own-weight": 1.0}),
]


def test_habits_are_found_by_the_rows_that_they_give():
    for theirs, causes in THEIRS:
        search = beside(made(theirs.values(SCENE)))
        ranked = habits_of(search)
        assert len(ranked) == 1 + (theirs.rules == "lagged")
        habits, run = ranked[-1]
        assert run.explains and run.left < 1e-6
        assert (habits.rules, habits.along or not theirs.softness) == (theirs.rules, theirs.along)
        assert habits.weight == pytest.approx(theirs.weight, abs=1e-6)
        assert habits.softness == pytest.approx(theirs.softness, abs=1e-7) and habits.error < 1e-6
        assert habits.causes(search) == {
            name: value if value is None else pytest.approx(value, rel=2e-3) for name, value in causes.items()
        }


def told(recorded):
    search = beside(recorded)
    return answer_on(search, Foreign(search.time, recorded[0], sideways=recorded[1]))


def test_an_answer_names_the_law_with_what_each_leaves_and_when_both_corners_are_open(monkeypatch):
    theirs = Habits("lagged", weight=1.0, softness=0.003)
    answer = told(made(theirs.values(SCENE)))
    assert answer.causes == ["lagged-friction", "base-compliance", "own-weight"]
    assert answer.values == {"own-weight": 1.0, "base-compliance": pytest.approx(COMPLIANCE, rel=1e-5)}
    assert [one["causes"] for one in answer.alike] == [["springs-factor"]]
    assert answer.alike[0]["values"]["springs-factor"] == pytest.approx(math.exp(-0.003), rel=1e-5)
    stage = answer.evidence[-1]
    assert (stage.name, stage.agrees) == ("friction", False)
    assert stage.numbers["lagged"] < 1e-6 < 1e-4 < stage.numbers["consistent"]
    assert answer.departure == Departure(6, "offset")  # the first row that lags, on what surrounds the block
    assert answer.opened is None
    corrected = beside(made(theirs.values(SCENE)))
    corrected.reading = replace(corrected.reading, corrected=("sign",))
    assert corrected.departure(RunVerdict(corrected, True)) == Departure(1, "offset")
    assert told(made({})).causes == []
    corners = np.ones((2, STEPS))
    corners[:, 7:10] = corners[0, 3] = 0.0
    monkeypatch.setattr(Formula, "corners", lambda search, values: (-corners, corners))
    assert told(made(theirs.values(SCENE))).opened == (8, 10)
    assert told(made({"time.delta": 1.1, "load.gravity": 99.0})).opened is None  # which nothing explains


def test_a_number_that_is_wrong_is_named_where_no_habit_explains_the_rows():
    for values, cause, number in (
        ({"contact.friction": 22.3}, "friction-factor", math.tan(math.radians(22.3)) / math.tan(math.radians(22))),
        ({"contact.cohesion": 3e4}, "cohesion", 3e4),
        ({"contact.shear_stiffness": 4.4e8}, "shear-springs-factor", 1.1),
    ):
        answer = told(made(values))
        assert answer.causes == [cause]
        assert answer.values == {cause: pytest.approx(number, rel=1e-5)}
        assert answer.evidence[-1].agrees is False
        assert answer.departure.step == 1


def test_what_a_base_with_mass_leaves_is_small_beside_another_law(monkeypatch):
    """A wave that no candidate has: up to a hundredth of the motion, and to 2 % of what other habits leave."""
    monkeypatch.setattr(Formula, "explanations", lambda search: [])
    base = made(Habits("consistent", weight=1.0, softness=0.003).values(SCENE))
    wave = np.sin(0.7 * np.arange(STEPS))
    wave = wave / np.linalg.norm(wave) * np.linalg.norm(base, axis=1, keepdims=True)
    for size, others_left, causes in (
        (0.5e-3, math.inf, ["base-compliance", "own-weight"]),
        (0.5e-3, 0.03, ["base-compliance", "own-weight"]),
        (0.5e-3, 0.01, ["unexplained"]),
        (1.2e-2, math.inf, ["unexplained"]),
    ):
        recorded = base + size * wave
        search = beside(recorded)
        ranked = [(Habits("consistent", weight=1.0, softness=0.003), of_base(search))]
        ranked += [(Habits("lagged"), replace(ranked[0][1], left=others_left))]
        verdict = verdict_on(search, ranked)
        assert verdict.explained is (causes != ["unexplained"])
        stage = slopes._friction_stage(verdict, ranked)
        assert stage.numbers == {
            "consistent": ranked[0][1].left,
            "lagged": None if others_left == math.inf else others_left,
        }
        assert stage.agrees is (True if verdict.explained else None)


def of_base(search):
    habits = Habits("consistent", weight=1.0, softness=0.003)
    return search.judged(Fitted(fixed("habits", "", habits.values(SCENE)), 0.0, math.nan))


def test_habits_are_values_of_the_scene_and_have_their_causes():
    """A base is no number of springs, and half a weight is none."""
    search = beside(made({}))
    found = []
    for softness in (0.0, 7e-4, 8e-4, -8e-4, 0.0722, 0.074, -math.log(0.98), math.log(2)):
        for more in ({}, {"error": 2e-3}, {"along": False, "rules": "lagged"}, {"band": 2e-3, "weight": 0.7}):
            habits = replace(Habits("consistent", softness=softness), **more)
            found.append([habits.values(SCENE), habits.compliance(SCENE), habits.causes(search)])
    weights = (0.0, 0.94, 0.96, 1.04, 1.06, 0.03, -50.0)
    found += [[Habits("", weight=weight).is_usual, Habits("", weight=weight).values(SCENE)] for weight in weights]
    assert_kept(KEPT, "habits", {"habits": summed(said(found, 1e-9))})


def test_signs_and_a_unit_of_both_columns_are_read_off_the_first_rows(monkeypatch):
    monkeypatch.setattr(slopes, "SlopeSearch", Formula)
    time = STEP * np.arange(1, STEPS + 1)
    found = []
    for signs, factor in (
        ((1, 1), 1.0),
        ((-1, 1), 1.0),
        ((1, -1), 1e3),
        ((1, 1), 3.1),
        ((1, 1), 10**2.6),
        ((1, 1), 0.0),
    ):
        place = made({}) * factor * np.array(signs)[:, None]
        reading = slopes.search_of(SCENE, Foreign(time, place[0], sideways=place[1])).reading
        found.append([(slip.cause, slip.column, slip.factor) for slip in reading.corrected])
        found.append(reading.recorded)
    assert found[4] == [
        ("unit", "displacement", 1e3),
        ("sign", "horizontal_displacement", -1.0),
        ("unit", "horizontal_displacement", 1e3),
    ]
    assert_kept(KEPT, "slope_readings", {"readings": summed(said(found, 1e-9))})


def test_runs_of_the_suite_shifted_by_rounding_and_refused_where_they_do_not_run(monkeypatch):
    asked = []
    monkeypatch.setattr(SlopeSearch, "columns", lambda search, values, steps, *names: asked.append(values) or made({}))
    search = SlopeSearch(SCENE, beside(made({})).reading)
    search.solved({"contact.stiffness": 2e9}, STEPS, True)
    shifted = {"contact.stiffness": 2e9, "contact.shear_stiffness": 4e8, "contact.friction": 22.0}
    assert {key: value / shifted[key] - 1 for key, value in asked[-1].items()} == pytest.approx(
        dict.fromkeys(shifted, 1e-12), rel=1e-3
    )
    monkeypatch.undo()
    assert search.columns({"time.step": -1.0}, 4, "displacement") is None
    run = search.columns({}, 4, "displacement", "state_n")
    assert run.shape == (2, 4) and run[1].tolist() == [1.0] * 4
    assert search.corners({"time.step": -1.0}) is None and len(search.corners({})[0]) == 2
    assert beside(made({})).remainder({"fails": True}, 3).tolist() == [[1.0] * 3] * 2
    one = beside(1.5 * made({})).remainder({}, 9)
    sizes = np.max(np.abs(made({})[:, :9]), axis=1, keepdims=True)
    assert one == pytest.approx(-0.5 * made({})[:, :9] / (1.5 * sizes))
