"""The page of `judge`: the verdict on an answer, the curves, what the answer says of itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from validation.problems.bands import Standard
from validation.problems.data import PACK, united
from validation.problems.judge import Column, Judgement, Word
from validation.problems.problem import Problem
from validation.problems.quantities import COUNTED, Quantity
from validation.report.blocks import Blocks, Callout, FigureBlock, Paragraph, Table, TableColumn, table
from validation.report.figures.curves import EXACT, HistoryPanel
from validation.runs.history import History
from validation.runs.numbers import DASH, bounded, error_percent, plain, short

if TYPE_CHECKING:
    from validation.problems.cause import Cause

ANSWER = "answer"
ALLOWED = (
    "Allowed is what one per cent of the datum that is named changes in the exact motion: data of a block are not "
    "known to better than one per cent, and an error below that changes nothing for its user."
)


@dataclass(frozen=True, eq=False)
class JudgedAnswer:
    """An answer with its verdict and all that the page holds of it."""

    problem: Problem
    history: History
    standard: Standard
    judgement: Judgement
    cause: Cause | None  # of a failure
    about: tuple[tuple[str, str], ...]  # what the answer says of itself: field and text
    warnings: tuple[str, ...] = ()  # what makes the verdict worth less, in sentences


def headline(answer: JudgedAnswer) -> str:
    """Return the verdict and what it rests on, in a sentence."""
    judgement = answer.judgement
    column = judgement.deciding
    if column is None or column.band is None:
        return f"{judgement.verdict}: no column of it is judged."
    at_most = "at most " if judgement.word in (Word.PASS, Word.PARTIAL) else ""
    return (
        f"{judgement.verdict}: it is {at_most}{error_percent(column.error)} off in {united(column.name)}, where "
        f"{error_percent(column.band)} is allowed."
    )


def reached(answer: JudgedAnswer) -> str:
    """Return how far an answer that fails is right, in a sentence."""
    within = answer.judgement.within
    if not within:
        return "Its error is more than what is allowed from the first step on."
    until = max(column.until for column in answer.judgement.columns)
    return f"Its error is within what is allowed up to {short(within)} s of {short(until)} s."


def as_data(judged: JudgedAnswer, program: str) -> dict[str, Any]:
    """Return a judgement as plain data."""
    columns = [
        {
            "column": united(column.name),
            "verdict": str(column.word),
            "error": column.error if column.error is None or column.error < float("inf") else "inf",
            "allowed": column.band,
            "until_s": column.until,
            "within_until_s": column.within,
            "reason": column.reason,
        }
        for column in judged.judgement.columns
    ]
    why = judged.cause
    return {
        "pack": PACK,
        "problem": judged.problem.name,
        "program": program,
        "verdict": str(judged.judgement.word),
        "not_reported": [united(name) for name in judged.judgement.withheld],
        "cause": None if why is None else _cause_data(why),
        "columns": columns,
        "warnings": list(judged.warnings),
        "about": dict(judged.about),
    }


def _cause_data(cause: Cause) -> dict[str, Any]:
    statement: dict[str, Any] = {"sentence": cause.sentence, "ids": list(cause.ids), "values": cause.values}
    if cause.passing_step is not None:
        statement["passing_step_s"] = cause.passing_step
    return statement | ({"would_tell": cause.would_tell} if cause.would_tell else {})


def verdict_blocks(answer: JudgedAnswer, title: str = "") -> Blocks:
    """Return the verdict first, where it needs one with its title before it, then what it rests on."""
    judgement = answer.judgement
    tone = {Word.PASS: "pass", Word.FAIL: "fail"}.get(judgement.word, "warn")
    blocks: Blocks = [Callout(title + headline(answer), tone)]  # type: ignore[arg-type]
    blocks += [Callout(sentence, "warn") for sentence in answer.warnings]
    if judgement.word is Word.PARTIAL:
        missing = ", ".join(map(united, judgement.withheld))
        blocks.append(Paragraph(f"No full PASS: the problem asks for {missing} too; report it to be judged."))
    if answer.cause is not None:
        passing_step = answer.cause.passing_step
        passes = "" if passing_step is None else f" This scheme passes at a step of {short(passing_step)} s."
        blocks.append(Paragraph(f"Cause: {answer.cause.sentence}.{passes} {reached(answer)}"))
        if answer.cause.would_tell:
            blocks.append(Paragraph(f"What would tell: {answer.cause.would_tell}."))
    return [
        *blocks,
        Paragraph(f"The question: {answer.problem.asks} {answer.problem.title}."),
        _columns(judgement.columns, answer.standard),
    ]


def page(answer: JudgedAnswer, directory: Path) -> Blocks:
    """Return the blocks of the page; its figures are written to a directory."""
    judgement = answer.judgement
    further = []
    if judgement.quantities:
        further.append(_further_numbers(judgement.quantities, answer.problem.scene.rigid is not None))
    return [
        *verdict_blocks(answer),
        *figures(answer, directory),
        *further,
        *([table(("Of the answer", TableColumn("", "fill")), tuple(answer.about))] if answer.about else []),
    ]


def figures(answer: JudgedAnswer, directory: Path) -> Sequence[FigureBlock]:
    """Draw every column that is judged, with the exact one."""
    from validation.report.figures import histories, motion  # which load matplotlib; a verdict alone needs none

    drawn = []
    exact = answer.standard.exact
    rows = len(exact.time)
    for name in answer.history.columns:
        lines = {
            EXACT: History(exact.time, {name: exact.columns[name]}),
            ANSWER: History(answer.history.time[:rows], {name: answer.history.columns[name][:rows]}),
        }
        panel = HistoryPanel(name.replace("_", " "), lines, {}, EXACT)
        if ANSWER in motion.twins([panel], [name]).get(EXACT, {}):
            caption = f"The answer lies on the exact motion: {united(name)}."
        else:
            caption = (
                f"The answer beside the exact motion, and their difference over its largest value: {united(name)}."
            )
        figure = motion.history_figure([panel], name, apart=True)
        drawn.append(histories.saved(figure, directory, f"judged-{name}.svg", caption))
    return drawn


def _columns(columns_of_answer: Sequence[Column], standard: Standard) -> Table:
    rows = []
    numbers = [column for column in columns_of_answer if column.name not in standard.bands and column.band is not None]
    notes = [] if numbers else [ALLOWED]
    notes += [f"{column.name}: {column.reason}." for column in numbers]
    caption = "Errors of the numbers that are judged." if numbers else "Relative L2 error of each column."
    for column in columns_of_answer:
        name = united(column.name)
        error, band = map(error_percent, (column.error, column.band))
        rows.append((name, str(column.word), error, band, datum(column, standard) or DASH, plain(column.until)))
        if column.band is None:
            notes.append(f"{name}: {column.reason}.")
    return table(
        ("Column", TableColumn("Verdict", "outcome"), "Error", "Allowed", "Set by", "Until [s]"),
        rows,
        caption,
        tuple(notes),
    )


def datum(column: Column, standard: Standard) -> str:
    """Return the datum of which one per cent sets a column's band, nothing where it has none."""
    band = standard.bands.get(column.name)
    return band.datum if band else ""


def _further_numbers(numbers: Sequence[Quantity], of_boxes: bool) -> Table:
    caption = "The numbers that are judged." if of_boxes else "Further numbers, which are not judged."
    rows = [(one.name, _number_cell(one, one.value), _number_cell(one, one.exact), one.unit) for one in numbers]
    return table((TableColumn("Number", "fill"), "Answer", "Exact", "Unit"), rows, caption)


def _number_cell(number: Quantity, value: float | None) -> str:
    if value is None:
        return DASH
    return f"{value:.0f}" if number.name in COUNTED else bounded(value, plain(value))
