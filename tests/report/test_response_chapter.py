"""The chapter of the study `response`, from a run and from a run without its rows."""

from dataclasses import replace
from pathlib import Path

import pytest

from validation.engine.run import run_study
from validation.report.blocks import Block, FigureBlock, Heading, Paragraph, Table
from validation.report.chapters.registry import chapter_of
from validation.runs.results import Results
from validation.studies.waves.response import STUDY


def told(results: Results, directory: Path) -> list[Block]:
    """Return the chapter of what has run."""
    return chapter_of("response")(results, results.whole("response"), directory)


@pytest.mark.long
def test_the_page_says_what_the_step_takes(tmp_path: Path) -> None:
    results = Results(tmp_path / "results")
    run_study(STUDY, results)
    blocks = told(results, tmp_path)
    assert [type(block) for block in blocks] == [Heading, Paragraph, Paragraph, FigureBlock, Table, Paragraph]
    texts = [block.text for block in blocks if isinstance(block, Paragraph)]
    assert "31.4 mm instead of 100.6 mm: at dt = 2 ms the step has removed 68.7\u00a0% of the resonance" in texts[0]
    assert texts[1].endswith(f"All {len(STUDY.gates())} gates pass.")
    assert "7.85\u00a0% at 5 Hz, 15.6\u00a0% at 10 Hz, 30.9\u00a0% at 20 Hz" in texts[2]
    (table,) = (block for block in blocks if isinstance(block, Table))
    assert len(table.rows) == 12
    assert table.rows[5][1:] == ("52", "31.4419", "32.5484", "32.4739", "19.5663", "17.8915", "17.8527")
    assert (tmp_path / "response.svg").stat().st_size > 10_000


def test_without_rows_there_is_no_table(tmp_path: Path) -> None:
    results = Results(tmp_path / "results")
    run_study(replace(STUDY, scenes=STUDY.scenes[:1], solvers=("dda",), gates=tuple, derived=tuple, data=dict), results)
    assert [type(block) for block in told(results, tmp_path)] == [Heading, Paragraph]
