"""The page of a judged answer: the verdict, what it rests on, the curves; and the same as plain data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.gates.gate import Status
from validation.problems.cause import Cause
from validation.problems.quantities import COUNTED, Quantity
from validation.report.blocks import Blocks, Callout, FigureBlock, Paragraph, Table, TableColumn, table
from validation.report.figures.curves import EXACT, HistoryPanel
from validation.runs.columns import split
from validation.runs.history import History
from validation.runs.numbers import DASH, bounded, error_percent, plain, short, significant
from validation.scenes.tables import TimeSection
from validation.suite.judging import JudgedAnswer

ANSWER = "answer"
STILL = 1e-9  # m or rad: a position that changes by less does not move
DIGITS = 3  # of an error in plain data
LEAST_ERROR = 1e-11  # what is less is rounding, and stands as this
TONES = {Status.PASS: "pass", Status.FAIL: "fail"}
ALLOWED = (
    "Allowed is what one per cent of the datum that is named changes in the exact motion: data of a block are not "
    "known to better than one per cent, and an error below that changes nothing for its user."
)


def headline(answer: JudgedAnswer) -> str:
    """Return the verdict and what it rests on, in a sentence."""
    judgement = answer.judgement
    deciding = judgement.deciding
    if deciding is None or deciding.allowed is None or deciding.error is None:
        return f"{judgement.verdict}: no column of it is judged."
    name = answer.problem.named(deciding.name)
    number = next((number for number in judgement.quantities if number.band and number.name == deciding.name), None)
    if number is not None and number.band is not None:
        value = "cannot be measured" if number.value is None else f"is {_with_unit(number.value, number.unit)}"
        low, high = (short(edge, 4) for edge in number.band)
        unit = "" if number.unit == "1" else f" {number.unit}"
        return f"{judgement.verdict}: {name} {value}, where {low} to {high}{unit} is allowed."
    at_most = "at most " if judgement.status in (Status.PASS, Status.PARTIAL) else ""
    return (
        f"{judgement.verdict}: it is {at_most}{error_percent(deciding.error)} off in {name}, where "
        f"{error_percent(deciding.allowed)} is allowed."
    )


def _with_unit(value: float, unit: str) -> str:
    text = bounded(value, short(value, 4))
    return text if unit == "1" else f"{text} {unit}"


def reached(answer: JudgedAnswer) -> str:
    """Return how far an answer that fails is right, in a sentence."""
    within = answer.judgement.within
    if not within:
        return "Its error is more than what is allowed from the first step on."
    until = max(criterion.until for criterion in answer.judgement.criteria)
    return f"Its error is within what is allowed up to {short(within)} s of {short(until)} s."


def as_data(judged: JudgedAnswer) -> dict[str, Any]:
    """Return a judgement as plain data, without last digits, which differ between processors."""
    named = judged.problem.named
    criteria = []
    for criterion in judged.judgement.criteria:
        error = "inf" if criterion.error == math.inf else rounded(criterion.error)
        criteria.append(
            {
                "name": named(criterion.name),
                "verdict": str(criterion.status),
                "error": error,
                "allowed": rounded(criterion.allowed),
                "until_s": rounded(criterion.until),
                "within_until_s": rounded(criterion.within),
                "reason": criterion.reason,
            }
        )
    numbers = []
    for number in judged.judgement.quantities:
        low, high = number.band or (None, None)
        numbers.append(
            {
                "name": number.name,
                "unit": number.unit,
                "value": rounded(number.value),
                "exact": rounded(number.exact),
                "low": rounded(low),
                "high": rounded(high),
            }
        )
    return {
        "verdict": str(judged.judgement.status),
        "not_reported": [named(name) for name in judged.judgement.withheld],
        "cause": None if judged.cause is None else _cause_data(judged.cause),
        "criteria": criteria,
        "numbers": numbers,
        "warnings": list(judged.warnings),
    }


def rounded(value: float | None) -> float | None:
    """Return a number to a few digits; what is smaller than rounding stands as that."""
    if value is None or not math.isfinite(value) or value == 0:
        return value
    return significant(math.copysign(max(abs(value), LEAST_ERROR), value), DIGITS)


def _cause_data(cause: Cause) -> dict[str, Any]:
    statement: dict[str, Any] = {"sentence": cause.sentence, "ids": list(cause.ids), "values": cause.values}
    if cause.passing_step is not None:
        statement["passing_step_s"] = cause.passing_step
    return statement | ({"would_tell": cause.would_tell} if cause.would_tell else {})


def verdict_blocks(answer: JudgedAnswer, title: str = "") -> Blocks:
    """Return the verdict, with its title where it needs one, then what it rests on."""
    judgement = answer.judgement
    tone = TONES.get(judgement.status, "warn")
    blocks: Blocks = [Callout(title + headline(answer), tone)]  # type: ignore[arg-type]
    blocks += [Callout(sentence, "warn") for sentence in answer.warnings]
    if judgement.status is Status.PARTIAL:
        missing = ", ".join(map(answer.problem.named, judgement.withheld))
        blocks.append(Paragraph(f"No full PASS: the problem asks for {missing} too; report it to be judged."))
    if answer.cause is not None:
        blocks.append(Paragraph(f"Cause: {answer.cause.sentence}. {reached(answer)}"))
        time = answer.problem.scene.time
        if answer.cause.passing_step is not None:
            every = round(time.step / answer.cause.passing_step)
            blocks.append(Paragraph(f"This scheme passes at a step of {_step(time, every)}."))
        if answer.cause.would_tell:
            half = "" if answer.cause.alike else f"; half the step is {_step(time, 2)}"
            blocks.append(Paragraph(f"What would tell: {answer.cause.would_tell}{half}."))
    criteria = answer.judgement.criteria
    caption = "Relative L2 error of each column."
    notes = [ALLOWED]
    if answer.problem.numbers:
        caption = "Errors of the numbers that are judged, as shares of their scales."
        notes = list(dict.fromkeys(f"{criterion.name}: {criterion.reason}." for criterion in criteria))
    rows = []
    for criterion in criteria:
        name = answer.problem.named(criterion.name)
        error, allowed = map(error_percent, (criterion.error, criterion.allowed))
        rows.append((name, str(criterion.status), error, allowed, criterion.datum or DASH, plain(criterion.until)))
        if criterion.allowed is None:
            notes.append(f"{name}: {criterion.reason}.")
    blocks += [
        Paragraph(f"The question: {answer.problem.asks} {answer.problem.title}."),
        table(
            ("Judged", TableColumn("Verdict", "outcome"), "Error", "Allowed", "Set by", "Until [s]"),
            rows,
            caption,
            tuple(notes),
        ),
    ]
    if judgement.quantities:
        blocks.append(numbers_table(judgement.quantities))
    return blocks


def _step(time: TimeSection, parts: int) -> str:
    """Return a part of the step of a scene, and what to type for it."""
    step = time.step / parts
    return f"{short(step, 4)} s: --set time.step={step:.12g} --set time.steps={time.steps * parts}"


def page(answer: JudgedAnswer, directory: Path) -> Blocks:
    """Return the blocks of the page; its figures are written to a directory."""
    return [*verdict_blocks(answer), *figures(answer, directory)]


def figures(answer: JudgedAnswer, directory: Path) -> Sequence[FigureBlock]:
    """Draw every judged column with the exact one; of boxes what moves of the uppermost."""
    from validation.report.figures import histories, motion  # which load matplotlib; a verdict alone needs none

    drawn = []
    for name, exact in _curves(answer):
        united = answer.problem.named(name)
        values = answer.history.columns[name]
        if exact is None:
            lines = {ANSWER: History(answer.history.time, {name: values})}
            panel = HistoryPanel(f"{name} [{answer.problem.unit(name)}]", lines, {}, ANSWER)
            figure = motion.history_figure([panel], name)
            drawn.append(histories.saved(figure, directory, f"judged-{name}.svg", f"The answer: {united}."))
            continue
        rows = len(exact.time)
        lines = {
            EXACT: History(exact.time, {name: exact.columns[name]}),
            ANSWER: History(answer.history.time[:rows], {name: values[:rows]}),
        }
        panel = HistoryPanel(name.replace("_", " "), lines, {}, EXACT)
        if ANSWER in motion.twins([panel], [name]).get(EXACT, {}):
            caption = f"The answer lies on the exact motion: {united}."
        else:
            caption = f"The answer beside the exact motion, and their difference over its largest value: {united}."
        figure = motion.history_figure([panel], name, apart=True)
        drawn.append(histories.saved(figure, directory, f"judged-{name}.svg", caption))
    return drawn


def _curves(answer: JudgedAnswer) -> list[tuple[str, History | None]]:
    """Return the drawn columns, each with the exact motion where it is judged by that."""
    columns = answer.history.columns
    if answer.standard is not None:
        return [(name, answer.standard.exact) for name in columns if name in answer.standard.exact.columns]
    _, uppermost = split(answer.problem.columns[-1])
    poses = [name for name in answer.problem.columns if split(name)[1] == uppermost]
    return [(name, None) for name in poses if name in columns and np.ptp(columns[name]) >= STILL]


def numbers_table(numbers: Sequence[Quantity]) -> Table:
    """Return the numbers of an answer beside the exact ones, and the edges between which judged ones pass."""
    rows = []
    judged = any(number.band is not None for number in numbers)
    for number in numbers:
        edges = [] if number.band is None else [short(edge, 4) for edge in number.band]
        rows.append((number.name, _cell(number, number.value), _cell(number, number.exact), *edges, number.unit))
    edge_heads = ("From", "To") if judged else ()
    caption = "The numbers that are judged." if judged else "Further numbers, which are not judged."
    return table((TableColumn("Number", "fill"), "Answer", "Exact", *edge_heads, "Unit"), rows, caption)


def _cell(number: Quantity, value: float | None) -> str:
    if value is None:
        return DASH
    return f"{value:.0f}" if number.name in COUNTED else bounded(value, plain(value))
