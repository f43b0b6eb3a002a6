"""The search beside runs of a scene, with a formula in the place of the runs: a swing whose numbers are candidates."""

import math
from dataclasses import replace

import numpy as np
import pytest

from validation import load_scene
from validation.diagnosis import beside
from validation.diagnosis.beside import FARTHEST, RunVerdict, SceneSearch, answer_of, verdict_of
from validation.diagnosis.constants import MOST_ALIKE, ORDER
from validation.diagnosis.evidence import Departure
from validation.diagnosis.numbers import CandidateChange, fixed
from validation.diagnosis.one_change import Fitted
from validation.diagnosis.reading import Foreign, Stepping
from validation.diagnosis.readings import Reading, Slip
from validation.errors import InputError

STEP = 0.01
ROWS = 60
SCENE = load_scene("figures-3-4").with_values({"time.gg": 0.99})
OWN = {"m": 1.3, "k": 1700.0, "q": 25.0, "d": 0.7}


class Swing(SceneSearch):
    """Runs of a mass on a damped spring under a load, whose numbers are those of a change."""

    NAMES = ("displacement", "contact_pressure")
    WOULD_TELL = "WOULD TELL"

    def __init__(self, recorded, changes=(), apart=0.0, step=1, rounding=None):
        self.changes = changes
        self.apart = apart
        rows = np.arange(step - 1, step * recorded.shape[1], step)
        stepping = Stepping(np.full(step * recorded.shape[1], STEP), rows)
        super().__init__(SCENE, Reading(stepping, recorded, rounding))

    def candidates(self):
        return iter(self.changes)

    def solved(self, values, steps, is_shifted):
        if values.get("fails"):
            return None
        columns = columns_of(values, steps)
        return columns * (1 + is_shifted * self.apart * 2.0 ** np.arange(columns.shape[1]))


def columns_of(values, steps=ROWS):
    """Return displacement and pressure of a swing."""
    n = OWN | {"parts": 1} | values
    t = STEP / n["parts"] * np.arange(1, n["parts"] * steps + 1)
    x = n["q"] / n["k"] * (np.exp(-n["d"] * t) * np.cos(np.sqrt(n["k"] / n["m"]) * t) - 1)
    return np.array([x, -n["k"] * x])


def factor(name, key, power=1.0, starts=(0.7, 1.4)):
    """Return the change by which a number is larger by a power of a factor."""
    words = f"{name} {{:.4g}}".format
    return CandidateChange(
        name, words, math.exp, lambda u: {key: OWN[key] * math.exp(power * u)}, tuple(map(math.log, starts))
    )


MASS = factor("density-factor", "m")
LIGHTNESS = factor("young-factor", "m", -1.0)
LOAD = factor("load-factor", "q")
SPRINGS = factor("springs-factor", "k")
DAMPED = fixed("no-friction", "more damping", {"d": 2.1})


def named(search):
    return [(one.id, one.value) for one in search.alike(search.explanations())]


def test_the_number_of_the_candidate_that_gives_a_history_is_found_to_its_digits(monkeypatch):
    changes = (DAMPED, SPRINGS, LOAD, MASS)
    search = Swing(columns_of({"m": 1.3 * 1.17}), changes)
    found = search.explanations()
    assert [one.id for one in found] == ["density-factor"]  # others are left where they come no nearer
    assert named(search) == [("density-factor", 1.17)]
    assert found[0].ratio <= 1 and not found[0].is_noise and found[0].left < 1e-9
    verdict = verdict_of(search, found)
    assert (verdict.explained, verdict.causes, verdict.alike) == (True, {"density-factor": 1.17}, [])
    assert verdict.words == {"density-factor": "density-factor 1.17"}
    assert verdict.best == pytest.approx({"m": 1.3 * 1.17}, rel=1e-9)
    assert verdict.left == pytest.approx(0, abs=1e-10)
    monkeypatch.setattr(beside, "PURSUED", 1)
    assert [one.id for one in Swing(columns_of({"m": 1.3 * 1.17}), changes).explanations()] == ["density-factor"]
    begun = [Fitted(change) for change in (SPRINGS, LOAD)]
    assert "density-factor" not in [one.id for one in search.explanations(begun)]
    assert named(Swing(columns_of({"d": 2.1}), changes)) == [("no-friction", None)]
    assert verdict_of(search, []).causes == {}


