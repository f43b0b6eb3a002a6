"""The search for the cause of a failure, with a formula in the place of the runs: a swing on two springs in series."""

import itertools
import math
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from faults import seams
from oracles import swings
from oracles.kept_answers import said
from oracles.stand_ins import assert_kept, summed

from validation.diagnosis import one_change
from validation.diagnosis.answer import Answer
from validation.diagnosis.families import ONE_SCHEME
from validation.errors import InputError
from validation.problems import cause as module
from validation.problems import models
from validation.problems.bands import standard_of
from validation.problems.cause import Cause, cause, compared
from validation.problems.models import Base, Runs
from validation.runs.history import History
from validation.scenes.scene import load_scene

KEPT = Path(__file__).with_name("numbers.toml")
SCENE = load_scene("field-locked")
OPENING = load_scene("field-opening")
AVERAGE = {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"}
COLUMNS = ("displacement", "contact_pressure")


def motion(values=(), exact=False, scene=SCENE):
    return swings.motion(scene, values, exact)


EXACT = motion(exact=True)
LARGER = {"the springs": {"contact.stiffness": 1.01e9}, "the density": {"block.density": 2727.0}}
STANDARD = standard_of(EXACT, {name: motion(values, exact=True) for name, values in LARGER.items()})


@pytest.fixture(autouse=True)
def by_formula(monkeypatch):
    seams.PROBLEM_RUNS.put(monkeypatch, lambda scene, values, name: motion(values, name != "dda", scene))
    monkeypatch.setattr(models, "runs_of", Runs)
    monkeypatch.setattr(module, "runs_of", Runs)
    monkeypatch.setattr(module, "compared", lambda scene, history: None)


def found(history, scene=SCENE):
    return cause(SimpleNamespace(scene=scene), history, STANDARD)


def changed(**columns):
    """Return the exact motion with other columns."""
    return History(EXACT.time, dict(EXACT.columns) | columns)


FACTORS = [
    ({"contact.stiffness": 1.3e9}, "springs-factor", 1.3),
    pytest.param({"damping.stiffness": 3e-5}, "stiffness-damping", 3e-5, marks=pytest.mark.long),
    ({"contact.law": "unilateral"}, "contact-opened", None),
]


@pytest.mark.parametrize(("values", "name", "number"), FACTORS)
def test_a_wrong_number_in_an_exact_program_is_named(values, name, number):
    one = found(motion(values, exact=True))
    assert one.ids == (name,)
    assert one.values == ({} if number is None else {name: pytest.approx(number, rel=1e-5)})
    assert (one.left <= 0.1, one.base, one.passing_step, one.would_tell) == (True, None, None, "")
    if number is not None:
        assert one.sentence.count(f"{one.values[name]:.4g}") == 1


def moved(late=0.0, rate=1.0):
    """Return the exact motion at other instants, at rest before t = 0."""
    fine = motion({"time.step": SCENE.time.step / 1e3, "time.steps": 60_000}, exact=True)
    instants = np.maximum(rate * (EXACT.time - late * SCENE.time.step), 0.0)
    time = np.r_[0.0, fine.time]
    return {name: np.interp(instants, time, np.r_[0.0, x]) for name, x in fine.columns.items()}


def test_rows_and_columns_may_be_wrong_by_themselves():
    x = EXACT.columns["displacement"]
    late = moved(late=0.4)
    for history, name, value, word in (
        (changed(displacement=1.07 * x), "factor", 1.07, "displacement is"),
        (changed(contact_pressure=late["contact_pressure"]), "shift", 0.4, "contact_pressure is 0.4 steps late"),
    ):
        one = found(history)
        assert one.ids == (name,), word
        assert one.values[name] == pytest.approx(value, rel=2e-3) and word in one.sentence
    faster = found(changed(**moved(rate=0.93)))
    assert (faster.ids, len(faster.alike)) == (("density-factor",), 1)  # from rest, without weight, mass sets the rate
    assert faster.values["density-factor"] == pytest.approx(0.93**-2, rel=1e-5)
    assert "time runs 0.93 times" in faster.alike[0]


def test_what_gives_the_same_rows_is_told_and_of_too_many_none_is_named():
    one = found(motion({"load.pressure": 0.8 * SCENE.load.pressure}, exact=True))
    assert (one.ids, one.values) == (("load-factor",), {"load-factor": pytest.approx(0.8, rel=1e-5)})
    assert len(one.alike) == 1 and one.alike[0] in one.sentence and "all columns" in one.alike[0]

    def named(*lefts, ids=("gg",), values=True):
        causes = [Cause(f"S{i}", ids, {"gg": 0.9 - i / 10} if values else {}, (), left) for i, left in enumerate(lefts)]
        return module._named(causes)

    assert named(1e-4, 0.0098).alike == ("S1",)  # within ten times a thousandth of the band
    assert named(1e-4, 0.0102).alike == () == named(1e-4, 1e-4, values=False).alike
    assert named(0.02, 0.19, 0.21).alike == ("S1",)
    both = [Cause(f"S{gg}", ("gg",), {"gg": gg}, (), 1e-4) for gg in (0.903, 0.897)]
    assert module._named(both).alike == ()  # of two digits, as one number
    many = named(*4 * [1e-4])
    assert (many.ids, len(many.alike), many.would_tell) == ((), 4, module.OTHERS_WOULD)
    assert "gg 0.9, gg 0.8" in many.sentence and named(*3 * [1e-4]).ids == ("gg",)
    two = [
        Cause("A; and B", ("scheme", "gg"), {"gg": 0.9}, (), 0.0),
        Cause("A; and C", ("scheme", "x"), {"x": 1.0}, (), 0.0),
    ]
    assert module._named(two).sentence == "A; and B (the same rows: C)"
    alone = Cause("ALONE", ("x",), {"x": 2.0}, (), 1e-5)
    assert module._named([*two, alone]) is alone  # fewer causes
    usual = [Cause(name, (name,), {name: 1.5}, (), 0.0) for name in ("time-factor", "unheard", "factor", "load-factor")]
    ranked = sorted([*usual, Cause("law", ("law",))], key=module._rank)
    assert [one.sentence for one in ranked] == ["law", "load-factor", "factor", "time-factor", "unheard"]


SCHEMES = [
    ({}, {"alpha": 0.5, "delta": 1.0, "step": 0.002}, "DDA's usual scheme"),
    (AVERAGE, {"alpha": 0.25, "delta": 0.5, "step": 0.002}, "the error of its step"),
    ({"time.alpha": 1.0, "time.delta": 0.5}, {"alpha": 1.0, "delta": 0.5, "step": 0.002}, models.INTERCHANGED),
    ({"time.start": "consistent"}, {"alpha": 0.5, "delta": 1.0, "step": 0.002}, "initial acceleration consistent"),
]


def test_a_scheme_is_named_with_the_step_at_which_it_passes(monkeypatch):
    monkeypatch.setattr(Runs, "exact", None)  # of digits that agree nothing else is asked
    for values, numbers, words in SCHEMES:
        one = found(motion(values))
        assert (one.ids, one.values) == (("scheme",), numbers)
        assert words in one.sentence
        runs = Runs(SCENE, STANDARD)
        shares = []
        for step in (one.passing_step, 2 * one.passing_step):
            every = round(SCENE.time.step / step)
            shares.append(runs.apart(runs.sampled(Base("", values, every)), EXACT.columns))
        assert shares[0] <= 1 < shares[1] and SCENE.time.step / one.passing_step >= 2


def test_another_number_beside_the_usual_scheme_is_told_with_it():
    one = found(motion({"time.gg": 0.97}))
    assert one.ids == ("scheme", "gg") and one.values["gg"] == pytest.approx(0.97, rel=1e-5)
    assert one.base is None and "; and " in one.sentence


def test_what_nothing_gives_back_is_left_to_compare(monkeypatch):
    wave = 1 + 0.3 * np.sin(np.arange(len(EXACT.time)))
    strange = changed(**{name: wave * x for name, x in EXACT.columns.items()})
    one = Cause()
    assert (one.ids, one.sentence, one.left, one.would_tell) == ((), module.NOT_EXPLAINED, math.inf, module.WOULD_TELL)
    monkeypatch.setattr(module, "compared", lambda scene, history: Cause("COMPARED", ("gg",)))
    assert found(strange).sentence == "COMPARED"


def test_nothing_that_moves_no_numbers_and_other_units_need_no_search():
    x = EXACT.columns["displacement"]
    none = {name: 0.99e-7 * values for name, values in EXACT.columns.items()}
    assert found(changed(**none)).ids == ("nothing-moves",)
    assert found(changed(**(none | {"displacement": 1.2e-7 * x}))).ids != ("nothing-moves",)
    holes = np.where(np.arange(len(x)) == 6, math.inf, x)
    broken = found(changed(displacement=holes))
    assert broken.ids == ("not-finite",) and "displacement" in broken.sentence and " 7 " in broken.sentence
    one = found(changed(displacement=1e3 * x))
    assert (one.ids, [*one.values]) == (("unit",), ["displacement"])


def test_what_is_tried_is_as_before():
    runs = Runs(SCENE, STANDARD)
    found = []
    for base in (runs.exact(), *list(runs.schemes())[:2], Base("", {}, 2)):
        for cheap in (True, False):
            for change in (*module.of_damping(SCENE), *module.of_output(SCENE, runs.dense(base), COLUMNS[: 1 + cheap])):
                numbers = re.findall(r"[\d.]+", change.words(1.3))
                found.append([change.id, change.starts, change.nudge, change.value(0.3), numbers])
                tried = module.Search(runs, {})
                found.append([tried._columns(base, change.changed(u)) for u in (0.07, -0.4, change.starts[-1])])
    for scene in (SCENE, OPENING, load_scene("field-rocking"), load_scene("field-joint")):
        for base in Runs(scene, STANDARD).schemes():
            found.append([base.values, base.every, base.usual, *base.pair(scene.time)])
            found.append([models.INTERCHANGED in base.words, base.exact])
    exact = (None, runs.exact(), Base("", {}), Base("", {}, 2, solver="bars-events"))
    for scene, one, cheap in itertools.product((SCENE, load_scene("field-rocking")), exact, (True, False)):
        bases = module.Search(Runs(scene, STANDARD), {})._bases(one, cheap)
        found.append([[base.values, base.every, base.solver] for base in bases])
    named = [Cause(f"C{i}", ids, dict.fromkeys(ids, 0.9), (), 1e-3 * i) for i, ids in enumerate((("gg",), ("x", "gg")))]
    found += [[module._rank(one), module._short(one)] for one in named]
    weighty = {"load.gravity": 9.81}, {"block.velocity": -1.0, "contact.law": "unilateral"}, {"time.gg": 0.9}
    for scene in (
        SCENE,
        *map(SCENE.with_values, weighty),
        *map(load_scene, ("field-column", "field-joint", "field-stack")),
    ):
        found.append(module._scheme_sentence(Base("W", AVERAGE), scene).split())
    factors = (1.0, 1e-3, 0.98e-3, 970.0, 1e2)
    for first in factors:
        for second in factors:
            both = changed(displacement=first * EXACT.displacement, contact_pressure=second * EXACT.contact_pressure)
            found.append(module._units(both.columns, runs))
    assert_kept(KEPT, "cause", {"tried": summed(said(found, 1e-9))})


def test_numbers_are_looked_for_where_runs_are_cheap(monkeypatch):
    asked = []
    bases = [Base("", {}, solver="bars-events"), Base("words", {})]
    monkeypatch.setattr(Runs, "exact", lambda runs: None)

    class Asked(module.Search):
        def _schemes(self):
            return []

        def _bases(self, exact, cheap):
            asked.append([cheap])
            return bases

        def _changes(self, base, cheap):
            asked[-1].append(bool(cheap))
            return []

    for name in ("locked", "sliding", "rocking", "stack", "cradle", "joint"):
        assert Asked(Runs(load_scene(f"field-{name}"), STANDARD), {}).causes() == []
    cheap = [True, True, True]
    assert asked == [cheap, *2 * [3 * [False]], cheap, *2 * [[False, False, True]]]


def test_a_run_stands_for_the_exact_motion_where_it_is_near_enough(monkeypatch):
    runs = Runs(SCENE, STANDARD)
    base = runs.exact()
    assert (base.exact, base.every, base.solver) == (True, 8, "dda")
    assert (base.pair(SCENE.time), Base("x", {}).pair(SCENE.time)) == ((0.25, 0.5), (0.5, 1.0))
    assert [one.every for one in runs._accurate()] == [1, 8, 32, 128]
    assert len(runs.dense(base).time) == 8 * 57  # an eighth further than the scene
    assert [len(x) for x in runs.sampled(base).values()] == [50, 50]
    assert runs.sampled(base)["displacement"] == pytest.approx(runs.dense(base).displacement[7:400:8])
    assert len(runs.dense(Base("words", {}, 4)).time) == 4 * 50
    assert [one.every for one in Runs(OPENING, STANDARD)._accurate()] == [1, 8, 32]
    (of_bars,) = Runs(load_scene("field-cradle"), STANDARD)._accurate()
    assert (of_bars.solver, of_bars.every) == ("bars-events", 8)
    assert runs.dense(replace(base, solver="block-events", every=1)).displacement[:50] == pytest.approx(
        EXACT.displacement
    )
    off = History(EXACT.time, {name: 1.01 * x for name, x in EXACT.columns.items()})
    assert Runs(SCENE, replace(STANDARD, exact=off)).exact() is None
    seams.PROBLEM_RUNS.put(monkeypatch, lambda *given: None)
    assert Runs(SCENE, STANDARD).exact() is None and Runs(SCENE, STANDARD).sampled(base) is None


def test_a_solver_that_does_not_run_to_its_end_has_no_history(monkeypatch):
    monkeypatch.undo()
    ends = {"refusal": lambda scene: None, "solve": lambda scene: SimpleNamespace(history=EXACT)}

    def given(steps=50, **other):
        monkeypatch.setattr(one_change, "get_solver", lambda name: SimpleNamespace(**(ends | other)))
        return one_change.run_of(SCENE, {"time.steps": steps}, "dda")

    def fails(scene):
        raise ZeroDivisionError

    endless = changed(displacement=math.inf * EXACT.columns["displacement"])
    assert given() is EXACT
    assert given(steps=51) is given(steps=-1) is None
    assert given(refusal=lambda scene: "no" if scene.time.steps == 50 else None) is None
    assert given(solve=fails) is None
    assert given(solve=lambda scene: SimpleNamespace(history=endless)) is None


def test_compare_is_asked_where_it_can_look(monkeypatch):
    monkeypatch.undo()
    answer = Answer(sentence="SENTENCE", causes=["gg"], scheme={}, departure=None, values={"gg": 0.9}, misfit=0.3)
    asked = []

    def given(**fields):
        monkeypatch.setattr(
            module, "compare", lambda scene, foreign: asked.append(foreign) or replace(answer, **fields)
        )
        return compared(SCENE, EXACT)

    one = given()
    assert (one.sentence, one.ids, one.values, one.left) == ("SENTENCE", ("gg",), {"gg": 0.9}, 0.3)
    assert asked[0].displacement is EXACT.displacement and asked[0].pressure is EXACT.columns["contact_pressure"]
    assert given(causes=[]).ids == ("scheme",)
    assert given(causes=["unexplained"]) is None
    assert given(alike=[{"further_scene": ONE_SCHEME}]) is not None and given(alike=[{"further_scene": "x"}]) is None
    assert compared(SCENE, History(EXACT.time, {"rotation": EXACT.displacement})) is None

    def refuses(scene, foreign):
        raise InputError("no")

    monkeypatch.setattr(module, "compare", refuses)
    assert compared(SCENE, EXACT) is None
