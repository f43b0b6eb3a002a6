"""The site of answers to the problems: a table of all, a page a program, curves, badges, verdicts as plain data."""

from __future__ import annotations

import itertools
import json
import math
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata, resources
from pathlib import Path
from typing import Any

from validation.gallery.chapters import placed
from validation.gallery.judged import COLORS, badge_of
from validation.gallery.pages import environment
from validation.gallery.places import check_place, write
from validation.gallery.svg import Sheet
from validation.problems.answers import AnswerSet
from validation.problems.data import PACK, AnswersData, united
from validation.problems.judge import Word
from validation.problems.questions import names, question
from validation.report.chapters.judged import JudgedAnswer, as_data, page, per_cent
from validation.report.chapters.judged_boxes import JudgedBoxes, data_of_boxes, page_of_boxes
from validation.report.chapters.text import DASH, short
from validation.runs.files import atomic_directory

VERDICTS = "verdicts.json"  # marks a directory as such a site
FORMAT = "dda-validation verdicts"
STALE = "stale"
NOT_ANSWERED = "not answered"
DIGITS = 3  # of an error in plain data
LEAST_ERROR = 1e-11  # what is less is rounding, and stands as this
TONES = {Word.PASS: "pass", Word.PARTIAL: "partial", Word.FAIL: "fail"}
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

    @property
    def tone(self) -> str:
        """Class of the cell on a page."""
        return TONES.get(Word(self.word), "notrun") if self.word in set(Word) else "notrun"


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
        return AnswerCell(name, str(judged.word), per_cent(error), _allowed(allowed), number.quantity.name)
    judgement = judged.judgement
    deciding = judgement.deciding
    reasons = [f"cause: {judged.cause.sentence}"] if judged.cause is not None else []
    if judgement.withheld:
        reasons.append(f"{', '.join(map(united, judgement.withheld))} not reported")
    reasons += judged.warnings
    return AnswerCell(
        judged.problem.name,
        str(judgement.word),
        per_cent(deciding.error) if deciding else DASH,
        per_cent(deciding.band) if deciding else DASH,
        united(deciding.name) if deciding else "",
        "; ".join(reasons),
    )


def _allowed(share: float) -> str:
    return per_cent(share) if share else "0 %"


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
    return float(f"{math.copysign(max(abs(value), LEAST_ERROR), value):.{DIGITS}g}")


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
        site = Site(programs)
        for number, judged in enumerate(ordered):
            progress(number, total, f"page of {judged.answers.program} {judged.answers.settings_name}")
            write(place / f"answers_{judged.stem}.html", site.curves(judged))
            write(place / f"badge_{judged.stem}.svg", set_badge(judged))
        for number, name in enumerate(programs, start=len(ordered)):
            progress(number, total, f"page of {name}")
            write(place / f"program_{name}.html", site.program(name))
        progress(total - 1, total, "first page")
        write(place / "index.html", site.index())
        write(place / VERDICTS, json.dumps(verdicts(ordered), indent=1, allow_nan=False) + "\n")
        css = resources.files("validation.gallery").joinpath("static", "gallery.css").read_text("utf-8")
        write(place / "gallery.css", css)
    return out / "index.html"


def _by_address(judged: JudgedSet) -> tuple[str, ...]:
    return judged.answers.address


class Site:
    """The pages of a site: folders of answers by the folder names of their programs."""

    def __init__(self, programs: Mapping[str, Sequence[JudgedSet]]) -> None:
        self._programs = programs
        self._templates = environment()
        self._menu = [
            ("index.html", "All programs"),
            *((f"program_{name}.html", group[-1].answers.data.program) for name, group in programs.items()),
        ]

    def _page(self, template: str, file: str, **values: object) -> str:
        version = metadata.version("dda-validation")
        return self._templates.get_template(template).render(
            menu=self._menu, file=file, version=version, pack=PACK, headline=headline, **values
        )

    def index(self) -> str:
        """Return the first page: problems against programs with versions and settings."""
        ordered = [judged for group in self._programs.values() for judged in group]
        rows = _table(ordered)
        return self._page(
            "answers_index.html.j2",
            "index.html",
            programs=self._programs,
            sets=ordered,
            rows=rows,
            unanswered=[name for name in names() if name not in {row["name"] for row in rows}],
            verdicts_file=VERDICTS,
        )

    def program(self, name: str) -> str:
        """Return the page of a program: all its versions and settings."""
        group = self._programs[name]
        return self._page(
            "answers_program.html.j2",
            f"program_{name}.html",
            title=group[-1].answers.data.program,
            sets=group,
            rows=_table(group),
            stated=[(title, [_stated(judged, field) for judged in group]) for field, title in STATED.items()],
        )

    def curves(self, judged: JudgedSet) -> str:
        """Return the page of a folder of answers: each problem as `judge` shows it."""
        sheet = Sheet()
        sections = []
        by_name = {cell.problem: cell for cell in cells(judged)}
        for answer in judged.answers.answers:
            blocks = []
            if answer.stale is None:
                with tempfile.TemporaryDirectory() as directory:
                    of_answer = judged.judged[answer.name]
                    if isinstance(of_answer, JudgedBoxes):
                        drawn = page_of_boxes(of_answer, Path(directory))
                    else:
                        drawn = page(of_answer, Path(directory))
                    blocks = [placed(block, Path(directory), sheet) for block in drawn]
            sections.append({"cell": by_name[answer.name], "blocks": blocks})
        data = judged.answers.data
        return self._page(
            "answers_set.html.j2",
            f"answers_{judged.stem}.html",
            title=f"{data.program} {data.version} {judged.answers.settings_name}".rstrip(),
            judged=judged,
            sections=sections,
            stated=[(title, _stated(judged, field)) for field, title in STATED.items()],
        )


def _table(sets: Sequence[JudgedSet]) -> list[dict[str, Any]]:
    """Return the rows of a table: a problem, and its cell in each folder of answers; no row that none answers."""
    columns = [{cell.problem: cell for cell in cells(judged)} for judged in sets]
    rows = []
    for name in dict.fromkeys(itertools.chain.from_iterable(columns)):
        row = [column.get(name, AnswerCell(name, NOT_ANSWERED)) for column in columns]
        if all(cell.word == NOT_ANSWERED for cell in row):
            continue
        asks = question(name).asks if name in names() else f"no problem of pack {PACK} any more"
        rows.append({"name": name, "asks": asks, "cells": list(zip(sets, row, strict=True))})
    return rows


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
