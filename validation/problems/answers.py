"""Folders of answers: all that one program answers with one choice of settings, and the layout in which they are kept.

The layout: `submissions/PROGRAM/VERSION/SETTINGS/submission.json` and, beside it, a `PROBLEM.csv` for each problem.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.errors import InputError
from validation.problems.answer_table import read_answer
from validation.problems.data import PACK, SUBMISSION, AnswersData, SubmissionData
from validation.problems.defects import Defects, Place
from validation.problems.pack import ANSWERS_TEMPLATE, CHOSEN
from validation.problems.packs import packs, stale
from validation.problems.questions import Question
from validation.problems.questions import names as names_of_pack
from validation.problems.questions import question as question_named
from validation.problems.stated import Document, checked, read_document
from validation.problems.submission import EXPORT, FILE, check_pack, read_submission, reported
from validation.runs.files import atomic_directory
from validation.runs.history import History
from validation.scenes.unknown import did_you_mean

DEEPEST = 4  # folders between the one that is named and a folder of answers
TABLE = ".csv"
FILLED_IN = {name: blank for name, blank in ANSWERS_TEMPLATE.items() if name not in CHOSEN}
Progress = Callable[[int, int, str], None]


@dataclass(frozen=True, eq=False)
class Answer:
    """An answer to a problem, or why an answer to an earlier pack is none any more."""

    name: str  # of the problem
    problem: Question | None  # None of a stale answer
    history: History | None  # of the columns that are reported; None of a stale answer
    withheld: tuple[str, ...] = ()  # columns that the program cannot report, as the pack names them
    stale: str | None = None


@dataclass(frozen=True, eq=False)
class AnswerSet:
    """What one program answers with one choice of settings."""

    place: Path
    data: AnswersData | SubmissionData
    answers: tuple[Answer, ...]  # in the order of the pack

    @property
    def program(self) -> str:
        """Program and version."""
        return f"{self.data.program} {self.data.version}"

    @property
    def settings_name(self) -> str:
        """Name of the settings; the answer to one problem alone has none."""
        return self.data.settings_name if isinstance(self.data, AnswersData) else ""

    @property
    def address(self) -> tuple[str, str, str]:
        """Names of the three folders of the layout."""
        return folder_name(self.data.program), folder_name(self.data.version), self.settings_name


def folder_name(text: str) -> str:
    """Return a text as the name of a folder: small letters, digits, points, plus and minus signs; of others nothing."""
    return re.sub(r"[^a-z0-9.+]+", "-", text.lower()).strip("-.")


# ---- reading --------------------------------------------------------------------------------------------------------


def read_sets(
    root: Path, in_layout: bool = False, progress: Progress = lambda number, total, label: None
) -> list[AnswerSet]:
    """Read all folders of answers at or below a directory.

    Parameters
    ----------
    root
        A folder of answers, or a directory of such, at most `DEEPEST` levels below it.
    in_layout
        Whether each has to lie in its own place, `PROGRAM/VERSION/SETTINGS`.
    progress
        Told before each table: how many are read, of how many, and which is next.

    Raises
    ------
    DefectsError
        Something is wrong; every defect of all files is named.
    """
    defects = Defects()
    folders = list(_folders(root))
    if not folders:
        raise InputError(f"must be a directory with {FILE} and CSV files, or of such", source=root, advice=EXPORT)
    total = sum(len(_tables(folder)) for folder in folders)
    number = 0
    sets: list[AnswerSet] = []
    for folder in folders:

        def step(name: str, first: int = number) -> None:
            progress(first, total, f"reading {name}")

        try:
            answer_set = _read_set(folder, defects, step)
        except InputError as error:
            defects.take(error)
            answer_set = None
        number += len(_tables(folder))
        if answer_set is not None:
            sets.append(answer_set)
            _check_place(root, answer_set, in_layout, defects)
    _check_once(sets, defects)
    defects.check()
    return sets


def _folders(root: Path) -> Iterator[Path]:
    """Yield the folders with a file of metadata or with tables, in the order of their names."""
    for directory, names, files in os.walk(root):
        depth = len(Path(directory).relative_to(root).parts)
        names[:] = sorted(name for name in names if not name.startswith(".")) if depth < DEEPEST else []
        tables = [name for name in files if _is_table(name)]
        if FILE in files or tables:
            yield Path(directory)


def _is_table(name: str) -> bool:
    return name.lower().endswith(TABLE) and not name.startswith(".")


def _tables(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if _is_table(path.name))


def _read_set(folder: Path, defects: Defects, step: Callable[[str], None]) -> AnswerSet | None:
    """Return what a folder answers; None, and the defects, where something is wrong."""
    document = read_document(folder / FILE, EXPORT)
    if document.content.get("format") == SUBMISSION:
        submission = read_submission(folder)
        step(submission.problem.name)
        answer = Answer(
            submission.problem.name, submission.problem, submission.history, tuple(submission.data.not_reported)
        )
        return AnswerSet(folder, submission.data, (answer,))
    before = len(defects)
    pack = check_pack(document, defects)
    data = checked(document, AnswersData, FILLED_IN, defects)
    for field in ("program", "version"):
        text = document.content.get(field)
        if isinstance(text, str) and text.strip() and not folder_name(text):
            rule = "must hold a letter or digit of ASCII, for the name of its folder"
            defects.add(document.place((field,)), rule, field=field, value=repr(text))
    # Tables of an unknown pack are checked by this one, so that all defects are told at once.
    answers = _answers(folder, document, pack or PACK, defects, step)
    if len(defects) == before and not answers:
        defects.add(Place(folder), "must hold the table of a problem", value="none that is filled in")
    return AnswerSet(folder, data, answers) if data is not None and len(defects) == before else None


def _answers(
    folder: Path, document: Document, pack: str, defects: Defects, step: Callable[[str], None]
) -> tuple[Answer, ...]:
    """Return the answers of a folder's tables; a table that is not filled in is none."""
    digests = packs()[pack]
    later: list[str] = []  # tables of problems that the stated pack did not have yet
    withheld_by_name = document.content.get("not_reported")
    if not isinstance(withheld_by_name, dict):
        withheld_by_name = {}
    answers: dict[str, Answer] = {}
    names = [path.name for path in _tables(folder)]
    for path in _tables(folder):
        name = path.name.removesuffix(TABLE)
        is_later = name not in digests and name in packs()[PACK]
        if name not in digests and not is_later:
            advice = did_you_mean(name.lower(), digests, TABLE) or f"problems are {', '.join(digests)}"
            defects.add(Place(path), f"must be named after a problem of pack {pack}", value=path.name, advice=advice)
            continue
        reason = None if is_later else stale(pack, name)
        if reason is not None:
            answers[name] = Answer(name, None, None, stale=reason)
            continue
        step(name)
        posed = question_named(name)
        withheld = withheld_by_name.get(name, [])
        columns = reported(document, ("not_reported", name), withheld, posed, defects)
        known_defects = len(defects)
        history = read_answer(path, posed, columns, defects) if columns else None
        if is_later and (history is not None or len(defects) > known_defects):
            later.append(path.name)
        if history is not None:
            answers[name] = Answer(name, posed, history, tuple(withheld))
    if later:
        more = f" and {len(later) - 1} more" if len(later) > 1 else ""
        rule = f"must be {PACK}, from which on the pack holds {later[0]}{more}"
        defects.add(document.place(("pack",)), rule, field="pack", value=repr(pack))
    for field in ("not_reported", "step_s"):
        _check_problems(document, field, digests, names, defects)
    order = [*names_of_pack(), *sorted(set(answers) - set(names_of_pack()))]
    return tuple(answers[name] for name in order if name in answers)


