"""Answers of programs to problems: what they hold, and how folders of them are read, all defects at once, and kept.

The layout: `submissions/PROGRAM/VERSION/SETTINGS/submission.json` and, beside it, a `PROBLEM.csv` for each problem.
"""

from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.errors import InputError
from validation.gates.gate import Status
from validation.problems.bands import standard
from validation.problems.data import PACK, AnswersData, folder_name
from validation.problems.packs import packs, stale
from validation.problems.problem import Problem, ProblemHooks, problem
from validation.problems.problem import names as names_of_pack
from validation.problems.stated import checked, read_document
from validation.runs.defects import Defects, Place
from validation.runs.files import atomic_directory
from validation.runs.history import History
from validation.runs.progress import Progress
from validation.scenes.unknown import did_you_mean
from validation.solvers.foreign import differences
from validation.solvers.history_table import AS_NAMED, HeaderNames, read_table

FILE = "submission.json"
EXPORT = "dda-validate export-pack DIR writes the problems, and files to fill in"
ABSENT = f"not_reported in {FILE} is for what the program cannot report"
UNANSWERED = "must hold the table of a problem"
DEEPEST = 4  # folders between the one that is named and a folder of answers
TABLE = ".csv"


@dataclass(frozen=True, eq=False)
class Answer:
    """An answer to a problem, or why there is none."""

    name: str  # of the problem
    problem: Problem | None  # None where it is one of an earlier pack
    history: History | None  # the columns that are reported; None where there is no answer to judge
    status: Status | None = None  # where there is no history: stale, NOT RUN, not applicable, or FAIL
    reason: str = ""  # of that status
    warnings: tuple[str, ...] = ()  # what makes a verdict worth less, in sentences
    seconds: float | None = None  # that a run took; None where nothing was run


@dataclass(frozen=True, eq=False)
class AnswerSet:
    """What one program answers with one choice of settings."""

    place: Path
    data: AnswersData
    answers: tuple[Answer, ...]  # in the order of the pack

    @property
    def program(self) -> str:
        """Program and version."""
        return f"{self.data.program} {self.data.version}".rstrip()

    @property
    def title(self) -> str:
        """Program, version and settings."""
        return f"{self.program} {self.data.settings_name}".rstrip()

    @property
    def address(self) -> tuple[str, str, str]:
        """Names of the three folders of the layout."""
        return folder_name(self.data.program), folder_name(self.data.version), self.data.settings_name

    @property
    def stem(self) -> str:
        """What the names of its files have in common; names of folders hold no underscore."""
        return "_".join(filter(None, self.address))


# ---- reading ----


def read_sets(
    root: Path,
    in_layout: bool = False,
    progress: Progress = lambda number, total, label: None,
    own: Mapping[str, Problem] | None = None,
) -> list[AnswerSet]:
    """Read all folders of answers at or at most `DEEPEST` levels below a directory.

    `in_layout` says whether each has to lie in its own place, `PROGRAM/VERSION/SETTINGS`. `progress` is told before
    each folder how many are read. `own` are the problems that are answered, by the names of their tables; those of the
    pack by default.

    Raises
    ------
    DefectsError
        Something is wrong; every defect of all files is named.
    """
    defects = Defects()
    folders = list(_folders(root))
    if not folders:
        raise InputError(f"must be a directory with {FILE} and CSV files, or of such", source=root, advice=EXPORT)
    sets: list[AnswerSet] = []
    places: dict[tuple[str, str, str], Path] = {}
    for number, folder in enumerate(folders):
        progress(number, len(folders), f"reading {folder.name}")
        try:
            answer_set = _read_set(folder, own, defects)
        except InputError as error:
            defects.take(error)
            continue
        if answer_set is None:
            continue
        sets.append(answer_set)
        if in_layout and folder.relative_to(root).parts != answer_set.address:
            rule = f"must lie in {'/'.join(answer_set.address)}, by its program, version and settings_name"
            defects.add(Place(folder), rule)
        first = places.setdefault(answer_set.address, folder)
        if first != folder:
            rule = "must have another settings_name, or another version"
            defects.add(Place(folder / FILE), rule, value=f"those of {first}")
    if not sets and not len(defects):
        defects.add(Place(root), UNANSWERED, value="none that is asked")
    defects.check()
    return sets


