"""Answers of programs in tables: verdicts against problems, why so, what programs say of themselves; as plain data."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata
from typing import Any

from validation.gates.gate import Status
from validation.problems.answers import AnswerSet
from validation.problems.data import PACK
from validation.problems.problem import names, problem
from validation.report.blocks import Blocks, Heading, Paragraph, Table, TableColumn, table
from validation.report.chapters.judged import as_data
from validation.runs.numbers import DASH, error_percent, short
from validation.suite.judging import JudgedAnswer

FORMAT = "dda-validation verdicts"
STATED = {  # fields of the metadata and what a page calls them
    "settings": "Settings",
    "scheme": "Scheme",
    "step_s": "Step [s]",
    "contact_model": "Contact",
    "processor": "Processor",
    "who": "Who",
    "licence": "Licence",
    "link": "Link",
    "pack": "Pack",
}
LEAD = (
    "Every problem has an exact motion, or exact numbers of it. An answer passes where each of its errors is "
    "below what one per cent of the problem's data changes; the first number is the error, the second what is "
    "allowed, of what decides."
)


@dataclass(frozen=True)
class AnswerCell:
    """An answer in a table: the verdict, and what decides it."""

    problem: str
    status: Status
    error: str = DASH
    allowed: str = DASH
    column: str = ""
    reason: str = ""  # the cause of a failure, or why it is not judged


def cells(judged: AnswerSet) -> list[AnswerCell]:
    """Return the cells of a program: each problem of the pack, then those that are in it no more."""
    by_name = {answer.name: answer for answer in judged.answers}
    rows = []
    for name in dict.fromkeys([*names(), *by_name]):
        answer = by_name.get(name)
        if answer is None:
            rows.append(AnswerCell(name, Status.NOT_ANSWERED))
        elif isinstance(answer, JudgedAnswer):
            rows.append(_cell(answer))
        elif answer.status is not None:
            rows.append(AnswerCell(name, answer.status, reason=answer.reason))
    return rows


def answered(judged: AnswerSet) -> list[AnswerCell]:
    """Return the cells of the problems that a program was asked."""
    return [cell for cell in cells(judged) if cell.status is not Status.NOT_ANSWERED]


def _cell(judged: JudgedAnswer) -> AnswerCell:
    judgement = judged.judgement
    named = judged.problem.named
    deciding = judgement.deciding
    reasons = [f"cause: {judged.cause.sentence}"] if judged.cause is not None else []
    if judgement.withheld:
        reasons.append(f"{', '.join(map(named, judgement.withheld))} not reported")
    reasons += judged.warnings
    return AnswerCell(
        judged.problem.name,
        judgement.status,
        error_percent(deciding.error) if deciding else DASH,
        _allowed(deciding.allowed) if deciding else DASH,
        named(deciding.name) if deciding else "",
        "; ".join(reasons),
    )


def _allowed(share: float | None) -> str:
    return "0 %" if share == 0 else error_percent(share)


def summary(sets: Sequence[AnswerSet]) -> Counter[Status]:
    """Return how many answers there are of each status."""
    return Counter(cell.status for judged in sets for cell in answered(judged))


def headline(judged: AnswerSet) -> str:
    """Return how many of its answers pass."""
    counts = summary([judged])
    other_counts = [f"{count} {status}" for status, count in sorted(counts.items()) if status is not Status.PASS]
    return ", ".join([f"{counts[Status.PASS]} of {counts.total()} PASS", *other_counts])


# ---- plain data ----


def verdicts(sets: Sequence[AnswerSet]) -> dict[str, Any]:
    """Return all verdicts as plain data."""
    return {
        "format": FORMAT,
        "pack": PACK,
        "made_by": f"dda-validation {metadata.version('dda-validation')}",
        "answers": [row for judged in sets for row in _rows(judged)],
    }


def _rows(judged: AnswerSet) -> list[dict[str, Any]]:
    data = judged.data
    rows = []
    for answer in judged.answers:
        row = {
            "program": data.program,
            "version": data.version,
            "settings_name": data.settings_name,
            "answered_pack": data.pack,
            "problem": answer.name,
            "step_s": data.step_of(answer.name),
        }
        if isinstance(answer, JudgedAnswer):
            rows.append(row | as_data(answer))
        else:
            rows.append(row | {"verdict": str(answer.status), "reason": answer.reason})
    return rows


# ---- tables ----


def first_page(sets: Sequence[AnswerSet]) -> Blocks:
    """Return a report of programs: problems against programs, reasons, who they are."""
    title = f"Answers to the problems of pack {PACK}"
    return [Heading(title), Paragraph(LEAD), answer_table(sets), *reason_blocks(sets), stated_table(with_answers(sets))]


def with_answers(sets: Sequence[AnswerSet]) -> list[AnswerSet]:
    """Return the programs that answered a problem; all of them where none did."""
    none = (Status.NOT_APPLICABLE, Status.NOT_RUN)
    return [one for one in sets if any(cell.status not in none for cell in answered(one))] or [*sets]


def answer_table(of_all: Sequence[AnswerSet]) -> Table:
    """Return programs against problems: verdict, the error that decides, what is allowed, and what runs took.

    A program that answered nothing is named below the table, with what it said of the first problem.
    """
    sets = with_answers(of_all)
    notes = [f"No answer by {judged.title}: {answered(judged)[0].reason}." for judged in of_all if judged not in sets]
    by_set = [{cell.problem: cell for cell in answered(judged)} for judged in sets]
    rows = []
    for name in asks_of(sets):
        of_problem = [of_set.get(name, AnswerCell(name, Status.NOT_ANSWERED)) for of_set in by_set]
        texts = [f"{cell.status} {cell.error} of {cell.allowed}" if cell.column else cell.status for cell in of_problem]
        rows.append((name, *texts))
    times = [_seconds(judged) for judged in sets]
    if any(time != DASH for time in times):
        rows.append(("time [s]", *times))
    heads = [
        TableColumn(f"{judged.data.version} {judged.data.settings_name}".strip(), "outcome",
                    judged.data.program)
        for judged in sets
    ]  # fmt: skip
    return table(("Problem", *heads), rows, "Problems, and what programs answered.", tuple(notes))


def _seconds(judged: AnswerSet) -> str:
    """Return what the answers of a program took [s], to two digits."""
    times = [answer.seconds for answer in judged.answers if answer.seconds is not None and answer.history]
    return short(sum(times), 2) if times else DASH


def reason_blocks(sets: Sequence[AnswerSet]) -> Blocks:
    """Return why answers fail or are not judged, a line for each program and reason."""
    rows = []
    for judged in with_answers(sets):
        problems_by_reason: dict[tuple[str, str], list[str]] = {}
        for cell in cells(judged):
            if cell.reason:
                reason = "; ".join(filter(None, (cell.column, cell.reason)))
                problems_by_reason.setdefault((str(cell.status), reason), []).append(cell.problem)
        for (status, reason), problems in problems_by_reason.items():
            rows.append((status, judged.title, ", ".join(problems), reason))
    heads = (TableColumn("Verdict", "outcome"), "Of", "Problems", TableColumn("What decides, and the cause", "fill"))
    return [Heading("Causes, and what is not judged", 2), table(heads, rows)] if rows else []


def stated_table(sets: Sequence[AnswerSet]) -> Table:
    """Return what programs say of themselves, a column each, without rows that none states."""
    rows = []
    for field, title in STATED.items():
        texts = [_stated(judged, field) for judged in sets]
        if any(text != DASH for text in texts):
            rows.append((title, *texts))
    return table(("", *(TableColumn(judged.title, "fill") for judged in sets)), rows)


def asks_of(sets: Sequence[AnswerSet]) -> dict[str, str]:
    """Return the problems that programs were asked, and what they ask."""
    asked = {cell.problem for judged in sets for cell in answered(judged)}
    own = {answer.name: answer.problem for judged in sets for answer in judged.answers}
    asks = {}
    for name in dict.fromkeys([*names(), *(cell.problem for judged in sets for cell in cells(judged))]):
        if name in asked:
            posed = problem(name) if name in names() else own.get(name)
            asks[name] = f"no problem of pack {PACK} any more" if posed is None else posed.asks
    return asks


def _stated(judged: AnswerSet, field: str) -> str:
    value = getattr(judged.data, field)
    if not value:
        return "none" if field == "step_s" and judged.data.who else DASH
    if isinstance(value, dict):
        return "; ".join(f"{name} {short(step)}" for name, step in value.items())
    return short(value) if isinstance(value, float) else str(value)
