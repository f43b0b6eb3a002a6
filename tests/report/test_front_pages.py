"""The pages that are read first: every number in sentence, table and chart, from closed forms or from made rows."""

import numpy as np
import pytest
from oracles.made_cases import lines_of, made_row

from validation.report.chapters.gates import not_passed, verdict_line
from validation.report.front import front_chapter, front_pages
from validation.scenes.scene import load_scene
from validation.studies.core import decisions


@pytest.mark.parametrize(
    ("at_rest", "least", "words"),
    [(5e6, 1e5, ("right", "none")), (5.004e6, -1e-3, ("right", "none")), (4.9e6, -2e5, ("wrong", -2e5))],
)
def test_a_first_peak_is_told_with_pressure_at_rest_and_tension(at_rest, least, words):
    dda = made_row("dda", {"pressure.static": at_rest, "pressure.minimum": least, "pressure.peak": 8.4e6})
    row = decisions.first_peak(load_scene("figures-3-4"), dda, made_row("bar", {"pressure.peak": 8e6}))
    told = row["at rest"], row["tension"]
    assert row["excess"] == pytest.approx(0.05) and told == words


# ---- the pages ------------------------------------------------------------------------------------------------------


def test_the_first_pages_say_what_was_found(kept, kept_figures, core_results, drawn, tmp_path):
    front = front_chapter(core_results, ["core"], tmp_path)
    kept("front", front_pages(front, {}, [])[1:])
    kept_figures("figures-front", drawn)
    failed = core_results.verdicts()[:1]
    failed[0] |= {"verdict": "FAIL"}
    assert len(front_pages(front, {}, failed)) - len(front_pages(front, {}, [])) == 1 + len(not_passed(failed))
    assert [not_passed(failed * many)[1].text.split()[0] for many in (1, 2)] == ["One", "2"]
    damping, _ = drawn["first.svg"].axes
    x, y = max((line[1:] for line in lines_of(damping)), key=lambda line: line[0].size)
    assert np.interp(2.0, x, y) == pytest.approx(16.02, abs=0.02)


def test_one_line_of_verdicts():
    told = [verdict_line([{"verdict": word} for word in ("PASS", last)]) for last in ("PASS", "NOT RUN")]
    said = [f"2 gates: {2 - n} passed, 0 failed, {n} not run." for n in (0, 1)]
    assert [(callout.text, callout.tone) for callout in told] == [*zip(said, ("pass", "warn"), strict=True)]
