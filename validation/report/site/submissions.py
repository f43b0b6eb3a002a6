"""The site of answers to the problems: a table of all, a page a program, curves, badges, verdicts as plain data."""

from __future__ import annotations

import itertools
import json
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path
from typing import Any

from validation.problems.answers import AnswerSet
from validation.problems.data import PACK, AnswersData, united
from validation.problems.judge import Word
from validation.problems.questions import names, question
from validation.report.blocks import (
    Blocks,
    Callout,
    FigureBlock,
    Heading,
    Link,
    Links,
    Paragraph,
    Table,
    TableColumn,
    table,
)
from validation.report.chapters.judged import JudgedAnswer, as_data, page
from validation.report.chapters.judged_boxes import JudgedBoxes, data_of_boxes, page_of_boxes
from validation.report.render import html
from validation.report.site.judged import COLORS, badge_of, imprint
from validation.report.site.places import check_place, write
from validation.runs.files import atomic_directory
from validation.runs.numbers import DASH, error_percent, short, significant

VERDICTS = "verdicts.json"  # marks a directory as such a site
FORMAT = "dda-validation verdicts"
STALE = "stale"
NOT_ANSWERED = "not answered"
DIGITS = 3  # of an error in plain data
LEAST_ERROR = 1e-11  # what is less is rounding, and stands as this
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
Progress = Callable[[int, int, str], None]


@dataclass(frozen=True, eq=False)
class JudgedSet:
    """A folder of answers and the judgement of each that is not stale, by problem."""

    answers: AnswerSet
    judged: Mapping[str, JudgedAnswer | JudgedBoxes]

    @property
    def stem(self) -> str:
        """What the names of its files have in common; names of folders hold no underscore."""
        return "_".join(part for part in self.answers.address if part)


@dataclass(frozen=True)
class AnswerCell:
    """An answer in a table: the verdict, and the column that decides it."""

    problem: str
    word: str
    error: str = DASH
    allowed: str = DASH
    column: str = ""
    reason: str = ""  # the cause of a failure, or why it is not judged


def cells(judged: JudgedSet) -> list[AnswerCell]:
    """Return what a table holds of a folder of answers: each problem of the pack, then those that are in it no more."""
    by_name = {answer.name: answer for answer in judged.answers.answers}
    rows = []
    for name in dict.fromkeys([*names(), *by_name]):
        answer = by_name.get(name)
        if answer is None:
            rows.append(AnswerCell(name, NOT_ANSWERED))
        elif answer.stale is not None:
            rows.append(AnswerCell(name, STALE, reason=answer.stale))
        else:
            rows.append(_cell(judged.judged[name]))
    return rows


def _cell(judged: JudgedAnswer | JudgedBoxes) -> AnswerCell:
    if isinstance(judged, JudgedBoxes):
        number = judged.deciding
        error, allowed = number.shares
        name = judged.question.name
        return AnswerCell(name, str(judged.word), error_percent(error), _allowed(allowed), number.quantity.name)
    judgement = judged.judgement
    deciding = judgement.deciding
    reasons = [f"cause: {judged.cause.sentence}"] if judged.cause is not None else []
    if judgement.withheld:
        reasons.append(f"{', '.join(map(united, judgement.withheld))} not reported")
    reasons += judged.warnings
    return AnswerCell(
        judged.problem.name,
        str(judgement.word),
        error_percent(deciding.error) if deciding else DASH,
        error_percent(deciding.band) if deciding else DASH,
        united(deciding.name) if deciding else "",
        "; ".join(reasons),
    )


def _allowed(share: float) -> str:
    return error_percent(share) if share else "0 %"


def summary(sets: Sequence[JudgedSet]) -> Counter[str]:
    """Return how many answers there are of each word."""
    words = (cell.word for judged in sets for cell in cells(judged))
    return Counter(word for word in words if word != NOT_ANSWERED)


def headline(judged: JudgedSet) -> str:
    """Return how many of its answers pass, in a few words."""
    counts = summary([judged])
    other_counts = [f"{count} {word}" for word, count in sorted(counts.items()) if word != Word.PASS]
    return ", ".join([f"{counts[Word.PASS]} of {counts.total()} PASS", *other_counts])


# ---- plain data -----------------------------------------------------------------------------------------------------


def verdicts(sets: Sequence[JudgedSet]) -> dict[str, Any]:
    """Return the verdicts on all answers as plain data."""
    return {
        "format": FORMAT,
        "pack": PACK,
        "made_by": f"dda-validation {metadata.version('dda-validation')}",
        "answers": [row for judged in sets for row in _rows(judged)],
    }


