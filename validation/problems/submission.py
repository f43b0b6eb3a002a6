"""A submission: a directory with one table and `submission.json`, an answer to one problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from validation.errors import InputError
from validation.problems.answer_table import read_answer
from validation.problems.data import PACK, SubmissionData, united
from validation.problems.defects import Defects, Place
from validation.problems.pack import TEMPLATE
from validation.problems.packs import packs, stale
from validation.problems.problem import Problem, problem
from validation.problems.questions import Question, box_questions
from validation.problems.stated import Document, checked, read_document
from validation.runs.history import History
from validation.scenes.unknown import did_you_mean

FILE = "submission.json"
EXPORT = "dda-validate export-pack DIR writes the problems, and files to fill in"


@dataclass(frozen=True, eq=False)
class Submission:
    """What was submitted, read and checked."""

    data: SubmissionData
    problem: Problem
    history: History  # of the columns that are reported


def read_submission(directory: Path, own_problem: Problem | None = None) -> Submission:
    """Read a submission to a problem of the pack, or to one of the caller's own.

    Raises
    ------
    DefectsError
        A file or a field is missing or wrong; every defect is named.
    """
    if not directory.is_dir():
        raise InputError(f"must be a directory with {FILE} and CSV files", source=directory, advice=EXPORT)
    defects = Defects()
    document = read_document(directory / FILE, EXPORT)
    check_pack(document, defects)
    data = checked(document, SubmissionData, TEMPLATE, defects)
    stated = document.content.get("problem")
    posed = own_problem
    if own_problem is not None:
        if stated is not None and stated != own_problem.name:
            place = document.place(("problem",))
            rule = f"must be {own_problem.name!r}, the scene's name"
            defects.add(place, rule, field="problem", value=repr(stated))
    elif isinstance(stated, str):
        posed = _problem_of_pack(document, stated, defects)
    history = None
    if posed is not None:
        withheld = document.content.get("not_reported", [])
        columns = reported(document, ("not_reported",), withheld, posed, defects)
        table = _table(directory, defects)
        if table is not None and columns:
            history = read_answer(table, posed, columns, defects)
            if history is None and not len(defects):
                defects.add(Place(table), "must hold an answer", value="instants alone")
    defects.check()
    if data is None or posed is None or history is None:
        raise InputError("must be an answer to a problem", source=directory)
    return Submission(data, posed, history)


def check_pack(document: Document, defects: Defects) -> str | None:
    """Return the version of the pack that a document answers, None and the defect where there is no such one."""
    pack = document.content.get("pack")
    if pack is None or pack in packs():
        return pack
    rule = f"must be one of {', '.join(packs())}, this pack and earlier ones"
    defects.add(document.place(("pack",)), rule, field="pack", value=repr(pack), advice=EXPORT)
    return None


def _problem_of_pack(document: Document, name: str, defects: Defects) -> Problem | None:
    """Return the problem that a submission answers, None and the defect where it is none of this pack."""
    stated_pack = str(document.content.get("pack"))
    pack = stated_pack if stated_pack in packs() else PACK  # by which the table is checked all the same
    place = document.place(("problem",))
    names = packs()[pack]
    if name in box_questions():
        rule = "is answered in a folder of answers"
        defects.add(place, rule, field="problem", value=repr(name), advice=EXPORT)
        return None
    if name not in names:
        advice = did_you_mean(name, names)
        defects.add(place, f"must be among {', '.join(names)}", field="problem", value=repr(name), advice=advice)
        return None
    reason = stale(pack, name)
    if reason is not None:
        defects.add(place, f"is stale: {reason}", field="problem", value=repr(name), advice=EXPORT)
        return None
    return problem(name)


def reported(
    document: Document, address: tuple[str, ...], withheld: object, posed: Question, defects: Defects
) -> list[str]:
    """Return the columns of the history that a table has to hold; none, and the defects, where that is not clear."""
    if not isinstance(withheld, Sequence) or isinstance(withheld, str):  # a defect of its type, which is known
        return []
    columns = posed.columns
    names = [united(column) for column in columns]
    field = ".".join(address)
    before = len(defects)
    for i, name in enumerate(withheld):
        place = document.place((*address, i))
        if name not in names:
            defects.add(place, f"must be among {', '.join(names)}", field=field, value=repr(name))
        elif name in withheld[:i]:
            defects.add(place, "must not repeat a column", field=field, value=repr(name))
    remaining = [column for column in columns if united(column) not in withheld]
    if not remaining:
        rule = "must leave a column to judge"
        defects.add(document.place(address), rule, field=field, value=f"all of {', '.join(names)}")
    return remaining if len(defects) == before else []


def _table(directory: Path, defects: Defects) -> Path | None:
    try:  # a name that begins with a point is the system's, not the submitter's
        tables = sorted(p for p in directory.iterdir() if p.suffix.lower() == ".csv" and not p.name.startswith("."))
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=directory) from None
    if len(tables) == 1:
        return tables[0]
    listed = ", ".join(path.name for path in tables) or "none"
    defects.add(Place(directory), f"must hold one CSV file beside {FILE}", value=listed)
    return None
