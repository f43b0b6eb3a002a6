"""The problem pack: every problem as JSON, its exact motion as CSV, and what an answer has to look like."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.problems.bands import standard
from validation.problems.data import (
    ANSWERS,
    PACK,
    AnswersData,
    ColumnOfAnswer,
    NumberData,
    ProblemData,
    SamplingData,
)
from validation.problems.packs import digest
from validation.problems.problem import Problem, names, problem
from validation.runs.columns import kind_of, split
from validation.runs.files import csv_text, write_new
from validation.runs.history import Array, History
from validation.runs.progress import Progress
from validation.scenes.plain import scene_data, words

PAGE = Path(__file__).with_suffix(".md")  # of the pack, to be filled in
MEASURE = "norm(answer - exact) / norm(exact), over the instants up to until_s"
TIME = "time_s"
NUMBERS = ("problem", "name", "unit", "exact", "low", "high")  # of the table of numbers that are judged
MARK = "problem.schema.json"  # a file that every pack has
DIALECT = "https://json-schema.org/draft/2020-12/schema"  # of pydantic's schemas
MOST_NAMED = 7  # columns of a problem that the page names
ANSWERS_TEMPLATE: Mapping[str, Any] = {
    "program": "name of the program",
    "version": "its version",
    "settings_name": "default",
    "settings": "damping, tolerances, iterations: what another user would need to repeat it",
    "scheme": "its time scheme, or event-driven",
    "step_s": "its time step, a number [s]; an object where it differs by problem; null where there is none",
    "contact_model": "what its contacts are made of, and their parameters",
    "processor": "the processor it ran on",
    "who": "who ran it",
    "licence": "of these answers, such as CC-BY-4.0",
    "link": None,
    "not_reported": {},
}
CHOSEN = ("settings_name",)  # of these, what may stay as the template has it


def problem_data(posed: Problem) -> ProblemData:
    """Return a problem as plain data."""
    numbers = [number for number in posed.numbers if not number.optional]
    return ProblemData(
        problem=posed.name,
        digest=digest(posed),
        title=posed.title,
        asks=posed.asks,
        scene=scene_data(posed.scene),
        sampling=SamplingData(step_s=posed.scene.time.step, count=len(posed.instants)),
        answer=tuple(_column_data(posed, column) for column in posed.columns),
        numbers=tuple(NumberData.model_validate(number, from_attributes=True) for number in numbers),
        exact=None if posed.numbers else f"exact/{posed.name}.csv",
    )


def _column_data(posed: Problem, column: str) -> ColumnOfAnswer:
    """Return a column of an answer; with its band where it is judged by the exact motion."""
    kind = kind_of(column, posed.scene.kind.columns)
    meaning = "" if kind is None else kind.meaning.format(n=split(column)[1])
    if posed.numbers:
        return ColumnOfAnswer(name=posed.named(column), meaning=meaning)
    band = standard(posed).bands[column]
    limits: dict[str, Any] = {"until_s": band.until, "low": 0.0, "high": band.high, "reason": band.reason}
    return ColumnOfAnswer(name=posed.named(column), meaning=meaning, measure=MEASURE, **limits)


def write_pack(place: Path, progress: Progress) -> int:
    """Write the problems into the new directory of a pack, and return how many there are."""
    rows = []
    numbers: list[Sequence[str]] = [NUMBERS]
    for number, name in enumerate(names()):
        progress(number, len(names()), name)
        posed = problem(name)
        data = problem_data(posed)
        write_new(place / f"{name}.json", _json(data.model_dump(mode="json")))
        if data.exact is not None:
            write_new(place / data.exact, table_of(posed, standard(posed).exact))
        for judged in data.numbers:
            numbers.append((name, *(str(getattr(judged, column)) for column in NUMBERS[1:])))
        write_new(place / "answers" / f"{name}.csv", blank_table(posed))
        columns = ", ".join(f"`{column.name}`" for column in data.answer[:MOST_NAMED])
        more = " and more" if len(data.answer) > MOST_NAMED else ""
        rows.append(f"| `{name}` | {posed.asks} | {columns}{more} |")
    write_new(place / "exact" / "numbers.csv", csv_text(numbers))
    write_new(place / "answers" / "submission.json", _json({"format": ANSWERS, "pack": PACK, **ANSWERS_TEMPLATE}))
    for data_of in (ProblemData, AnswersData):
        stem = data_of.__name__.removesuffix("Data").lower()
        write_new(place / f"{stem}.schema.json", _json({"$schema": DIALECT} | data_of.model_json_schema()))
    table = "\n".join(["| problem | what it asks | columns |", "|---|---|---|", *rows])
    meanings = "\n".join(["| name | meaning |", "|---|---|", *(f"| `{name}` | {text} |" for name, text in words())])
    readme = PAGE.read_text(encoding="utf-8")
    write_new(place / "README.md", readme.format(pack=PACK, table=table, words=meanings))
    return len(names())


def table_of(posed: Problem, motion: History, columns: Sequence[str] | None = None) -> str:
    """Return a motion as CSV under the pack's names, with all digits; columns are all of the problem by default."""
    names_of_columns = posed.columns if columns is None else columns
    values: list[Array] = [motion.columns[name] for name in names_of_columns]
    return csv_text([[TIME, *map(posed.named, names_of_columns)], *np.column_stack([motion.time, *values]).tolist()])


def blank_table(posed: Problem) -> str:
    """Return the table of an answer to fill in: header and instants."""
    lines = [",".join([TIME, *map(posed.named, posed.columns)])]
    lines += [format(instant, ".9g") + "," * len(posed.columns) for instant in posed.instants]
    return "\n".join(lines) + "\n"


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
