"""What `compare` says: soft springs are never called benign, and every number in its words has its sign and unit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from oracles.few_moves import only
from oracles.made_cases import line_in
from oracles.pages import NUMBER
from oracles.stand_ins import assert_kept, numbers_in, summed

from validation import load_scene, solve
from validation.cli import compare as cli_compare
from validation.diagnosis import evidence
from validation.diagnosis import sentences as wording
from validation.diagnosis.answer import Answer, sentence
from validation.diagnosis.causes import CAUSES, words_of
from validation.diagnosis.evidence import Departure, Stage
from validation.diagnosis.fits.fit import Interval
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.diagnosis.schemes import FAMILIES, other_names
from validation.diagnosis.variant import Variant
from validation.errors import InputError
from validation.report.blocks import Callout, FigureBlock, Paragraph, Table
from validation.report.chapters import compare as chapters_compare
from validation.report.figures import histories as figures
from validation.report.figures.curves import style_of
from validation.runs.history import History
from validation.solvers.history_table import HeaderNames

KEPT = Path(__file__).with_name("numbers.toml")
STAGES = tuple(
    Stage(name, agrees, "words", {}) for name, agrees in (("at_rest", True), ("period", False), ("load", None))
)
SCENE = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 30})
OWN = Variant(0.5, 1.0, 1.0)


@pytest.mark.long
def test_a_base_that_adds_two_per_cent_is_benign():
    c = SCENE.contact
    values = {"contact.stiffness": c.stiffness / 1.04, "contact.shear_stiffness": c.shear}
    theirs = solve(SCENE.with_values(values), "dda")
    answer = compare(SCENE, Foreign(theirs.time, theirs.displacement, theirs.contact_pressure))
    assert (answer.causes, answer.departure) == (["base-compliance"], None)
    # the rows alone do not tell a base from softer springs, or from a wider block: the exit status says that it departs
    assert answer.departs
    found = {name: value for one in answer.alike for name, value in one["values"].items()}
    assert found == pytest.approx({"springs-factor": 1 / 1.04, "width-factor": 1.04}, rel=1e-5)
    # what is no fault is taken over into what is expected
    assert np.allclose(answer.curves["dda"].displacement, answer.curves["the file"].displacement, rtol=1e-6)


def judged(change, **values):
    """Judge a history of DDA with other values against the scene at gg = 0.98, its columns changed."""
    scene = SCENE.with_values({"time.gg": 0.98})
    run = solve(scene.with_values({key.replace("__", "."): value for key, value in values.items()}), "dda")
    return compare(scene, Foreign(run.time, *change(run.displacement, run.contact_pressure)))


@pytest.mark.parametrize("late", [1, pytest.param(-1, marks=pytest.mark.long)])
def test_rows_that_are_shifted_by_a_step_are_said_so(late, monkeypatch):
    only(monkeypatch, "time-shift", "pressure-shift", "gg", "row-means")

    def shifted(values):
        return np.append(0.0, values[:-1]) if late > 0 else np.append(values[1:], values[-1])

    answer = judged(lambda v, p: (shifted(v), shifted(p)))
    assert (answer.causes, answer.values) == (["time-shift"], {"time-shift": late})


def test_sentences_are_as_before():
    """Their numbers, and which of them are the same: of every cause, of schemes, of what is not explained."""
    fields = [
        {"discounted": "velocity"},
        {"discounted": "(7)"},
        {"kept": "springs"},
        {"kept": "stress"},
        {"point": 1.0},
    ]
    fields += [{"family": family, "spectral": 0.4} for family in (*FAMILIES, "newmark")]
    fields += [{"contact": contact} for contact in ("impact", "mean gap")] + [
        {"alpha": 1.0, "delta": 0.5, "gg": 0.9801}
    ]
    fields += [{"family": "hht", "alpha": 1.0, "delta": 0.5}, {"family": "composite", "split": 0.5}]
    fields += [{"family": "composite", "split": 0.4}, {"family": "chung-hulbert", "spectral": 0.5}]
    fields += [{"alpha": 0.25, "delta": 0.5, "start": "consistent", "gg": gg} for gg in (0.9, 1.0)]
    fields += [{"alpha": 1.0, "delta": 1.5, "gg": gg} for gg in (0.9, 1.0)] + [{"family": "leapfrog", "gg": 0.9}]
    fields += [{"family": "chung-hulbert", "spectral": 0.0}, {"family": "composite", "split": 2 - 2**0.5}]
    fields += [{"family": "theta", "spectral": 1.0}, {"family": "theta", "spectral": 1.0, "contact": "impact"}]
    variants = [replace(OWN, **changes) for changes in fields]
    numbers = (-1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0, 12.0)
    scene = replace(OWN, alpha=0.5, delta=1.0, gg=0.99, start="consistent")
    near = {"causes": ["gg", "density-factor"], "values": {"gg": 0.98}}
    alike = [near | {"further_scene": "FURTHER"}, {"causes": ["scheme"], "values": {}, "further_scene": ""}]
    about = replace(ANSWER, causes=["gg", "own-weight"], alike=[], departure=Departure(7, "phase"))
    one_output = replace(about, causes=["pressure-shift"], departure=None)
    words = {"gg": "GG", "own-weight": "WEIGHT", "pressure-shift": "SHIFT"}
    lost = replace(about, causes=["unexplained"], nearest=near)
    columns = [("displacement", 3, 0.02), ("contact_pressure", 9, 0.1)]
    of_causes = []
    for name in CAUSES:
        texts = [words_of(name, value, OWN, scene, scheme="S") for value in numbers]
        texts += [words_of(name, 0.5, v, scene, scheme="S") for v in variants]
        of_causes += [[texts.index(text), len(text.split()) - len(texts[0].split())] for text in texts]
        of_causes += [NUMBER.findall(text) for text in texts]
        assert not any("{" in text for text in texts), name
    found = {
        "of schemes": [wording.scheme_of(v) for v in (*variants, replace(OWN, exact=True))],
        "others of schemes": [other_names(v) for v in variants],
        "of several": [
            *(sentence(replace(about, alike=same), words, "SCHEME", "BAR") for same in ([], alike)),
            *(sentence(replace(one_output, alike=same), words, "SCHEME") for same in ([], alike)),
            *(sentence(replace(lost, unexplained=left), {}, "") for left in (0.034, 0.49, 0.51)),
            sentence(replace(lost, alike=alike, unexplained=0.034, evidence=()), {}, ""),
            *(wording.span(steps) for steps in ([3], [3, 4], [3, 4, 5, 9, 11, 12])),
            *(
                evidence.words_of_rows(several)
                for several in (columns[:1], columns, columns + columns[:1], 2 * columns)
            ),
        ],
    }
    assert "period" in found["of several"][4].partition("at rest")[2]  # what is right comes before what is not
    for name, texts in found.items():
        found[name] = summed(numbers_in([[texts.index(text), NUMBER.findall(text)] for text in texts]))
    assert_kept(KEPT, "sentences", found | {"of causes": summed(numbers_in(of_causes))})


def curve(scale):
    return History(np.arange(1, 6) / 10, {"displacement": -scale / 1e3 * ONES, "contact_pressure": 1e6 * scale * ONES})


ONES = np.ones(5)
SCALES = {"the file": 4.0, "dda": 5.0, "best": 6.0}
ANSWER = Answer(
    scheme={"alpha": 0.5, "delta": 1.0, "gg": 0.97},
    departure=Departure(17, "damping"),
    causes=["gg", "contact-opened"],
    opened=(3, 41),
    sentence="It departs.",
    notes=("a note",),
    told={"alpha": Interval(0.51, 0.02), "softness": Interval(-3e-17, 4e-15)},
    untold=[{"alpha": 0.7, "gg": -0.7}],
    misfit=0.0123,
    curves={name: curve(scale) for name, scale in SCALES.items()},
    evidence=STAGES,
    alike=[{"causes": ["gg", "sign"], "values": {"gg": 0.9812345}, "further_scene": "another"}],
)  # fmt: skip


def test_the_command_prints_stages_and_what_the_rows_determine():
    lines = "\n".join(cli_compare._lines(ANSWER)).splitlines()
    assert lines[0] == ANSWER.sentence
    words = [line.split() for line in lines]
    assert [line[-2] for line in words if line[-1:] == ["words"]] == ["right", "wrong", "-"]
    told = [NUMBER.findall(line) for line in lines]
    assert ["3", "41"] in told and ["0.98123"] in told  # when it was open, and what gives the same history
    assert told[-4:] == [["0.51", "0.02", "95"], ["0", "1e-12", "95"], ["+0.70", "-0.70"], []]
    assert NUMBER.findall(sentence(replace(ANSWER, causes=[], alike=[], misfit=5e-14), {}, "")) == ["1e-10"]


def test_the_page_shows_the_same_and_the_curves_in_millimetres(tmp_path, monkeypatch):
    caught = []
    monkeypatch.setattr(figures, "save", lambda figure, path: caught.append(figure))
    answer = replace(ANSWER, alike=[], nearest={"causes": ["gg"], "values": {}}, unexplained=0.25)
    blocks = chapters_compare.page(SCENE, "theirs.csv", answer, tmp_path)
    assert [b for b in blocks if isinstance(b, Callout)] == [Callout(ANSWER.sentence, "warn")]
    facts, stages = (b for b in blocks if isinstance(b, Table))
    assert [NUMBER.findall(value) for _, value in facts.rows[2:]] == [["25"], ["17"], ["3", "41"]]
    assert [line[1] for line in stages.rows] == ["right", "wrong", "–"]
    top, middle, below = caught[0].axes
    for name, scale in SCALES.items():
        color = to_hex(style_of(name).color)
        assert np.allclose(line_in(top, color)[1], -scale)
        assert np.allclose(line_in(middle, color)[1], scale)
    assert np.allclose(line_in(below, to_hex(style_of("dda").color))[1], 0.25)  # of the file's largest value
    assert any(isinstance(b, FigureBlock) for b in blocks) and Paragraph(ANSWER.notes[0], "small") in blocks


READINGS = {  # columns of a wrong reading, its causes, and what is to be typed
    "millimetres": (lambda v, p: (1e3 * v, p), ["unit"], {"--scale": "displacement=0.001"}),
    "reversed, in kPa": (lambda v, p: (v, -1e-3 * p), ["sign", "unit"], {"--scale": "contact_pressure=-1000"}),
    "swapped and reversed": (
        lambda v, p: (p, -v),
        ["swapped", "sign"],
        {"--columns": "displacement=contact_pressure,contact_pressure=displacement", "--scale": "displacement=-1"},
    ),
}


def options(remedy):
    words = remedy.split()
    return dict(zip(words[::2], words[1::2], strict=True))


def test_a_wrong_pressure_dates_the_departure_and_a_remedy_takes_the_place_of_what_was_typed(monkeypatch):
    only(monkeypatch, "pressure-factor", "pressure-shift", "gg", "load-factor")
    answer = judged(lambda v, p: (v, 0.5 * p))
    assert answer.causes == ["pressure-factor"]
    assert answer.departure.step == 1
    run = solve(SCENE, "dda")
    header = HeaderNames({"time": "t", "displacement": "p"}, {"time": 1e-3})
    answer = compare(SCENE, Foreign(run.time, run.contact_pressure, 1e3 * run.displacement, header=header))
    assert answer.causes == ["swapped", "unit"]
    assert options(answer.remedy) == {
        "--columns": "time=t,displacement=contact_pressure,contact_pressure=p",
        "--scale": "time=0.001,displacement=0.001",
    }


@pytest.mark.parametrize("name", READINGS)
def test_a_history_that_is_read_wrongly_is_told_what_to_type(name):
    change, causes, remedy = READINGS[name]
    answer = judged(change)
    assert answer.causes == causes
    assert options(answer.remedy) == remedy
    assert {slip["cause"] for slip in answer.as_dict()["slips"]} == {*causes} - {"swapped"}
    assert ("mm" in answer.sentence) == (name == "millimetres")
    assert answer.misfit < 1e-6


def test_reversed_columns_where_gravity_is_the_only_load_are_a_sign_or_its_direction():
    weighty = SCENE.with_values({"load.pressure": 0.0, "load.gravity": 9.81})
    own = solve(weighty, "dda")
    answer = compare(weighty, Foreign(own.time, -own.displacement, -own.contact_pressure))
    assert (answer.causes, answer.unexplained, answer.nearest) == (["unexplained"], 0, None)
    assert [one["values"] for one in answer.alike] == [{}, {"gravity-factor": -1.0}]
    assert answer.departure.step == 1
    # the pressure alone stays: that is a sign, not a load
    assert compare(weighty, Foreign(own.time, -own.displacement, own.contact_pressure)).causes == ["sign"]


@pytest.mark.long
def test_a_history_at_rest_under_a_scene_with_gravity_alone_lacks_the_gravity():
    weighty = SCENE.with_values({"load.pressure": 0.0, "load.gravity": 9.81})
    still = Foreign(0.002 * np.arange(1, 11), np.zeros(10), np.zeros(10))
    answer = compare(weighty, still)
    assert answer.causes == ["gravity-factor"] and answer.values == {"gravity-factor": 0.0}
    with pytest.raises(InputError) as refusal:
        compare(SCENE, still)
    assert refusal.value.field == "displacement"