def _folders(root: Path) -> Iterator[Path]:
    """Yield the folders with a file of metadata or with tables, in the order of their names."""
    for directory, names, files in os.walk(root):
        depth = len(Path(directory).relative_to(root).parts)
        names[:] = sorted(name for name in names if not name.startswith(".")) if depth < DEEPEST else []
        if FILE in files or any(map(_is_table, map(Path, files))):
            yield Path(directory)


def _is_table(path: Path) -> bool:
    return path.suffix.lower() == TABLE and not path.name.startswith(".")


def _tables(folder: Path) -> list[Path]:
    return sorted(filter(_is_table, folder.iterdir()))


def _read_set(folder: Path, own: Mapping[str, Problem] | None, defects: Defects) -> AnswerSet | None:
    """Return what a folder answers; None where that is nothing asked, or, with the defects, something is wrong."""
    before = len(defects)
    content = read_document(folder / FILE, EXPORT, defects)
    pack = content.get("pack")
    if pack is not None and pack not in packs():
        rule = f"must be one of {', '.join(packs())}, this pack and earlier ones"
        defects.add(Place(folder / FILE), rule, field="pack", value=repr(pack), advice=EXPORT)
        pack = None
    data = checked(folder / FILE, content, defects)
    # tables of an unknown pack are checked by this one, so that all defects are told at once
    answers = _answers(folder, content, pack or PACK, own, defects)
    if len(defects) == before and not answers and own is None:
        defects.add(Place(folder), UNANSWERED, value="none that is filled in")
    return AnswerSet(folder, data, answers) if data is not None and answers and len(defects) == before else None


def _answers(
    folder: Path, content: Mapping[str, Any], pack: str, own: Mapping[str, Problem] | None, defects: Defects
) -> tuple[Answer, ...]:
    """Return the answers of a folder's tables; a table that is not filled in is none."""
    place = Place(folder / FILE)
    asked_then = packs()[pack]
    known: dict[str, Any] = {**asked_then, **packs()[PACK], **(own or {})}
    withheld_by_name = content.get("not_reported")
    if not isinstance(withheld_by_name, dict):
        withheld_by_name = {}
    answers: dict[str, Answer] = {}
    tables = {path.name.removesuffix(TABLE): path for path in _tables(folder)}
    for name, path in tables.items():
        if name not in known:
            advice = did_you_mean(name.lower(), known, TABLE) or f"problems are {', '.join(known)}"
            rule = f"must be named after a problem of pack {pack}, or one that is asked"
            defects.add(Place(path), rule, value=path.name, advice=advice)
            continue
        if own is not None and name not in own:
            continue
        reason = stale(pack, name) if name in asked_then else None
        if reason is not None:
            answers[name] = Answer(name, None, None, Status.STALE, reason)
            continue
        posed = problem(name) if own is None else own[name]
        columns = _reported(place, f"not_reported.{name}", withheld_by_name.get(name, []), posed, defects)
        history = read_answer(path, posed, defects, columns) if columns else None
        if history is None:
            continue
        answers[name] = Answer(name, posed, history)
        if name in packs()[PACK] and name not in asked_then and not defects.has(place.path, "pack"):
            rule = f"must be {PACK}, since the stated pack does not hold {path.name} yet"
            defects.add(place, rule, field="pack", value=repr(pack))
    for field in ("not_reported", "step_s"):
        _check_problems(place, field, content.get(field), known, tables, defects)
    return tuple(answers[name] for name in dict.fromkeys([*names_of_pack(), *answers]) if name in answers)


def _reported(place: Place, field: str, withheld: object, posed: Problem, defects: Defects) -> list[str]:
    """Return the columns of the history that a table has to hold; none, and the defects, where that is not clear."""
    if not isinstance(withheld, Sequence) or isinstance(withheld, str):  # a defect of its type, which is known
        return []
    names = [posed.named(column) for column in posed.columns]
    before = len(defects)
    for name in withheld:
        if name not in names:
            defects.add(place, f"must be among {', '.join(names)}", field=field, value=repr(name))
    remaining = [column for column in posed.columns if posed.named(column) not in withheld]
    if not remaining:
        rule = "must leave a column to judge"
        defects.add(place, rule, field=field, value=f"all of {', '.join(names)}")
    return remaining if len(defects) == before else []


