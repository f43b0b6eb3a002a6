"""Read as a reader does: five questions are answered on the first three pages, and the report has as many as it may."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import beside
from pypdf import PdfReader

from validation.engine.run import run_study
from validation.report.book import build, ordered_studies
from validation.report.chapters.data import groups_of_studies
from validation.report.figures import histories
from validation.report.front import front_chapter, front_pages
from validation.report.render.pdf import write_document
from validation.runs.case_name import scene_of
from validation.suite.folders import get_study, judged_studies

pytestmark = pytest.mark.long  # runs small studies; numbers of rows made by hand are read in the short tests

ROOT = Path(__file__).parents[2]
# pages: each decision has one of its own, each of three blocks one with its error against run time; five of the whole
# are those of `methods`; the long study `stability` is not run here
SHORT = 17
WHOLE = 60  # 48, and two for each of the six chapters of blocks in the plane beside `pushing`
SCENES = ("figures-3-4", "figures-5-6", "model-form", "figure-9")
ANSWERS = {  # question -> what is read on which page
    "which dt for 5 % damping": {1: "for 5 % take dt = 0.584 ms", 2: "for 5 % at p = 1E, dt = 0.584 ms"},
    "what happens at p = 100E": {
        1: "the contact rings: it flips sign each step",
        3: "At p = 100E they deflect by 0.05 mm",
    },
    "is DDA's force right": {1: "At rest yes: every run tends to 5 MPa; during the motion no"},
    "what does gg = 0.98 do": {1: "removes 2 % of the velocity in each", 4: "gg = 0.98 per step is 1.52 % at 2 ms"},
    "what must I not believe": {1: "What should I not trust? The agreement at a long step: 0.813 % at 10 ms"},
}


def words(text):
    """Return a text with single spaces, words that were broken at a line's end whole."""
    return re.sub(r"\s+", " ", re.sub(r"-\n", "", text))


def blank(figure, path):
    """Write an empty figure of the same size: no page that is read depends on what a figure shows."""
    width, height = 72 * figure.get_size_inches()
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}pt" height="{height:g}pt"/>')
    return path


@pytest.fixture(scope="module")
def pages(tmp_path_factory, finished_cases):
    """The first pages of a report on the scenes that they speak of, without the slow solvers."""
    directory = tmp_path_factory.mktemp("read")
    results = beside(finished_cases, directory / "results")
    core = get_study("core")
    rows = tuple(row for row in core.derived() if scene_of(row.scene) in SCENES and row.name != "damping")
    solvers = ("dda", "bar", "continuum")
    gates = tuple(
        gate for gate in core.gates() if scene_of(gate.scene) == "model-form" and gate.metric == "pressure.l2"
    )
    part = replace(core, scenes=SCENES, solvers=solvers, extra=(), gates=lambda: gates, derived=lambda: rows)
    run_study(part, results)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(histories, "save", blank)
        groups = groups_of_studies(results, [results.manifest("core")], drawn=False)
        out = write_document(
            directory / "r.pdf",
            lambda root: front_pages(front_chapter(results, ["core"], root), groups, results.verdicts()),
        )
    return [words(page.extract_text()) for page in PdfReader(out).pages]


@pytest.mark.parametrize("question", ANSWERS)
def test_a_question_is_answered_on_the_first_pages(question, pages):
    assert len(pages) == 4
    for number, answer in ANSWERS[question].items():
        assert answer in pages[number - 1]


def test_the_first_page_has_the_model_five_sentences_and_one_line_of_verdicts(pages):
    first = pages[0]
    assert "What was tested" in first and " gates: " in first
    assert all(f"{number}. " in first for number in range(1, 6)) and "6. " not in first
    assert [sorted(set(re.findall(r"Decision (\d)", page))) for page in pages] == [[], ["1"], ["2"], ["3"]]


def made(studies, finished_cases, directory):
    results = beside(finished_cases, directory / "results")
    for name in studies:
        run_study(get_study(name), results)
    assert sorted(ordered_studies(results)) == sorted(studies)
    return PdfReader(build(results, directory / "report.pdf"))


def reported():
    """Return the studies that `make report` runs."""
    line = re.search(r"run (core [\w -]+);", (ROOT / "Makefile").read_text(encoding="utf-8"))
    return line[1].split()


def test_make_report_has_at_most_seventeen_pages(tmp_path, finished_cases):
    read = made(reported(), finished_cases, tmp_path)
    assert len(read.pages) <= SHORT
    outline = words(" ".join(page.extract_text() for page in read.pages))
    assert "gates: " in outline and "Twelve words" in outline and "Provenance" in outline


@pytest.mark.fenicsx  # without it a page lists the gates that were not run
def test_everything_has_at_most_two_pages_a_chapter(tmp_path, finished_cases):
    assert len(made(judged_studies(), finished_cases, tmp_path).pages) <= WHOLE
