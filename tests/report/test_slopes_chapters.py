"""The chapters of blocks that slide and that creep, from small runs of their own scenes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from validation.engine.run import run_study
from validation.report.blocks import FigureBlock, Heading, Table
from validation.report.chapters.slopes import creeping
from validation.report.chapters.slopes import sliding as sliding_chapter
from validation.runs.results import Results
from validation.scenes.scene import load_scene
from validation.studies.slopes import creep, sliding

SLIDES = {
    sliding.SLIDING: {"mode": "zip", "time.step": [0.01], "time.steps": [100]},
    sliding.DRAG: {"mode": "zip", "time.gg": [0.98], "time.step": [0.01], "time.steps": [100]},
    sliding.THRESHOLD: {"load.slope": [30.01]},
}
CREEPS = {
    creep.STEPS: {"mode": "zip", "time.step": [0.002, 0.002], "time.steps": [500, 500], "time.delta": [1.0, 0.5],
                  "time.alpha": [0.5, 0.25], "time.start": ["zero", "consistent"], "time.gg": [1.0, 1.0]},
    creep.LAGGED: {"time.step": [0.01]},
    creep.STIFFNESS: {"contact.stiffness": [4e9], "contact.shear_stiffness": [1.6e9], "time.step": [5e-5]},
    creep.DAMPED: {"contact.stiffness": [4e9], "contact.shear_stiffness": [1.6e9], "time.step": [5e-4]},
}  # fmt: skip


def results(study: sliding.Study, sweeps: dict[str, dict[str, object]], directory: Path) -> Results:
    kept = Results(directory)
    scenes = [load_scene(name).model_copy(update={"sweep": sweep}) for name, sweep in sweeps.items()]
    run_study(replace(study, scenes=scenes, solvers=("dda",), gates=lambda: (), derived=lambda: ()), kept)
    return kept


@pytest.mark.long
def test_the_chapter_of_sliding_lays_runs_beside_closed_forms(tmp_path: Path, drawn: dict[str, Figure]) -> None:
    kept = results(sliding.STUDY, SLIDES, tmp_path / "kept")
    blocks = sliding_chapter.chapter(kept, kept.manifest("slopes"), tmp_path)
    headings = [block.text for block in blocks if isinstance(block, Heading)]
    assert headings[1:] == ["Run-out", "Where sliding begins"]
    (figure,) = [block for block in blocks if isinstance(block, FigureBlock)]
    assert [figure.file] == [*drawn]
    ways, starts = [block for block in blocks if isinstance(block, Table)]
    assert [row[6:9] for row in ways.rows] == [("1.21989", "1.21990", "18.64"), ("0.689215", "0.689234", "18.64")]
    assert starts.rows[0][2] == starts.rows[0][3] == "0.0019770"
    assert sliding_chapter.drag_share(1e-4) == pytest.approx(1, abs=1e-4)
    assert sliding_chapter.drag_share(20.0) == pytest.approx(2 * (20 - 1) / 400, rel=1e-6)


@pytest.mark.long
def test_the_chapter_of_creep_lays_rules_and_schemes_beside_a_program(tmp_path: Path, drawn: dict[str, Figure]) -> None:
    kept = results(creep.STUDY, CREEPS, tmp_path / "kept")
    blocks = creeping.chapter(kept, kept.manifest("creep"), tmp_path)
    (figure,) = [block for block in blocks if isinstance(block, FigureBlock)]
    assert [figure.file] == [*drawn]
    table, stiffness = [block for block in blocks if isinstance(block, Table)]
    assert stiffness.rows == (("4.00", "11.4", "–", "10.7", "0.142", "–"),)
    cells = {row[0]: row[1:] for row in table.rows}
    assert cells["10.0"] == ("–", "–", "1.01", "1.00")
    assert cells["2.00"][0] == "0.142"
    assert float(cells["2.00"][1]) > 10 * float(cells["2.00"][0])
