"""The chapters of rocking and toppling, from a few of their scenes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from validation.engine.run import run_study
from validation.report.blocks import FigureBlock, Heading, Table
from validation.report.chapters.opened import turning
from validation.runs.results import Results
from validation.studies.rocking import rocking, toppling


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    kept = Results(tmp_path_factory.mktemp("results"))
    for study, scenes in ((rocking.STUDY, ["rocking-pulse"]), (toppling.STUDY, ["toppling-fall", "toppling-growth"])):
        rows = tuple(row for row in study.derived() if row.scene.startswith(tuple(scenes)))
        gates = tuple(gate for gate in study.gates() if gate.scene.startswith(tuple(scenes)))
        run_study(replace(study, scenes=scenes, gates=lambda g=gates: g, derived=lambda r=rows: r), kept)
    return kept


@pytest.mark.long
def test_the_chapter_of_rocking_holds_what_the_gates_saw(results: Results, tmp_path: Path) -> None:
    blocks = turning.rocking_chapter(results, results.manifest("rocking"), tmp_path)
    assert isinstance(blocks[0], Heading) and "All 5 gates pass." in blocks[1].text
    swings, pulses = (block for block in blocks if isinstance(block, Table))
    assert not swings.rows and [row[0] for row in pulses.rows] == ["0.900", "0.990", "1.01"]
    assert [row[2] for row in pulses.rows][:2] == ["–", "–"] and float(pulses.rows[2][2]) == pytest.approx(1, abs=0.013)
    assert all(float(row[1]) == pytest.approx(1, abs=0.008) for row in pulses.rows[:2])
    (figure,) = (block for block in blocks if isinstance(block, FigureBlock))
    assert (tmp_path / figure.file).stat().st_size > 1000


@pytest.mark.long
def test_the_chapter_of_toppling_shows_the_growth_of_first_order_rotation(results: Results, tmp_path: Path) -> None:
    blocks = turning.toppling_chapter(results, results.manifest("toppling"), tmp_path)
    (table,) = (block for block in blocks if isinstance(block, Table))
    assert {row[0] for row in table.rows} == {"fall", "growth", ""}
    (grown,) = [row for row in table.rows if row[1] == "growth of the area"]
    assert float(grown[3]) <= float(grown[2]) <= float(grown[4]) and float(grown[2]) == pytest.approx(0.0051, abs=1e-4)
    assert [block.file for block in blocks if isinstance(block, FigureBlock)] == ["toppling.svg"]


def test_a_chapter_without_finished_cases_has_no_figure(tmp_path: Path) -> None:
    kept = Results(tmp_path / "results")
    run_study(replace(rocking.STUDY, scenes=[], gates=lambda: (), derived=lambda: ()), kept)
    blocks = turning.rocking_chapter(kept, kept.manifest("rocking"), tmp_path)
    assert not [block for block in blocks if isinstance(block, FigureBlock)]
