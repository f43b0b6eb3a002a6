"""The chapters of contact that opens, from small runs of their own scenes."""

from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from validation.engine.run import run_study
from validation.report.blocks import FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.opened import impacts as impacts_chapter
from validation.report.chapters.opened import rebound as rebound_chapter
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies.contact import impacts, rebound

pytestmark = pytest.mark.long  # runs small studies; numbers of rows made by hand are read in the short tests

SWEEPS = {
    "rebound-constant": {"contact.stiffness": [2.16e10], "contact.gap": [0.0025]},
    "rebound-average": {"contact.stiffness": [5.4e11], "contact.gap": [0.0021, 0.0025]},
    "contact-map-constant": {"contact.stiffness": [1e11], "time.step": [1e-3], "time.steps": [60]},
    "contact-map-average": {"contact.stiffness": [1e11], "time.step": [1e-3], "time.steps": [60]},
}


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    kept = Results(tmp_path_factory.mktemp("results"))
    scenes = [load_scene(name).model_copy(update={"sweep": sweep}) for name, sweep in SWEEPS.items()]
    last = scenes[2].expand()[0].name
    small = replace(rebound.STUDY, scenes=scenes, extra=((last, "block-events"),), gates=lambda: (), derived=lambda: ())
    run_study(small, kept)
    run_study(replace(impacts.STUDY, scenes=["bouncing-mass"], gates=lambda: (), derived=lambda: ()), kept)
    return kept


def test_the_chapter_of_rebound_tells_restitution_and_energy(
    results: Results, tmp_path: Path, drawn: dict[str, Figure]
) -> None:
    blocks = rebound_chapter.chapter(results, results.manifest("rebound"), tmp_path)
    headings = [block.text for block in blocks if isinstance(block, Heading)]
    assert headings[1:] == ["What a landing returns", "Energy, switches and solves"]
    said = next(block.text for block in blocks if isinstance(block, Paragraph) and block.tone == "lead")
    assert said.startswith("Constant acceleration (1/2, 1) gains no energy and needs at most 2 solves a step; average")
    assert "gains up to" in said
    files = [block.file for block in blocks if isinstance(block, FigureBlock)]
    assert files == [*drawn] == ["rebound-restitution.svg", "rebound-maps.svg"]
    (table,) = [block for block in blocks if isinstance(block, Table)]
    assert [row[:3] for row in table.rows] == [("constant", "100E", "1"), ("average", "100E", "1")]
    case = {row[0]: row for row in table.rows}
    found = results.manifest("rebound")["cases"]
    rows = {c["scene"]: results.rows()[c["key"]] for c in found if c["solver"] == "dda"}
    peak = next(row.metrics["contact.peak_force"] for name, row in rows.items() if name.startswith("contact-map-const"))
    assert case["constant"][5] == f"{peak / 1e6:#.3g}"


def test_circles_stand_where_the_impacts_were(results: Results) -> None:
    from validation.report.chapters.data import case_groups

    found = {group.name: group for group in case_groups(results, results.manifest("rebound"))}
    ((omega, e),) = rebound_chapter.impact_dots(found["rebound-constant"])
    assert (omega, e) == pytest.approx((2.0, 1 / 3), rel=1e-6)
    exact = rebound_chapter.exact_switches([found["contact-map-constant"]])
    assert list(exact) == [100.0] and exact[100.0] > 50


def test_the_chapter_of_impacts_marks_what_is_exact(results: Results, tmp_path: Path) -> None:
    blocks = impacts_chapter.chapter(results, results.manifest("impacts"), tmp_path)
    (table,) = [block for block in blocks if isinstance(block, Table)]
    rows = {row[1]: row for row in table.rows}
    assert rows["block-events (exact)"][2:4] == ("540.31", "885.46") and rows["dda"][2] == "541.00"
    assert rows["block-events (exact)"][7] == "748.07"  # mm