def _check_problems(
    place: Place, field: str, stated: object, known: Collection[str], tables: Collection[str], defects: Defects
) -> None:
    """Add a defect for each problem that a field names and no table answers."""
    for name in stated if isinstance(stated, dict) else ():
        if name not in known:
            rule = f"{name}: must be among {', '.join(known)}"
            defects.add(place, rule, field=field, advice=did_you_mean(name, known))
        elif name not in tables:
            defects.add(place, f"{name}: must have a table {name}{TABLE}", field=field, value="no such file")


def read_tables(place: Path, problems: Sequence[Problem], header: HeaderNames = AS_NAMED) -> AnswerSet:
    """Return the answers of a table, or of a directory with a table ``PROBLEM.csv`` each, of which nothing is stated.

    `header` says what the tables call their columns. Defects are raised as by `read_sets`.
    """
    if not place.is_dir() and len(problems) != 1:
        rule = "must name the one problem or scene that a table answers"
        raise InputError(rule, field="asked", value=f"{len(problems)} of them", advice="dda-validate judge FILE locked")
    defects = Defects()
    answers = []
    for posed in problems:
        path = place / f"{posed.name}{TABLE}" if place.is_dir() else place
        if path.exists():
            history = read_answer(path, posed, defects, header=header)
            if history is not None:
                answers.append(Answer(posed.name, posed, history))
    if not answers and not len(defects):
        rule = "must hold an answer" if place.is_file() else "must be a directory with PROBLEM.csv"
        raise InputError(rule, source=place, value="none that is filled in", advice=EXPORT)
    defects.check()
    return AnswerSet(place, stated_by(place.stem), tuple(answers))


def stated_by(program: str, **fields: Any) -> AnswersData:
    """Return what is known of answers beside their program, where no file states it: what is not is empty."""
    nothing = dict.fromkeys(AnswersData.model_fields, "")
    plain: dict[str, Any] = {"pack": PACK, "step_s": None, "link": None, "not_reported": {}}
    return AnswersData.model_construct(**{**nothing, **plain, "program": program, **fields})


# ---- one table ----


def read_answer(
    path: Path,
    posed: Problem,
    defects: Defects,
    columns: Sequence[str] | None = None,
    header: HeaderNames = AS_NAMED,
) -> History | None:
    """Return the answer that a table holds; None where it has defects, or where it is blank.

    The table has to hold `columns`, all of the problem by default, which it calls as `header` says; `defects` takes
    what is wrong.
    """
    required = posed.columns if columns is None else columns
    units = {column: posed.unit(column) for column in (*required, *posed.further_columns)}
    advice = dict.fromkeys(required, ABSENT)
    table = read_table(path, posed.instants, units, required, defects, advice, header=header)
    if table is None:
        return None
    before = len(defects)
    for column, difference in _differences(table.history, posed):
        cell = table.header[column]
        defects.add(Place(path, cell.line, cell.column), difference, field=cell.text)
    return table.history if len(defects) == before else None


def _differences(history: History, posed: Problem) -> Iterator[tuple[str, str]]:
    """Yield the columns that are the exact ones, or begin where they do, in another unit or of another sign."""
    other_units = ProblemHooks.of(posed.scene).other_units(posed.scene, history)
    if other_units is not None:
        yield from other_units
        return
    for column, difference in differences(posed.scene, history.columns, standard(posed).exact.columns):
        yield column, difference.replace(column, "it", 1)


# ---- keeping ----


def keep(sets: Sequence[AnswerSet], layout: Path) -> list[Path]:
    """Copy folders of answers into a layout, and return their places there; one that is there already stays.

    Raises
    ------
    InputError
        Another answer is kept in its place, or it cannot be written.
    """
    for answer_set in sets:
        if not (answer_set.place / FILE).is_file():
            raise InputError("must be a folder of answers, to be kept", source=answer_set.place, advice=EXPORT)
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
    names = [path.name for path in [*_kept_files(answer_set), *_tables(place)]]
    same, _, _ = filecmp.cmpfiles(answer_set.place, place, names, shallow=False)
    return same == names
