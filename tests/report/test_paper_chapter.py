"""The chapter of the paper: every figure drawn, from a results directory alone."""

import json
from pathlib import Path

import pytest
from conftest import beside
from matplotlib.figure import Figure

from validation.engine.run import run_study
from validation.report.appendix.alarms import alarm_table
from validation.report.blocks import FigureBlock, Table
from validation.report.chapters.paper import claims_table, conclusion
from validation.report.chapters.registry import chapter_of
from validation.report.front.groups import groups_of_studies
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies import Study
from validation.studies.catalogue import scene_study
from validation.studies.paper.study import PAPER

pytestmark = pytest.mark.xdist_group("paper-chapter")


UNDRAWN = ("poisson-statics", "open-close")  # scenes of claims alone


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """The study with shorter histories and without the slow solvers."""
    kept = Results(tmp_path_factory.mktemp("results"))
    scenes = [load_scene(s) if isinstance(s, str) else s for s in PAPER.scenes if s not in UNDRAWN]
    short = [s.with_values({"time.steps": min(s.time.steps, 120)}) for s in scenes]
    study = Study("paper", PAPER.title, PAPER.purpose, short, ("dda", "bar"), data=PAPER.data)
    run_study(study, kept)
    return kept


@pytest.mark.long
def test_a_part_of_the_scenes_gives_its_figures(results: Results, tmp_path: Path) -> None:
    manifest = results.manifest("paper")
    manifest["cases"] = [case for case in manifest["cases"] if case["scene"].startswith("figure-9")]
    blocks = chapter_of("paper")(results, manifest, tmp_path)
    files = [block.file for block in blocks if isinstance(block, FigureBlock)]
    assert files == ["figure-1.svg", "figure-9.svg"]
    assert all((tmp_path / file).stat().st_size > 2000 for file in files)


def test_the_register_lists_every_claim() -> None:
    claims = json.loads(json.dumps(dict(PAPER.data())))["claims"]  # as a manifest holds them
    table = claims_table(claims, {"C1": {"verdict": 2.0, "left": 0.001}, "C6": {"verdict": 1.0}})
    rows = {row[0]: row for row in table.rows}
    assert {f"C{i}" for i in range(1, 23)} | {"S13", "S16", "S20", "S21", "S29", "S32"} == set(rows)
    assert rows["C1"][1] == "confirmed" and rows["C1"][4] == "left 0.001"
    assert rows["C6"][1] == "under a condition" and "Condition: mode by mode" in rows["C6"][3]
    assert rows["C2"][1] == "not tested"
    assert "1 is confirmed, 1 holds under a condition" in conclusion({"C1": {"verdict": 2.0}, "C6": {"verdict": 1.0}})


@pytest.mark.long
def test_the_page_of_a_scene_has_one_figure_and_the_appendix_its_alarms(
    tmp_path: Path, finished_cases: Path, drawn: dict[str, Figure]
) -> None:
    scene = load_scene("figures-5-6")
    study = scene_study("figures-5-6")
    kept = beside(finished_cases, tmp_path / "results")
    run_study(Study(study.name, study.title, study.purpose, [scene], ("dda", "bar", "continuum")), kept)
    blocks = chapter_of("figures-5-6")(kept, kept.manifest("figures-5-6"), tmp_path)
    assert len([block for block in blocks if isinstance(block, FigureBlock)]) == len(drawn) == 1
    _, table = alarm_table(groups_of_studies(kept, ["figures-5-6"]))
    assert isinstance(table, Table)
    assert {row[0] for row in table.rows} == {"agreement by damping", "hidden tension", "contact ringing"}
