"""The page of `advise`: its table, its lines and what it asks to be typed, of an answer that is made."""

import math
import re
from types import SimpleNamespace

import numpy as np
import pytest

from validation.advice import contact_page, goals, overview
from validation.advice.across import advise_across
from validation.advice.goals import Question, Recommendation
from validation.advice.hooks import AdviceHooks
from validation.advice.overview import HEADS, Fact, Overview, PresentError, lines, recommended
from validation.advice.pages import PageHooks, page_of_cut
from validation.errors import InputError
from validation.runs.history import History
from validation.scenes.plain import PlainHooks
from validation.scenes.scene import load_scene

PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002})
SECONDS = {"dda": 0.123, "fem": None}
FIRST = {"time.step": 1.23456e-3, "time.alpha": 0.25, "time.delta": 0.5, "time.gg": 0.987}
FIRST |= {"contact.stiffness": 1.2345e9}


def offer(goal="wave", settings=FIRST, reached=True, error=0.0321, force=2e-6, unsure=0.0):
    return Recommendation(goal, "ON", settings, reached, error, force, "REFERENCE", unsure, 77, 0.5, SECONDS)


def test_a_row_of_the_table_says_what_to_set_and_what_is_left():
    layers = [{"thickness": 1.0, "blocks": 3}, {"thickness": 2.0, "blocks": 5}]
    heads, *rows = overview._table(
        [
            offer(),
            offer("impact", FIRST | {"contact.rule": "energy-conserving", "block.subdivide": [2, 4]}, force=None),
            offer("cut", {"plane.subdivide": [3, 6]}, error=1e-5),
            offer("column", {"column.layer": layers}, force=0.9e-5),
        ]
    )
    assert heads == HEADS
    assert rows == [
        ("wave", "0.001235", "0.25, 0.5", "0.987", "1.23e+09", "as is", "3.21 %", "0 %", "77", "0.12", "-"),
        ("impact", "0.001235", "0.25, 0.5 energy-conserving", *rows[0][3:5], "2 x 4", "3.21 %", "-", "77", "0.12", "-"),
        ("cut", "nan", "as is", "as is", "-", "3 x 6", "0.001 %", "0 %", "77", "0.12", "-"),
        ("column", "nan", "as is", "as is", "-", "3, 5", "3.21 %", "0 %", "77", "0.12", "-"),
    ]


def test_settings_are_written_as_they_are_typed():
    for value, text in (
        (1.23456789e-3, "0.00123457"),
        ([2, 4], "[2, 4]"),
        ("average", "average"),
        ([{"thickness": 1.0, "velocity": None, "blocks": 3}], "[{ thickness = 1, blocks = 3 }]"),
    ):
        assert overview._written(value) == text


def answer(*offers, **fields):
    given = {"scene": "s", "error": 0.05, "facts": (), "present": None, "recommendations": offers, "refused": {}}
    return Overview(**(given | fields))


def test_what_to_type_next_is_the_settings_of_one_or_a_goal_of_several():
    question = Question("mine.toml", error=0.02, frequency=7.5, keep_springs=True)
    assert question.stated == " --error 0.02 --frequency 7.5 --keep-springs" and Question().stated == ""
    one = [*recommended(question, answer(offer(settings={"time.step": 0.001, "block.subdivide": [1, 2]})))]
    assert len(one) == 4  # a heading, the table, its condition, what to type
    assert one[-1].endswith("mine.toml --set time.step=0.001 --set 'block.subdivide=[1, 2]'")
    several = answer(
        offer(reached=False), offer(unsure=1.1e-6), offer("quake", reached=False), refused={"static": "WHY"}
    )
    several = [*recommended(question, several)]
    assert len(several) == 7 and several[4] == "static: WHY"
    assert "%" in several[2] and "%" not in several[3]  # the reference is uncertain, or is not
    assert [name for name in goals.GOALS if name in several[5]] == ["wave", "quake"]
    assert f"mine.toml{question.stated} --goal" in several[-1]
    assert [*recommended(question, answer(refused={"static": "WHY"}))] == ["static: WHY"]
    data, page = page_of_cut(PAPER, question, "SENTENCE", offer())
    assert (data["sentence"], data["error"], [*page][:2]) == ("SENTENCE", 0.02, ["SENTENCE", ""])


def test_a_page_has_its_facts_its_error_and_where_there_is_more():
    subjects = {"first mode": "damping", "springs": "contact", "glue": "damping"}
    facts = tuple(Fact(subject, "TOLD", part) for subject, part in subjects.items())
    made = answer(facts=facts, refused={"static": "WHY"}, present=PresentError("REFERENCE", 0.25, 0.0123, 0.0456))
    page = "\n".join(lines(PAPER, Question("mine.toml"), made)).splitlines()
    assert page[-1] == "static: WHY"
    assert [line.split("  ")[1] for line in page[3:6] if line.endswith("TOLD")] == [*subjects]
    assert re.findall(r"[\d.]+(?= [%s])", page[6]) == ["1.23", "4.56", "0.25"]
    first, second = (line.split("dda-validate ") for line in page[7:9])
    assert first[1] == "advise damping mine.toml" and "first mode, glue" in first[0]
    assert second[1] == "advise contact mine.toml --set contact.law=unilateral" and "springs" in second[0]
    opens = "\n".join(lines(load_scene("unlocked-constant").expand()[0], Question("mine.toml"), made))
    assert "dda-validate show mine.toml" in opens
    slides = load_scene("slope-drag").expand()[0]
    assert len([*lines(slides, Question("x"), made)]) > len([*lines(PAPER, Question("x"), made)])