def test_numbers_of_one_product_stand_for_each_other():
    search = Swing(columns_of({"m": 1.0})[:1], (MASS, LIGHTNESS, LOAD))
    found = search.explanations()
    assert {one.id: one.value for one in search.alike(found)} == {
        "density-factor": pytest.approx(1 / 1.3, rel=1e-5),
        "young-factor": pytest.approx(1.3, rel=1e-5),
    }
    verdict = verdict_of(search, found)
    assert not verdict.explained
    (one,) = (one for one in verdict.alike if one["causes"] == ["young-factor"])
    assert one["values"] == {"young-factor": pytest.approx(1.3, rel=1e-5)} and one["further_scene"]


def test_a_number_beyond_a_factor_of_ten_thousand_is_none():
    far = factor("springs-factor", "m", 1e-3)  # forgotten, or in other units
    assert named(Swing(columns_of({"m": 1.3 * math.exp(9.1e-3)}), (far,))) == [
        ("springs-factor", pytest.approx(8955.29, rel=1e-3))
    ]
    assert named(Swing(columns_of({"m": 1.3 * math.exp(9.3e-3)}), (far,))) == []


def test_a_history_departs_by_enough_rows_for_a_cause():
    for rows, ids in ((ORDER, ["density-factor"]), (ORDER - 1, [])):
        late = Swing(columns_of({"m": 1.5}, rows), (MASS,))
        assert [one.id for one in late.explanations()] == ids
        assert len(late.departing) == rows
    scene = columns_of({})
    for times, ids in ((9.0, []), (11.0, ["load-factor"])):  # of what may remain
        near = Swing(scene * (1 + times * 1e-8), (factor("load-factor", "q", 1.0, (0.9, 1.1)),))
        assert [one.id for one in near.explanations()] == ids
    moved = scene.copy()
    moved[:, 20:] *= 1.002
    search = Swing(moved, (LOAD,))
    assert search.departing.tolist() == list(range(20, 60))
    assert search.judged(Fitted(fixed("gg", "", {}), 0.0, 0.0)).ratio > 1
    assert search.departure(RunVerdict(search, False)) == Departure(21, "offset")
    assert Swing(scene).departure(RunVerdict(search, True)) is None


def test_rows_are_judged_up_to_where_two_correct_codes_agree():
    """The shifted run is 2^n times 1e-16 away: of the largest value a millionth from row 36 on."""
    scene = columns_of({})
    search = Swing(scene, apart=1e-16)
    apart = np.abs(scene) * 1e-16 * 2.0 ** np.arange(ROWS)
    beyond = np.flatnonzero(np.any(apart > 1e-6 * np.max(np.abs(scene), axis=1, keepdims=True), axis=0))[0]
    assert search.rows == beyond == 36
    sizes = np.max(np.abs(scene), axis=1, keepdims=True)
    expected = 1e-8 * sizes + np.maximum.accumulate(apart, axis=1)[:, :beyond]
    assert search.allowed == pytest.approx(expected, rel=1e-4)
    stated = Swing(scene, rounding=np.full(scene.shape, 0.3)).allowed
    assert stated == pytest.approx(np.broadcast_to(0.3 + 1e-8 * sizes, scene.shape), rel=1e-12)
    printed = Swing(np.round(scene, 4)).allowed
    assert printed[0] == pytest.approx(np.full(ROWS, 1e-4 + 1e-8 * np.max(np.abs(scene[0]))), rel=1e-3)
    near = Swing(scene * (1 + 5e-8), apart=1e-11)
    unit = 1e-8 * sizes + 2 * np.maximum.accumulate(1e5 * apart, axis=1)[:, : near.rows]
    own = near.judged(Fitted(fixed("gg", "", {}), 0.0, 0.0))
    assert own.ratio == pytest.approx(np.max(5e-8 * np.abs(scene[:, : near.rows]) / unit), rel=1e-4)
    changed = scene.copy()
    changed[:, beyond:] = 0.0
    assert Swing(changed, apart=1e-16).is_scene()
    changed[:, beyond - 1] *= 1.5
    assert not Swing(changed, apart=1e-16).is_scene()
    assert not Swing(scene, apart=2e-9).is_scene()  # of some ten rows too few
    assert np.all(np.isinf(search.spread({"fails": True}, scene)))
    assert search.judged(Fitted(fixed("gg", "", {"fails": True}), 0.0, 0.0)).ratio == FARTHEST
    assert np.all(search.over(None, 5) == FARTHEST)
    assert np.all(search.over(scene * math.nan, 5) == FARTHEST)
    assert search.over(-1e12 * scene, 5) == pytest.approx(FARTHEST * np.sign(scene[:, :5]))


