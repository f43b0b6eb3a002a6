"""The page of an answer to a problem of rigid boxes: the verdict on its numbers, and its positions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from validation.problems.boxes import MeasuredQuantity
from validation.problems.data import united
from validation.problems.judge import Word
from validation.problems.questions import BoxQuestion
from validation.report.blocks import Blocks, Callout, FigureBlock, Paragraph, Table, TableColumn, table
from validation.report.chapters.judged import ANSWER
from validation.report.figures.curves import HistoryPanel
from validation.runs.columns import unit_of
from validation.runs.history import History
from validation.runs.numbers import DASH, bounded, short
from validation.scenes.rigid import POSE

ROUNDING = 1e-9  # of a band
STILL = 1e-9  # m or rad: a position that changes by less does not move
DIGITS = 4  # of a number on a page


@dataclass(frozen=True, eq=False)
class JudgedBoxes:
    """An answer to a problem of rigid boxes with its verdict."""

    question: BoxQuestion
    history: History
    numbers: tuple[MeasuredQuantity, ...]

    @property
    def word(self) -> Word:
        """FAIL where one of its numbers is outside its band."""
        return Word.FAIL if any(number.word == "FAIL" for number in self.numbers) else Word.PASS

    @property
    def deciding(self) -> MeasuredQuantity:
        """The number whose error is largest beside its band."""
        return max(self.numbers, key=_beside)


def _beside(number: MeasuredQuantity) -> float:
    """Return the error over the band; what is rounding is nothing, so that it decides nothing."""
    if number.beside is None:
        return math.inf
    return number.beside if number.beside > ROUNDING else 0.0


def headline_of_boxes(answer: JudgedBoxes) -> str:
    """Return the verdict and the number it rests on, in a sentence."""
    number = answer.deciding
    quantity = number.quantity
    value = "cannot be measured" if number.value is None else f"is {_with_unit(number.value, quantity.unit)}"
    low, high = (short(edge, DIGITS) for edge in (quantity.low, quantity.high))
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    return f"{answer.word}: {quantity.name} {value}, where {low} to {high}{unit} is allowed."


def _with_unit(value: float, unit: str) -> str:
    text = bounded(value, short(value, DIGITS))
    return text if unit == "1" else f"{text} {unit}"


def page_of_boxes(answer: JudgedBoxes, directory: Path) -> Blocks:
    """Return the blocks of the page; its figures are written to a directory."""
    tone = "pass" if answer.word is Word.PASS else "fail"
    return [
        Callout(headline_of_boxes(answer), tone),  # type: ignore[arg-type]
        Paragraph(f"The question: {answer.question.asks} {answer.question.title}."),
        _numbers(answer.numbers),
        *_figures(answer, directory),
    ]


def _numbers(numbers: Sequence[MeasuredQuantity]) -> Table:
    rows = []
    for number in numbers:
        quantity = number.quantity
        value = DASH if number.value is None else _with_unit(number.value, "1")
        edges = (short(edge, DIGITS) for edge in (quantity.exact, quantity.low, quantity.high))
        rows.append((quantity.name, number.word, value, *edges, quantity.unit))
    notes = tuple(dict.fromkeys(f"{number.quantity.name}: {number.quantity.reason}." for number in numbers))
    columns = (
        TableColumn("Number", "fill"),
        TableColumn("Verdict", "outcome"),
        "Answer",
        "Exact",
        "From",
        "To",
        "Unit",
    )
    return table(columns, rows, "Numbers measured on the positions.", notes)


def _figures(answer: JudgedBoxes, directory: Path) -> Sequence[FigureBlock]:
    """Draw the positions of the uppermost box, those that change."""
    from validation.report.figures import histories, motion  # which load matplotlib; a verdict alone needs none

    top = len(answer.question.columns) // len(POSE)
    drawn = []
    for part in POSE:
        name = f"{part}_{top}"
        if np.ptp(answer.history.columns[name]) < STILL:
            continue
        lines = {ANSWER: History(answer.history.time, {name: answer.history.columns[name]})}
        figure = motion.history_figure([HistoryPanel(f"{name} [{unit_of(name)}]", lines, {}, ANSWER)], name)
        drawn.append(histories.saved(figure, directory, f"judged-{name}.svg", f"The answer: {united(name)}."))
    return drawn


def data_of_boxes(answer: JudgedBoxes) -> dict[str, Any]:
    """Return a judgement as plain data."""
    numbers = []
    for number in answer.numbers:
        error, allowed = number.shares
        quantity = number.quantity
        numbers.append(
            {
                "number": quantity.name,
                "unit": quantity.unit,
                "verdict": number.word,
                "value": number.value,
                "exact": quantity.exact,
                "low": quantity.low,
                "high": quantity.high,
                "error": error,
                "allowed": allowed,
                "share_of": quantity.of,
                "reason": quantity.reason,
            }
        )
    return {"verdict": str(answer.word), "numbers": numbers}
