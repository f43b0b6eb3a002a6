"""The problem pack: every problem as JSON, its exact motion as CSV, and what a submission has to look like."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from validation.errors import InputError
from validation.problems.bands import Band, Standard, standard
from validation.problems.data import (
    ANSWERS,
    PACK,
    SUBMISSION,
    AnswersData,
    ColumnOfAnswer,
    NumberData,
    ProblemData,
    SamplingData,
    SubmissionData,
    meaning,
    united,
)
from validation.problems.packs import digest, parts
from validation.problems.problem import PROBLEMS, Problem, problem
from validation.problems.questions import BoxQuestion, Question, box_questions
from validation.runs.files import write_atomically
from validation.runs.history import History

Progress = Callable[[int, int, str], None]
PAGE = Path(__file__).with_suffix(".md")  # of the pack, to be filled in
MEASURE = "norm(answer - exact) / norm(exact), over the instants up to until_s"
TIME = "time_s"
DIALECT = "https://json-schema.org/draft/2020-12/schema"  # of pydantic's schemas
TEMPLATE = {  # what a submitter changes
    "program": "name of the program",
    "version": "its version",
    "settings": "time step, integrator, contact model, damping: what another user would need to repeat it",
    "who": "who ran it",
    "not_reported": [],
}
ANSWERS_TEMPLATE: Mapping[str, Any] = {
    "program": TEMPLATE["program"],
    "version": TEMPLATE["version"],
    "settings_name": "default",
    "settings": "damping, tolerances, iterations: what another user would need to repeat it",
    "scheme": "its time scheme, or event-driven",
    "step_s": "its time step, a number [s]; an object where it differs by problem; null where there is none",
    "contact_model": "what its contacts are made of, and their parameters",
    "processor": "the processor it ran on",
    "who": TEMPLATE["who"],
    "licence": "of these answers, such as CC-BY-4.0",
    "link": None,
    "not_reported": {},
}
CHOSEN = ("settings_name",)  # of these, what may stay as the template has it


def problem_data(posed: Problem, reference: Standard) -> ProblemData:
    """Return a problem as plain data."""
    judged = tuple(_judged(column, reference.bands[column]) for column in posed.columns)
    return _data(posed, judged, exact=f"exact/{posed.name}.csv")


def box_problem_data(question: BoxQuestion) -> ProblemData:
    """Return a problem of rigid boxes as plain data."""
    numbers = []
    for quantity in question.quantities:
        band = {"exact": quantity.exact, "low": quantity.low, "high": quantity.high}
        numbers.append(NumberData(name=quantity.name, unit=quantity.unit, reason=quantity.reason, **band))
    columns = tuple(ColumnOfAnswer(name=united(column), meaning=meaning(column)) for column in question.columns)
    return _data(question, columns, numbers=tuple(numbers), exact=None)


def _data(question: Question, columns: tuple[ColumnOfAnswer, ...], **others: Any) -> ProblemData:
    return ProblemData(
        problem=question.name,
        digest=digest(question),
        title=question.title,
        asks=question.asks,
        **parts(question.scene),
        sampling=SamplingData(step_s=question.scene.time.step, count=len(question.instants)),
        answer=columns,
        **others,
    )


def _judged(column: str, band: Band) -> ColumnOfAnswer:
    return ColumnOfAnswer(
        name=united(column),
        meaning=meaning(column),
        measure=MEASURE,
        until_s=band.until,
        low=0.0,
        high=band.high,
        reason=band.reason,
    )


def check_place(directory: Path) -> None:
    """Refuse a place whose files are not those of a pack, which is replaced as a whole.

    Raises
    ------
    InputError
        It is a file, or a directory of other files.
    """
    if directory.exists() and not directory.is_dir():
        raise InputError("must be a directory", source=directory, value="a file")
    readme = directory / "README.md"
    if not directory.is_dir() or not any(directory.iterdir()):
        return
    title = PAGE.read_text(encoding="utf-8").splitlines()[0].encode()
    if not readme.is_file() or not readme.read_bytes().startswith(title):
        raise InputError(
            "must be a new or empty directory or an earlier pack", source=directory, value="one with other files"
        )


def write_pack(place: Path, progress: Progress = lambda number, total, label: None) -> int:
    """Write the problems into the directory of a pack, and return how many there are.

    Parameters
    ----------
    place
        Directory of the pack, which is made.
    progress
        Told before each problem: how many are done, of how many, and which is next.

    Raises
    ------
    InputError
        The directory cannot be made or written.
    """
    rows = []
    for number, name in enumerate(PROBLEMS):
        progress(number, len(PROBLEMS), name)
        posed = problem(name)
        reference = standard(posed)
        data = problem_data(posed, reference)
        _write(place / f"{name}.json", _json(data.model_dump(mode="json")))
        _write(place / str(data.exact), table_of(reference.exact, posed.scene.run.columns))
        blank = {"format": SUBMISSION, "pack": PACK, "problem": name, **TEMPLATE}
        _write(place / "submissions" / name / "submission.json", _json(blank))
        _write(place / "answers" / f"{name}.csv", blank_table(posed))
        rows.append(f"| `{name}` | {posed.asks} | {', '.join(f'`{c.name}`' for c in data.answer)} |")
    for name, box_question in box_questions().items():
        data = box_problem_data(box_question)
        _write(place / f"{name}.json", _json(data.model_dump(mode="json")))
        _write(place / "answers" / f"{name}.csv", blank_table(box_question))
        columns = ", ".join(f"`{column.name}`" for column in data.answer[:3])
        more = " and those of the other boxes" if len(data.answer) > 3 else ""
        rows.append(f"| `{name}` | {data.asks} | {columns}{more} |")
    _write(place / "answers" / "submission.json", _json({"format": ANSWERS, "pack": PACK, **ANSWERS_TEMPLATE}))
    for data_of in (ProblemData, SubmissionData, AnswersData):
        stem = data_of.__name__.removesuffix("Data").lower()
        _write(place / f"{stem}.schema.json", _json({"$schema": DIALECT} | data_of.model_json_schema()))
    table = "\n".join(["| problem | what it asks | columns |", "|---|---|---|", *rows])
    readme = PAGE.read_text(encoding="utf-8")
    _write(place / "README.md", readme.format(pack=PACK, table=table))
    return len(PROBLEMS) + len(box_questions())


def table_of(motion: History, columns: Iterable[str]) -> str:
    """Return a motion as CSV under the pack's names, with all digits."""
    names = list(columns)
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([TIME, *map(united, names)])
    writer.writerows(np.column_stack([motion.time, *(motion.columns[name] for name in names)]).tolist())
    return text.getvalue()


def blank_table(question: Question) -> str:
    """Return the table of an answer to fill in: header and instants."""
    columns = question.columns
    lines = [",".join([TIME, *map(united, columns)])]
    lines += [format(instant, ".9g") + "," * len(columns) for instant in question.instants]
    return "\n".join(lines) + "\n"


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _write(path: Path, text: str) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"cannot be made: {error.strerror}", source=path.parent, advice="choose another place"
        ) from None
    write_atomically(path, lambda stream: stream.write(text.encode()))
