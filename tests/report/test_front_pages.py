"""The pages that are read first: every number in sentence, table and chart, from closed forms or from made rows."""

import numpy as np
import pytest
from oracles.made_cases import kept_study, line_in, lines_of, made_case, made_group, made_row, rules_of

from validation.report.blocks import Table
from validation.report.chapters.gates import verdict_line
from validation.report.figures.curves import GREY, style_of
from validation.report.figures.model import model_figure
from validation.report.front import OVERVIEW_SCENES, front_chapter, front_pages
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies.core import decisions

PAPER = load_scene("figures-3-4").with_values({"time.step": 0.002, "time.steps": 100})


@pytest.mark.parametrize(
    ("at_rest", "least", "words"),
    [(5e6, 1e5, ("right", "none")), (5.004e6, -1e-3, ("right", "none")), (4.9e6, -2e5, ("wrong", -2e5))],
)
def test_a_first_peak_is_told_with_pressure_at_rest_and_tension(at_rest, least, words):
    dda = made_row("dda", {"pressure.static": at_rest, "pressure.minimum": least, "pressure.peak": 8.4e6})
    row = decisions.first_peak(PAPER, dda, made_row("bar", {"pressure.peak": 8e6}))
    told = row["at rest"], row["tension"]
    assert row["excess"] == pytest.approx(0.05) and told == words


# ---- the pages ------------------------------------------------------------------------------------------------------


def test_the_first_pages_say_what_was_found(kept, core_results, drawn, tmp_path):
    front = front_chapter(core_results, ["core"], tmp_path)
    kept("front", front_pages(front, {}, [])[1:])
    damping, error = drawn["first.svg"].axes
    x, y = max((line[1:] for line in lines_of(damping)), key=lambda line: line[0].size)
    assert np.interp(2.0, x, y) == pytest.approx(16.02, abs=0.02)
    assert rules_of(damping, GREY)[1] == [10.0, 2.0, 1.0]
    assert list(line_in(error, style_of("dda").color)[1]) == pytest.approx([64, 9, 3.6, 0.8])
    (chart,) = drawn["decision-step.svg"].axes
    assert "a/c = 3.29 ms" in [text.get_text() for text in chart.texts]


def test_results_of_other_studies_have_no_such_pages(tmp_path):
    results = Results(tmp_path)
    kept_study(results, [(PAPER, made_row("dda", {}, PAPER.name), None)])
    assert front_chapter(results, ["made"], tmp_path) is None


@pytest.mark.parametrize(
    ("words", "said", "tone"),
    [
        (["PASS", "PASS"], "2 gates: 2 passed, 0 failed, 0 not run.", "pass"),
        (["PASS", "NOT RUN"], "2 gates: 1 passed, 0 failed, 1 not run.", "warn"),
        (["FAIL", "NOT RUN", "PASS"], "3 gates: 1 passed, 1 failed, 1 not run.", "fail"),
        ([], "No gate was judged.", "warn"),
    ],
)
def test_one_line_of_verdicts(words, said, tone):
    callout = verdict_line([{"verdict": word} for word in words])
    assert (callout.text, callout.tone) == (said, tone)


@pytest.mark.parametrize("beyond", [0, 1])
def test_scenes_are_listed_as_long_as_a_page_has_lines_for_them(beyond):
    group = made_group(made_case(PAPER, {"dda": {}}))
    blocks = front_pages(None, {f"scene-{number}": group for number in range(OVERVIEW_SCENES + beyond)}, [])
    assert [isinstance(block, Table) for block in blocks].count(True) == 1 - beyond


def test_the_model_is_drawn_with_its_words(kept_figures):
    kept_figures("figures-model", {"model.svg": model_figure("a = 2 m", "q = 5 MPa")})
