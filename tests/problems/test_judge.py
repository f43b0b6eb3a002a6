"""Judging answers to problems: wrong histories fail, both sides of a band, what is absent is told."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.kept_answers import said
from oracles.stand_ins import assert_kept, summed

from validation.errors import InputError
from validation.gates.gate import Status
from validation.models.plane import problems as boxes
from validation.problems.bands import LARGEST, Standard, band, changes, standard
from validation.problems.judge import judge
from validation.problems.problem import problem, problem_of
from validation.runs.history import DISPLACEMENT, PRESSURE, History
from validation.scenes.scene import load_scene

KEPT = Path(__file__).with_name("numbers.toml")
SHORTENED = {"sliding": 6, "mass-ratio": 24, "opening": 20}  # steps, of one whose exact motion takes long
ALL = (
    *("locked", "rocking", "column", "mass-ratio"),
    *(pytest.param(name, marks=pytest.mark.long) for name in ("opening", "joint", "sliding", "spall")),
)


def short(name):
    """Return a problem; one whose exact motion takes long, over its first steps."""
    steps = SHORTENED.get(name)
    return (
        problem(name) if steps is None else problem_of(load_scene(f"field-{name}").with_values({"time.steps": steps}))
    )


def history(asked, change):
    """Return the exact motion with its columns changed."""
    exact = standard(asked).exact
    return History(exact.time, {name: change(exact.time, x) for name, x in exact.columns.items()})


WRONG = {
    "half a step late": lambda t, x: np.interp(t - (t[1] - t[0]) / 2, np.r_[0.0, t], np.r_[0.0, x]),
    "damped": lambda t, x: x.mean() + (x - x.mean()) * np.exp(-3.0 * t / t[-1]),
    "a fifth too large": lambda t, x: 1.2 * x,
    "not a number": lambda t, x: np.where(t > t[-1] / 2, np.nan, x),
}


@pytest.mark.parametrize("name", ALL)
def test_a_wrong_history_fails(name):
    asked = short(name)
    for wrong, change in WRONG.items():
        word = judge(asked, history(asked, change)).status
        within = (name, wrong) == ("rocking", "half a step late")  # it falls so slowly that 2.5 ms are below 1 % of a
        assert word is (Status.PASS if within else Status.FAIL), wrong


@pytest.mark.parametrize("name", ["locked", "rocking"])
def test_the_error_is_within_what_is_allowed_up_to_where_it_would_pass_were_it_exact_from_there_on(name):
    asked = short(name)
    held = standard(asked)
    column, band_ = next(iter(held.bands.items()))
    time, late = held.exact.time, held.exact.time > held.exact.time[-1] / 3

    def seen(wrong, as_seen):
        wanted = held.exact.columns[column]
        return judge(asked, History(time, {column: np.where(wrong, as_seen(wanted), wanted)}))

    found = seen(late, lambda wanted: 1.3 * wanted)
    assert time[-1] / 3 < found.within < band_.until
    for ends, word in ((time <= found.within, Status.PASS), (np.r_[True, time[:-1] <= found.within], Status.FAIL)):
        judged = {one.name: one.status for one in seen(late & ends, lambda wanted: 1.3 * wanted).criteria}
        assert judged[column] is word
    assert judge(asked, held.exact).within == pytest.approx(min(b.until for b in held.bands.values()))
    assert seen(True, lambda wanted: 9 + wanted).within == 0.0
    assert seen(time >= time[5], lambda wanted: np.nan * wanted).within == time[4]


@pytest.mark.parametrize("name", ALL)
def test_the_exact_motion_passes_and_so_does_what_one_per_cent_of_a_datum_changes(name):
    asked = short(name)
    held = standard(asked)
    assert judge(asked, held.exact).verdict == "PASS"
    for datum, changed in held.changed.items():
        rows = min(len(changed.time), len(held.exact.time))
        if rows == len(held.exact.time):
            assert judge(asked, changed).status is Status.PASS, datum


@pytest.mark.parametrize("name", ALL)
def test_both_sides_of_the_band(name):
    asked = short(name)
    held = standard(asked)
    for column, edge in held.bands.items():
        for times, word in ((1 - 1e-6, Status.PASS), (1 + 1e-6, Status.FAIL)):
            x = held.exact.columns[column] * (1 + times * edge.high)
            found = judge(asked, History(held.exact.time, dict(held.exact.columns) | {column: x}))
            assert (found.status, found.deciding.name) == (word, column)
            assert edge.datum in found.deciding.reason


def test_a_column_that_is_absent_is_told():
    asked = short("locked")
    exact = standard(asked).exact
    for columns, status, withheld in (
        (exact.columns, Status.PASS, ()),
        ({DISPLACEMENT: exact.displacement}, Status.PARTIAL, (PRESSURE,)),
        ({DISPLACEMENT: 2 * exact.displacement}, Status.FAIL, (PRESSURE,)),
    ):
        found = judge(asked, History(exact.time, columns))
        assert (found.status, found.withheld) == (status, withheld)
        assert (PRESSURE in found.verdict) is bool(withheld)
    assert judge(asked, History(exact.time, {})).status is Status.NOT_JUDGED
    still = History(exact.time, {DISPLACEMENT: exact.displacement, PRESSURE: 0 * exact.time})
    reasons = [one.reason for one in judge(asked, exact, Standard(still, {}, {})).criteria]
    reasons += [one.reason for one in judge(asked, exact, Standard(History(exact.time, {}), {}, {})).criteria]
    assert len({*reasons}) == 3 and reasons[2] == reasons[3]


def test_a_band_ends_where_the_data_do_not_determine_the_motion_any_more():
    t = 0.01 * np.arange(1.0, 401)
    found = band(t, np.sin(30 * t), {"density": np.sin(30.3 * t)})
    assert found.high <= LARGEST and 10 < found.rows < 400
    bands = [band(t, 0.0 * t, {"density": 0.0 * t}), band(t, t, {})]
    for count, most in ((400, 1.01), (400, 1.19), (400, 1.21), (400, 1 + 9e-7), (400, 1 + 2e-6), (3, 1.01), (4, 1.01)):
        wave = np.sin(9 * t[:count])
        growing = wave * np.linspace(1.0, most, count)
        for other in ({"density": growing}, {"density": growing, "springs": 1.001 * wave[: max(count - 2, 2)]}):
            bands.append(band(t[:count], wave, other))
    assert_kept(KEPT, "bands", {"bands": summed(said(bands, 1e-9))})


@pytest.mark.parametrize(
    ("values", "pull"),
    [
        ({"contact.gap": 1.0, "run.columns": ["displacement"]}, -9.81),
        (
            {"contact.friction": 0.0, "load.slope": -30.0, "run.columns": ["horizontal_displacement"]},
            -9.81 * math.sin(math.radians(30.0)),
        ),
    ],
)
def test_a_motion_that_no_datum_changes_is_judged_to_one_per_cent(values, pull):
    """Free fall, and sliding without friction: g t^2 / 2 to seven digits passes, one half a step late does not."""
    weight = {"time.steps": 12, "load.pressure": 0.0, "load.gravity": 9.81}
    asked = problem_of(load_scene("field-opening").with_values(weight | values))
    (name,), held = asked.scene.run.columns, standard(asked)
    assert held.bands[name].high == 0.01
    t = held.exact.time
    for late, word in ((1e-7, Status.PASS), (0.5 * t[0], Status.FAIL)):
        assert judge(asked, History(t, {name: pull * (t - late) ** 2 / 2})).status is word


@pytest.mark.parametrize(
    ("name", "values", "stiffness", "strength"),
    [
        ("field-joint", {}, [1.01e9], [1.01e5]),
        (
            "field-mass-ratio",
            {"column.base": "springs", "column.base_stiffness": 4e9},
            [4.04e9, 1.01e9],
            [math.inf] * 2,
        ),
        (
            "field-joint",
            {
                "column.gravity": 10.0,
                "column.joint": [
                    {"height": 40.0, "stiffness": "inf", "friction": 45.0},
                    {"height": 80.0, "stiffness": 1e8},
                ],
            },
            [math.inf, 1.01e8],
            [1.01 * 160 * 2000 * 10, math.inf],
        ),
    ],
)
def test_one_per_cent_of_contacts_is_of_each_of_them(name, values, stiffness, strength):
    scene = load_scene(name).with_values(values)
    data = changes(scene)
    before = scene.column.contacts
    for datum, expected in (("stiffness", stiffness), ("strength", strength)):
        changed = data.get(f"the contacts' {datum}", {})
        after = scene.with_values(changed).column.contacts
        assert bool(changed) is any(map(math.isfinite, expected))
        assert not changed or [getattr(contact, datum) for contact in after] == pytest.approx(expected)
        assert [(one.height, one.gap) for one in after] == [(one.height, one.gap) for one in before]


def test_the_modulus_of_rigid_blocks_is_no_datum():
    assert ["Young's modulus" in changes(problem(name).scene) for name in ("stack", "cradle")] == [False, True]


def test_boxes_are_judged_by_their_numbers():
    for one in map(problem, boxes.box_problems()):
        reference = standard(one)
        assert reference.bands == {} and set(reference.exact.columns) == set(one.scene.run.columns)
        judgement = judge(one, reference.exact)
        assert judgement.verdict == "PASS", one.name
        assert judgement.criteria and len(judgement.criteria) == len(judgement.quantities)
        assert all(number.allowed is not None and number.allowed <= 0.026 for number in judgement.criteria)


def test_a_number_that_the_positions_hold_and_do_not_give_fails_by_infinitely_much():
    one = problem("standing")
    exact = standard(one).exact
    never = replace(one.numbers[0], measure=lambda history: None)
    judgement = judge(replace(one, numbers=(never, *one.numbers[1:])), exact)
    assert (judgement.status, judgement.deciding.name, judgement.deciding.error) == (Status.FAIL, never.name, math.inf)
    assert judgement.within == 0.0 < judge(one, exact).within


def test_a_number_of_a_withheld_column_is_not_reported():
    one = problem("tumbling")
    exact = standard(one).exact
    fewer = History(exact.time, {name: exact.columns[name] for name in ("box.x", "box.y")})
    judgement = judge(one, fewer)
    assert judgement.status is Status.PARTIAL
    assert any("energy" in name for name in judgement.withheld)
    assert not any("speed" in name for name in judgement.withheld)


@pytest.mark.parametrize(
    ("name", "values", "field"),
    [
        ("restitution", {"plane.gravity": [0.0, -9.81]}, "plane.gravity"),
        ("bouncing", {"time.steps": 100}, "time"),
        ("standing", {"plane.contact.restitution": 0.5}, "plane.contact.restitution"),
    ],
)
def test_boxes_whose_numbers_would_mean_something_else_are_refused(name, values, field):
    with pytest.raises(InputError) as caught:
        problem_of(load_scene(f"rigid-{name}").with_values(values))
    assert caught.value.field == field


def test_a_scene_without_a_title_is_called_by_its_name():
    scene = load_scene("rigid-standing")
    titles = [problem_of(scene.model_copy(update={"title": title})).title for title in ("", "TITLE")]
    assert titles == [scene.name, "TITLE"]


def test_the_question_of_boxes_may_be_asked_with_another_friction():
    steeper = problem_of(load_scene("rigid-standing").with_values({"plane.contact.friction": 19.0}))
    judgement = judge(steeper, standard(steeper).exact)
    (one,) = judgement.criteria
    assert "slid" in one.name and judgement.status is Status.PASS
