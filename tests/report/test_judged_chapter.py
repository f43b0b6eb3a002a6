"""The page of a judged answer: error and allowed in per cent, numbers beside, curves of the answer and of the truth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from oracles.made_cases import made_history

from validation.problems.bands import Band, Standard
from validation.problems.judge import Column, Judgement, Word
from validation.problems.problem import problem
from validation.problems.quantities import Quantity
from validation.report.chapters import judged as chapter

EXACT = made_history(0.1, [-1e-3, -2e-3, -3e-3], [1e6, 2e6, 3e6])
ANSWER = made_history(0.1, [-1e-3, -1e-3, -2e-3, 9.0], [1e6, 1e6, 1e6, 9.0])  # one row longer


def judged() -> chapter.JudgedAnswer:
    columns = (
        Column("displacement", Word.FAIL, 0.125, 0.05, 0.3, "", 0.1),
        Column("contact_pressure", Word.PASS, 0.0125, 0.025, 0.2, "", 0.2),
        Column("rotation", Word.NOT_JUDGED, None, None, 0.3, "it is zero throughout"),
    )
    found = Judgement("locked", columns, (Quantity("first peak", "mm", 2.0, 3.0),))
    bands: Any = {name: Band(0.05, datum, 3, 0.3) for name, datum in
                  (("displacement", "block.young"), ("contact_pressure", "load.pressure"))}  # fmt: skip
    held = Standard(EXACT, {}, bands)
    return chapter.JudgedAnswer(problem("locked"), ANSWER, held, found, None, (("program", "mine"),))


def test_each_column_has_its_error_and_what_is_allowed_in_per_cent(kept: Any, drawn: Any, tmp_path: Path) -> None:
    kept("judged", chapter.page(judged(), tmp_path))


def test_the_caption_tells_of_a_difference_where_one_is_drawn(drawn: dict[str, Figure], tmp_path: Path) -> None:
    apart = chapter.figures(judged(), tmp_path)
    same = chapter.figures(replace(judged(), history=EXACT), tmp_path / "same")
    for blocks, words in ((apart, "and their difference over its largest value"), (same, "lies on the exact motion")):
        assert all(words in block.caption for block in blocks)
    assert len(drawn["judged-displacement.svg"].axes) == 2