def _rows(judged: JudgedSet) -> list[dict[str, Any]]:
    data = judged.answers.data
    answers_data = data if isinstance(data, AnswersData) else None
    rows = []
    for answer in judged.answers.answers:
        row: dict[str, Any] = {
            "program": data.program,
            "version": data.version,
            "settings_name": judged.answers.settings_name,
            "answered_pack": data.pack,
            "problem": answer.name,
            "step_s": answers_data.step_of(answer.name) if answers_data else None,
        }
        if answer.stale is not None:
            rows.append(row | {"verdict": STALE, "reason": answer.stale})
            continue
        of_answer = judged.judged[answer.name]
        if isinstance(of_answer, JudgedBoxes):
            judgement = data_of_boxes(of_answer)
            for number in judgement["numbers"]:
                number.update({key: _rounded(number[key]) for key in ("value", "error", "allowed")})
            rows.append(row | judgement)
            continue
        judgement = as_data(of_answer, judged.answers.program)
        for key in ("pack", "problem", "program", "about"):
            del judgement[key]
        for column in judgement["columns"]:
            for key in ("error", "allowed"):
                column[key] = _rounded(column[key])
            column["until_s"] = _rounded(column["until_s"])
            column["within_until_s"] = _rounded(column["within_until_s"])
        rows.append(row | judgement)
    return rows


def _rounded(value: Any) -> Any:
    """Return a number to a few digits; what is smaller than rounding stands as that."""
    if not isinstance(value, float) or not math.isfinite(value) or value == 0:
        return value
    return significant(math.copysign(max(abs(value), LEAST_ERROR), value), DIGITS)


# ---- the site -------------------------------------------------------------------------------------------------------


def write_site(sets: Sequence[JudgedSet], out: Path, progress: Progress) -> Path:
    """Write the site of judged answers and return its first page.

    Parameters
    ----------
    sets
        The folders of answers.
    out
        Directory to write: a new or empty one, or an earlier site, which is replaced as a whole.
    progress
        Told before each page: how many are finished, of how many, and which is next.

    Raises
    ------
    InputError
        The directory is not one to write to.
    """
    check_place(out, VERDICTS, "site")
    programs = {
        name: list(group)
        for name, group in itertools.groupby(sorted(sets, key=_by_address), key=lambda one: one.answers.address[0])
    }
    ordered = [judged for group in programs.values() for judged in group]
    total = len(ordered) + len(programs) + 1
    with atomic_directory(out) as place:
        site = Site(programs, place)
        for number, judged in enumerate(ordered):
            progress(number, total, f"page of {judged.answers.program} {judged.answers.settings_name}")
            site.curves(judged)
            write(place / f"badge_{judged.stem}.svg", set_badge(judged))
        for number, name in enumerate(programs, start=len(ordered)):
            progress(number, total, f"page of {name}")
            site.program(name)
        progress(total - 1, total, "first page")
        site.index()
        write(place / VERDICTS, json.dumps(verdicts(ordered), indent=1, allow_nan=False) + "\n")
        for name in (html.STYLE, html.SCRIPT):
            write(place / name, html.static(name))
    return out / "index.html"


def _by_address(judged: JudgedSet) -> tuple[str, ...]:
    return judged.answers.address


class Site:
    """The pages of a site: folders of answers by the folder names of their programs."""

    def __init__(self, programs: Mapping[str, Sequence[JudgedSet]], place: Path) -> None:
        self._programs = programs
        self._place = place
        self._menu = [
            ("index.html", "All programs"),
            *((f"program_{name}.html", group[-1].answers.data.program) for name, group in programs.items()),
        ]

    def _write(self, file: str, title: str, blocks: Blocks) -> None:
        text = html.page(
            title, [Heading(title), *blocks], file=file, name="Answers to the problems", menu=self._menu,
            imprint=imprint(), figure=lambda figure: f"{file.removesuffix('.html')}/{figure}",
        )  # fmt: skip
        write(self._place / file, text)

    def index(self) -> None:
        """Write the first page: problems against programs with versions and settings."""
        sets = [judged for group in self._programs.values() for judged in group]
        asks = _asks(sets)
        missing = [name for name in names() if name not in asks]
        unanswered = [Paragraph(f"Not answered by any of them: {', '.join(missing)}.", "small")] if missing else []
        lead = (
            "Every problem has an exact motion, or exact numbers of it. An answer passes where each of its errors is "
            "below what one per cent of the problem's data changes; the first number is the error, the second what is "
            f"allowed, of what decides. All verdicts as plain data: {VERDICTS}."
        )
        blocks: Blocks = [
            Paragraph(lead, "lead"),
            answer_table(sets),
            *unanswered,
            *reason_blocks(sets),
            Heading("Programs", 2),
            _links(sets),
            Heading("The problems", 2),
            table(("Problem", TableColumn("What it asks", "fill")), list(asks.items())),
        ]
        self._write("index.html", f"Answers to the problems of pack {PACK}", blocks)

    def program(self, name: str) -> None:
        """Write the page of a program: all its versions and settings."""
        group = self._programs[name]
        blocks = [_links(group), answer_table(group), *reason_blocks(group), stated_table(group)]
        self._write(f"program_{name}.html", group[-1].answers.data.program, blocks)

    def curves(self, judged: JudgedSet) -> None:
        """Write the page of a folder of answers: each problem as `judge` shows it."""
        file = f"answers_{judged.stem}.html"
        directory = self._place / file.removesuffix(".html")
        blocks: Blocks = [Callout(f"{headline(judged)}.", "rule"), stated_table([judged])]
        by_name = {cell.problem: cell for cell in cells(judged)}
        for answer in judged.answers.answers:
            cell = by_name[answer.name]
            blocks.append(Heading(cell.problem, 2))
            of_answer = judged.judged.get(answer.name)
            if of_answer is None:
                blocks.append(Callout(f"{cell.word}: {cell.reason}.", "warn"))
                continue
            figures = directory / answer.name
            draw = page_of_boxes if isinstance(of_answer, JudgedBoxes) else page
            for block in draw(of_answer, figures):  # type: ignore[arg-type]
                if isinstance(block, FigureBlock):
                    block = replace(block, file=f"{answer.name}/{block.file}")
                blocks.append(block)
        self._write(file, _title(judged), blocks)