def test_a_block_that_slides_is_off_by_its_distance_and_its_mean_force(monkeypatch):
    scene = load_scene("slope-drag").expand()[0].with_values({"time.steps": 100})
    angle, friction = (math.radians(x) for x in (scene.load.slope, scene.contact.friction))
    pull = scene.load.gravity * (math.sin(angle) - math.cos(angle) * math.tan(friction))
    distance = pull * scene.time.duration**2 / 2
    width = scene.block.extent[0]
    pressure = scene.block.mass * scene.load.gravity * math.cos(angle) / width

    def made(scene, solver, values):
        pressures = [0.9 * pressure, pressure]
        columns = {goals.ALONG: [0.0, -1.03 * distance], "displacement": [0.0, 0.0], "contact_pressure": pressures}
        return History([1.0, 2.0], columns)

    monkeypatch.setattr(goals, "history_of_run", made)
    assert goals.slide_errors(scene) == pytest.approx((0.03, 0.05), rel=1e-6)
    monkeypatch.setattr(goals, "history_of_run", lambda *given: None)
    assert goals.slide_errors(scene) is None


def test_kinds_of_scenes_of_which_nothing_is_known_are_refused():
    scene = load_scene("rigid-impact")
    for ask in (
        lambda: PageHooks.page(PageHooks.of(scene), scene, Question()),
        lambda: AdviceHooks.of(scene).cut(scene, [1]),
        lambda: AdviceHooks.of(scene).layers(scene),
        lambda: PlainHooks().data(scene),
    ):
        with pytest.raises(InputError) as refusal:
            ask()
        assert refusal.value.source == scene.name


def test_columns_and_blocks_of_which_no_landing_is_known_are_refused():
    column = load_scene("waves-base").expand()[0]
    opens = PAPER.with_values({"contact.law": "unilateral"})
    rigid = {"contact.stiffness": math.inf, "contact.shear_stiffness": 0.0}
    tapered = {"block.vertices": [[0, 0], [2, 0], [1.5, 2], [0.5, 2]]}
    for ask, field in (
        (lambda: contact_page.scenes(column), None),
        (lambda: contact_page.scenes(PAPER), "contact.law"),
        (lambda: overview.overview(column, Question()), None),
        (lambda: advise_across(column, 0.1), None),
        (lambda: advise_across(opens.with_values(rigid), 0.1), None),
        (lambda: advise_across(opens.with_values(tapered), 0.1), None),
    ):
        with pytest.raises(InputError) as refusal:
            ask()
        assert refusal.value.field == field


@pytest.mark.parametrize(
    ("values", "reference", "finer"),
    [
        ({}, "bar", 1),
        ({"block.poisson": 0.2, "time.gg": 0.98, "time.steps": 500}, "fem", 8),
        ({"contact.law": "unilateral", "time.gg": 0.98}, "block-events", 1),
    ],
)
def test_the_present_run_is_measured_against_what_is_exact(values, reference, finer, monkeypatch):
    asked = {}

    def made(case, name):
        asked[name] = case.time
        time = case.time.step * np.arange(1, case.time.steps + 1)
        off = 0.02 if name == "dda" else 0.0
        columns = {
            "displacement": -0.01 * (1 + off) * np.sin(30 * time),
            "contact_pressure": 1e6 * (1 - 2 * off) * time,
        }
        return SimpleNamespace(history=History(time, columns))

    monkeypatch.setattr(overview, "solve", made)
    scene = PAPER.with_values({"time.steps": 60} | values)
    error = overview._present_error(scene)
    assert (error.displacement, error.force) == (pytest.approx(0.02), pytest.approx(0.04))
    steps = min(scene.time.steps, 400)
    assert error.window == pytest.approx(steps * 0.002) and asked["dda"].steps == steps
    (name,) = asked.keys() - {"dda"}
    assert (name == reference or reference == "bar") and asked[name].steps == finer * steps
    assert asked[name].step == pytest.approx(0.002 / finer)
    assert asked[name].discount == 1.0  # which has no kinetic damping
    for last in (None, finer * steps - 1):  # of a run that ends before its time, or has no history

        def ended(case, name, last=last):
            history = made(case, name).history
            short = History(history.time[:last], history.columns)
            return SimpleNamespace(history=history if name == "dda" else last and short)

        monkeypatch.setattr(overview, "solve", ended)
        assert overview._present_error(scene) is None