def test_a_scene_that_does_not_run_is_refused(monkeypatch):
    monkeypatch.setattr(Swing, "solved", lambda *given: None)
    with pytest.raises(InputError) as refusal:
        Swing(columns_of({}))
    assert refusal.value.source == SCENE.name


def test_what_remains_is_measured_by_column():
    scene = columns_of({})
    search = Swing(scene * [[1.0], [1.25]])
    assert search.misfits(search.scene_run) == pytest.approx([0.0, 0.25 / 1.25])
    assert search.misfits(search.scene_run * 0) == pytest.approx([1.0, 1.0])
    assert search.left(search.scene_run) == pytest.approx(0.2)
    assert [search.is_scene(tolerance) for tolerance in (0.19, 0.21)] == [False, True]
    assert Swing(scene, apart=1e-3).left(scene) == math.inf
    still = Swing(0 * scene)
    assert still.misfits(still.scene_run) == pytest.approx([1.0, 1.0])


def test_beside_noise_a_cause_stands_out_or_is_listed_with_others():
    true = columns_of({"m": 1.3 * 1.17})
    noise = 2e-3 * np.random.default_rng(5).standard_normal(true.shape) * np.max(np.abs(true), axis=1, keepdims=True)
    search = Swing(true + noise, (MASS, LOAD))
    (found,) = search.alike(search.explanations())
    assert found.id == "density-factor" and found.is_noise and found.ratio > 1
    assert found.value == pytest.approx(1.17, rel=1e-3)

    def explanation(left, is_noise=False, ratio=99.0):
        change = fixed("gg", "", {}, 1e3 * left)
        return Fitted(change, 0.0, 0.0, ratio, left, is_noise)

    best = explanation(1e-3, True)
    others = [explanation(2.9e-3, True), explanation(2.8e-3), explanation(3.1e-3, True), explanation(5.0, ratio=9.9)]
    assert [one.left for one in search.alike([best, *others])] == [1e-3, 2.9e-3, 5.0]
    search.model = "bar"  # what a mesh leaves has a shape
    assert [one.left for one in search.alike([best, *others])] == [1e-3, 2.9e-3, 2.8e-3, 5.0]
    assert search.alike(others[1:]) == search.alike([]) == []
    many = [explanation(0.1 * i, ratio=0.5) for i in range(1, 9)]
    assert len(verdict_of(search, many).alike) == MOST_ALIKE


def test_two_explanations_of_one_number_are_one():
    def scheme(alpha, start):
        return fixed("scheme", "", {"time.alpha": alpha, "time.delta": 0.5, "time.start": start})

    def listed(*changes):
        found = [Fitted(one, 0.2, 0.0, 0.5, 1e-3 * i) for i, one in enumerate(changes)]
        return [one.left for one in Swing(columns_of({})).alike(found)]

    assert listed(scheme(0.25, "zero"), scheme(0.25, "consistent"), scheme(0.3, "zero")) == [0.0, 2e-3]
    plain = fixed("gg", "", {}, math.exp(0.2))
    fitted = CandidateChange("gg", str, math.exp, lambda u: {}, (0.1,))
    assert listed(fitted, plain) == [1e-3]
    assert listed(fitted, fixed("gg", "", {}, math.exp(0.2) * 1.00013)) == [0.0, 1e-3]
    assert listed(fitted, fixed("gg", "", {})) == listed(fitted, fitted) == [0.0, 1e-3]
    assert listed(fixed("sign", "", {}, 1.0), plain) == [0.0, 1e-3]


