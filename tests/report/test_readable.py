"""The report has as many pages as it may."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import beside
from faults.kill_matrix import as_gates_run
from pypdf import PdfReader

from validation.engine.run import StudyCases, judge_study, run_cases
from validation.report.book import build, ordered_studies
from validation.suite.folders import get_study, judged_studies

pytestmark = pytest.mark.long  # runs small studies; numbers of rows made by hand are read in the short tests

ROOT = Path(__file__).parents[2]
# pages: each decision has one of its own, each of three blocks one with its error against run time; five of the whole
# are those of `methods`; the long study `stability` is not run here
SHORT = 17
WHOLE = 60  # 48, and two for each of the six chapters of blocks in the plane beside `pushing`


def words(text):
    """Return a text with single spaces, words that were broken at a line's end whole."""
    return re.sub(r"\s+", " ", re.sub(r"-\n", "", text))


@pytest.fixture(autouse=True)
def coarse_curves(monkeypatch):
    monkeypatch.setattr("validation.advice.budget.POINTS", 13)  # of a curve that is drawn


def made(studies, finished_cases, directory):
    """Return the report of studies whose rows hold what gates ask for: a run serves both."""
    results = beside(finished_cases, directory / "results")
    for name in studies:
        study = replace(get_study(name), timed=False)
        cases = StudyCases(study, [(case, case.key()) for case in as_gates_run(study, study.cases())])
        for ended in run_cases([cases], results):
            judge_study(ended, results)
        assert not [alarm for alarm in results.manifest(name)["alarms"] if alarm["kind"] == "not examined"]
    assert sorted(ordered_studies(results)) == sorted(studies)
    read = PdfReader(build(results, directory / "report.pdf"))
    assert "cannot be drawn" not in words(" ".join(page.extract_text() for page in read.pages))
    return read


def reported():
    """Return the studies that `make report` runs."""
    line = re.search(r"run (core [\w -]+);", (ROOT / "Makefile").read_text(encoding="utf-8"))
    return line[1].split()


def test_make_report_has_at_most_seventeen_pages(tmp_path, finished_cases):
    read = made(reported(), finished_cases, tmp_path)
    assert len(read.pages) <= SHORT
    outline = words(" ".join(page.extract_text() for page in read.pages))
    assert "gates: " in outline and "Provenance" in outline


@pytest.mark.fenicsx  # without it a page lists the gates that were not run
def test_everything_has_at_most_two_pages_a_chapter(tmp_path, finished_cases):
    assert len(made(judged_studies(), finished_cases, tmp_path).pages) <= WHOLE
