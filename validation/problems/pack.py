"""The problem pack: every problem as JSON, its exact motion as CSV, and what a submission has to look like."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from validation.errors import InputError
from validation.problems.bands import Band, Standard, standard
from validation.problems.data import (
    PACK,
    SUBMISSION,
    ColumnOfAnswer,
    ProblemData,
    SamplingData,
    SubmissionData,
    block_data,
    column_data,
    contact_data,
    load_data,
    meaning,
    united,
)
from validation.problems.problem import PROBLEMS, Problem, problem
from validation.runs.files import write_atomically
from validation.runs.history import History

Progress = Callable[[int, int, str], None]
PLACE = "problems"  # directory of a pack that holds this part
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


def problem_data(one: Problem, reference: Standard) -> ProblemData:
    """Return a problem as plain data."""
    scene = one.scene
    judged = [_judged(column, reference.bands[column]) for column in scene.run.columns]
    on_base = scene.column is None
    return ProblemData(
        problem=one.name,
        title=one.title,
        asks=one.asks,
        block=block_data(scene) if on_base else None,
        contact=contact_data(scene) if on_base else None,
        load=load_data(scene) if on_base else None,
        geometry="large rotation" if scene.run.geometry == "updated" else "small",
        column=column_data(scene),
        sampling=SamplingData(step_s=scene.time.step, count=len(reference.exact.time)),
        answer=tuple(judged),
        exact=f"exact/{one.name}.csv",
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


def write_problems(directory: Path, progress: Progress = lambda number, total, label: None) -> int:
    """Write the problems into `problems` of a pack's directory, and return how many there are.

    Parameters
    ----------
    directory
        Of the pack.
    progress
        Told before each problem: how many are done, of how many, and which is next.

    Raises
    ------
    InputError
        The directory cannot be made or written.
    """
    place, rows = directory / PLACE, []
    for number, name in enumerate(PROBLEMS):
        progress(number, len(PROBLEMS), name)
        one = problem(name)
        reference = standard(one)
        data = problem_data(one, reference)
        _write(place / f"{name}.json", _json(data.model_dump(mode="json")))
        _write(place / data.exact, table_of(reference.exact, one.scene.run.columns))
        blank = {"format": SUBMISSION, "pack": PACK, "problem": name, **TEMPLATE}
        _write(place / "submissions" / name / "submission.json", _json(blank))
        rows.append(f"| `{name}` | {one.asks} | {', '.join(f'`{c.name}`' for c in data.answer)} |")
    for data_of in (ProblemData, SubmissionData):
        stem = data_of.__name__.removesuffix("Data").lower()
        _write(place / f"{stem}.schema.json", _json({"$schema": DIALECT} | data_of.model_json_schema()))
    table = "\n".join(["| problem | what it asks | columns |", "|---|---|---|", *rows])
    readme = Path(__file__).with_suffix(".md").read_text(encoding="utf-8")
    _write(place / "README.md", readme.format(pack=PACK, table=table))
    return len(PROBLEMS)


def table_of(motion: History, columns: Iterable[str]) -> str:
    """Return a motion as CSV under the pack's names, with all digits."""
    names = list(columns)
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([TIME, *map(united, names)])
    writer.writerows(np.column_stack([motion.time, *(motion.columns[name] for name in names)]).tolist())
    return text.getvalue()


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