def _check_problems(document: Document, field: str, digests: Any, tables: Sequence[str], defects: Defects) -> None:
    """Add a defect for each problem that a field names and no table answers."""
    stated = document.content.get(field)
    for name in stated if isinstance(stated, dict) else ():
        place = document.place((field, name), of_key=True)
        if name not in digests and name not in packs()[PACK]:
            rule = f"{name}: must be among {', '.join(digests)}"
            defects.add(place, rule, field=field, advice=did_you_mean(name, digests))
        elif name + TABLE not in tables:
            defects.add(place, f"{name}: must have a table {name}{TABLE}", field=field, value="no such file")


def _check_place(root: Path, answer_set: AnswerSet, in_layout: bool, defects: Defects) -> None:
    """Add a defect where a folder of a layout does not lie where its program, version and settings say."""
    if not in_layout:
        return
    if not isinstance(answer_set.data, AnswersData):
        defects.add(Place(answer_set.place / FILE), "must be a folder of answers", field="format", advice=EXPORT)
    elif answer_set.place.relative_to(root).parts != answer_set.address:
        rule = f"must lie in {'/'.join(answer_set.address)}, by its program, version and settings_name"
        defects.add(Place(answer_set.place), rule)


def _check_once(sets: Sequence[AnswerSet], defects: Defects) -> None:
    """Add a defect for each folder that stands for the same program, version and settings as another."""
    known: dict[tuple[object, ...], Path] = {}
    for answer_set in sets:
        names = tuple(answer.name for answer in answer_set.answers)
        settings_key = () if isinstance(answer_set.data, AnswersData) else (answer_set.data.settings, *names)
        key = (*answer_set.address, *settings_key)
        if key in known:
            rule = "must have another settings_name, or another version"
            defects.add(Place(answer_set.place / FILE), rule, value=f"those of {known[key]}")
        known.setdefault(key, answer_set.place)


# ---- keeping --------------------------------------------------------------------------------------------------------


def keep(sets: Sequence[AnswerSet], layout: Path) -> list[Path]:
    """Copy folders of answers into a layout, and return their places there; one that is there already stays.

    Raises
    ------
    InputError
        Another answer is kept in its place, or a folder is no folder of answers, or it cannot be written.
    """
    for answer_set in sets:
        if not isinstance(answer_set.data, AnswersData):
            raise InputError(
                "must be a folder of answers, to be kept",
                source=answer_set.place / FILE,
                field="format",
                value=repr(answer_set.data.format),
                advice=EXPORT,
            )
        place = layout.joinpath(*answer_set.address)
        if place.exists() and not _same_files(answer_set, place):
            raise InputError(
                "holds another answer, which is not overwritten",
                source=place,
                advice="another settings_name or version says which is which",
            )
    places = []
    for answer_set in sets:
        place = layout.joinpath(*answer_set.address)
        places.append(place)
        if place.exists():
            continue
        with atomic_directory(place) as new:
            for path in _kept_files(answer_set):
                shutil.copyfile(path, new / path.name)
    return places


def _kept_files(answer_set: AnswerSet) -> list[Path]:
    return [answer_set.place / FILE, *(answer_set.place / f"{answer.name}{TABLE}" for answer in answer_set.answers)]


def _same_files(answer_set: AnswerSet, place: Path) -> bool:
    """Whether a place holds the files of a folder of answers and no other answer."""
    if not place.is_dir():
        return False
    files = {path.name: path.read_bytes() for path in _kept_files(answer_set)}
    present_files = {path.name: path.read_bytes() for path in [place / FILE, *_tables(place)] if path.is_file()}
    return files == present_files
