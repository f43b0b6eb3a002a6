"""The page of a judged answer: error and allowed in per cent, numbers beside, curves of the answer and of the truth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from oracles.made_cases import line_in, made_history

from validation.gates.gate import Status
from validation.problems.answers import Answer
from validation.problems.bands import Standard
from validation.problems.judge import Criterion, Judgement
from validation.problems.problem import problem
from validation.problems.quantities import Quantity
from validation.report.chapters import judged as chapter
from validation.report.figures.curves import style_of
from validation.suite.judging import JudgedAnswer

EXACT = made_history(0.1, [-1e-3, -2e-3, -3e-3], [1e6, 2e6, 3e6])
ANSWER = made_history(0.1, [-1e-3, -1e-3, -2e-3, 9.0], [1e6, 1e6, 1e6, 9.0])  # one row longer


def judged() -> JudgedAnswer:
    criteria = (
        Criterion("displacement", Status.FAIL, 0.125, 0.05, 0.3, "", 0.1, "block.young"),
        Criterion("contact_pressure", Status.PASS, 0.0125, 0.025, 0.2, "", 0.2, "load.pressure"),
        Criterion("rotation", Status.NOT_JUDGED, None, None, 0.3, "it is zero throughout"),
    )
    found = Judgement("locked", criteria, (Quantity("first peak", "mm", 2.0, 3.0),))
    one = problem("locked")
    return JudgedAnswer(Answer("locked", one, ANSWER), one, ANSWER, Standard(EXACT, {}, {}), found, None)


def test_each_column_has_its_error_and_what_is_allowed_in_per_cent(kept: Any, drawn: Any, tmp_path: Path) -> None:
    kept("judged", chapter.page(judged(), tmp_path))


def test_the_caption_tells_of_a_difference_where_one_is_drawn(drawn: dict[str, Figure], tmp_path: Path) -> None:
    apart = chapter.figures(judged(), tmp_path)
    same = chapter.figures(replace(judged(), history=EXACT), tmp_path / "same")
    for blocks, words in ((apart, "and their difference over its largest value"), (same, "lies on the exact motion")):
        assert all(words in block.caption for block in blocks)
    assert len(drawn["judged-displacement.svg"].axes) == 2


def test_the_curves_are_those_of_the_answer_beside_the_exact_ones(drawn: dict[str, Figure], tmp_path: Path) -> None:
    chapter.figures(judged(), tmp_path)
    assert [*drawn] == ["judged-displacement.svg", "judged-contact_pressure.svg"]
    for file, values, exact in zip(drawn, ([-1, -1, -2], [1, 1, 1]), ([-1, -2, -3], [1, 2, 3]), strict=True):
        axes = drawn[file].axes[0]
        for name, wanted in (("answer", values), ("exact", exact)):
            x, y = line_in(axes, to_hex(style_of(name).color))
            assert np.allclose(x, [0.1, 0.2, 0.3]) and np.allclose(y, wanted), (file, name)  # mm, MPa
