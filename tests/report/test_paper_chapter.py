"""The register of the paper's claims, and the page of a scene with its alarms."""

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
from validation.scenes.scene import load_scene
from validation.studies import Study
from validation.studies.catalogue import scene_study
from validation.studies.paper.study import PAPER


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