def _title(judged: JudgedSet) -> str:
    data = judged.answers.data
    return f"{data.program} {data.version} {judged.answers.settings_name}".rstrip()


def _links(sets: Sequence[JudgedSet]) -> Links:
    links = [
        Link(f"answers_{judged.stem}.html", _title(judged), headline(judged), f"badge_{judged.stem}.svg")
        for judged in sets
    ]
    return Links(tuple(links))


def answer_table(sets: Sequence[JudgedSet]) -> Table:
    """Return problems against folders of answers: the verdict, the error that decides and what is allowed."""
    by_set = [{cell.problem: cell for cell in cells(judged)} for judged in sets]
    rows = []
    for name in _asks(sets):
        of_problem = [answered.get(name, AnswerCell(name, NOT_ANSWERED)) for answered in by_set]
        texts = [f"{cell.word} {cell.error} of {cell.allowed}" if cell.column else cell.word for cell in of_problem]
        rows.append((name, *texts))
    heads = [
        TableColumn(f"{judged.answers.data.version} {judged.answers.settings_name}".rstrip(), "outcome",
                    judged.answers.data.program)
        for judged in sets
    ]  # fmt: skip
    return table(("Problem", *heads), rows, "Problems, and what programs answered.")


def reason_blocks(sets: Sequence[JudgedSet]) -> Blocks:
    """Return why answers fail or are not judged; nothing where there is no reason to give."""
    rows = []
    for judged in sets:
        rows += [
            (cell.word, _title(judged), cell.problem, "; ".join(filter(None, (cell.column, cell.reason))))
            for cell in cells(judged)
            if cell.reason
        ]
    heads = (TableColumn("Verdict", "outcome"), "Of", "Problem", TableColumn("What decides, and the cause", "fill"))
    return [Heading("Causes, and what is not judged", 2), table(heads, rows)] if rows else []


def stated_table(sets: Sequence[JudgedSet]) -> Table:
    """Return what folders of answers say of themselves, a column each."""
    rows = [(title, *(_stated(judged, field) for judged in sets)) for field, title in STATED.items()]
    return table(("", *(TableColumn(_title(judged), "fill") for judged in sets)), rows)


def _asks(sets: Sequence[JudgedSet]) -> dict[str, str]:
    """Return the problems that some folder answers, and what they ask."""
    answered = {cell.problem for judged in sets for cell in cells(judged) if cell.word != NOT_ANSWERED}
    ordered = dict.fromkeys([*names(), *(cell.problem for judged in sets for cell in cells(judged))])
    gone = f"no problem of pack {PACK} any more"
    return {name: question(name).asks if name in names() else gone for name in ordered if name in answered}


def _stated(judged: JudgedSet, field: str) -> str:
    """Return what a folder of answers says of itself, in words."""
    value = getattr(judged.answers.data, field, None)
    if value is None:
        return "none" if field == "step_s" and isinstance(judged.answers.data, AnswersData) else DASH
    if isinstance(value, dict):
        return "; ".join(f"{name} {short(step)}" for name, step in value.items())
    return short(value) if isinstance(value, float) else str(value)


def set_badge(judged: JudgedSet) -> str:
    """Return the badge of a folder of answers: how many problems it passes."""
    words = set(summary([judged]))
    word = next((word for word in (Word.FAIL, Word.PARTIAL) if word in words), Word.PASS)
    if words - set(Word) or Word.PASS not in words:
        word = Word.FAIL if Word.FAIL in words else Word.PARTIAL
    label = f"DDA field {PACK}: {judged.answers.program} {judged.answers.settings_name}".rstrip()
    return badge_of(label, headline(judged), COLORS[word])