FOREIGN = Foreign(np.ones(1), np.ones(1), notes=("note of the file",))
STAGES = {"reading": True, "displacement": False, "contact_pressure": False}


def agreements(answer):
    return {stage.name: stage.agrees for stage in answer.evidence}


def test_answers_hold_scheme_departure_nearest_and_curves():
    """Their numbers are those of `answers.toml`."""
    heavy = Swing(columns_of({"m": 1.3 * 1.17}), (MASS,))
    answer = answer_of(FOREIGN, verdict_of(heavy, heavy.explanations()))
    assert (answer.causes, answer.departure) == (["density-factor"], Departure(1, "phase"))
    assert answer.notes == ("note of the file",) and agreements(answer) == STAGES
    assert answer.curves["best"].displacement == pytest.approx(columns_of({"m": 1.3 * 1.17})[0], rel=1e-7)
    alone = answer_of(FOREIGN, RunVerdict(Swing(columns_of({})[:1]), True))
    assert (alone.causes, alone.departure, len(alone.curves["best"].columns)) == ([], None, 1)
    damped = Swing(columns_of({"d": 0.9}))
    of_schemes = {"time.alpha": 0.3, "time.delta": 0.6, "time.gg": 0.95}
    for cause, value in (("scheme", None), ("start", None), ("gg", 0.95), ("exact-in-time", None)):
        verdict = RunVerdict(damped, True, {cause: value}, {cause: "WORDS"}, {"d": 0.9} | of_schemes)
        assert answer_of(FOREIGN, verdict).causes == [cause]
    moved = columns_of({"m": 1.3 * 1.17, "d": 0.9})
    moved[:, :4] = columns_of({})[:, :4]
    search = Swing(moved, (MASS,))
    answer = answer_of(FOREIGN, verdict_of(search, search.explanations()))
    assert (answer.causes, answer.values, answer.departure.step) == (["unexplained"], {}, 5)
    assert " 4 " in answer.sentence and "0.04 s" in answer.sentence
    for one in (search, Swing(columns_of({"m": 3.0})), Swing(columns_of({}))):
        for given in ({}, {"gg": 0.5}):
            answer = answer_of(FOREIGN, RunVerdict(one, False, given, dict.fromkeys(given, ""), {"d": 60.0}))
            assert (answer.causes, answer.slips) == (["unexplained"], ())


def test_what_surrounds_a_block_is_no_fault_and_slips_of_reading_are_causes():
    search = Swing(columns_of({"k": 1600.0}), apart=1e-16)
    found = RunVerdict(search, True, {"base-compliance": 0.03}, {"base-compliance": "BASE"}, {"k": 1600.0})
    answer = answer_of(FOREIGN, found)
    assert answer.causes == ["base-compliance"] and answer.departure is None
    assert agreements(answer) == {"reading": True, "displacement": None, "contact_pressure": None, "horizon": None}
    search.reading = replace(search.reading, corrected=(Slip("unit", "displacement", 1e3),))
    alike = [{"causes": ["gg"], "values": {"gg": 0.5}, "further_scene": "FURTHER"}]
    for explained, causes in ((True, ["unit", "base-compliance"]), (False, ["unexplained"])):
        for same in ([], alike):
            answer = answer_of(FOREIGN, replace(found, explained=explained, alike=same))
            assert (answer.causes, bool(answer.slips)) == (causes, explained)
            assert answer.departure is not None and agreements(answer)["reading"] is False


def test_an_open_contact_has_no_noise():
    columns = columns_of({})
    columns[1, 12:] = 0.0
    sizes = 1e-6 * np.max(np.abs(columns), axis=1, keepdims=True) * (columns != 0)
    noisy = Swing(columns + sizes * np.random.default_rng(1).standard_normal(columns.shape))
    assert noisy.is_noise(columns) and not noisy.is_noise(columns * (1 + 3e-6 * np.sin(np.arange(ROWS) / 9)))
