"""The committed record of errors and work counts of the study `work-precision`, and how a run compares with it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, NotRequired

from pydantic import Field
from typing_extensions import TypedDict

from validation.engine.finished import Derived, Finished
from validation.errors import InputError
from validation.gates.gate import Gate
from validation.metrics.pairs import relative_l2
from validation.runs import strict
from validation.runs.files import write_atomically
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.row import Value
from validation.studies.bands import OWN, about

PATH = Path(__file__).with_name("record.json")
REFERENCES = {"dda": "bar", "fem": "bar", "bar": "continuum"}
WORK = ("unknowns", "factorisations", "solves")
SLACK = {"errors": 0.02, "work": 0.15}  # other libraries round otherwise, and may ask for one check of a space more
ROUNDING = 1e-10  # an error below is rounding
Entry = Mapping[str, Any]


class _Entry(TypedDict):
    errors: dict[str, Annotated[float, Field(ge=0)] | str]
    work: dict[str, Annotated[float, Field(ge=0)]]
    seconds: dict[str, float]


class _Record(TypedDict):
    cases: dict[str, _Entry]
    reasons: NotRequired[list[str]]


def load() -> dict[str, Any]:
    """Return the record.

    Raises
    ------
    InputError
        There is none, or it cannot be read.
    """
    try:
        record: dict[str, Any] = strict.read(PATH, _Record, "write it with --update-record", "a record")
    except FileNotFoundError as error:
        raise InputError(f"the record of errors and work cannot be read: {error.strerror}", source=PATH) from None
    return record


def measured(finished: Finished, cases: Sequence[tuple[str, str]]) -> dict[str, dict[str, Any]]:
    """Return errors against the case's reference, work counts and seconds of every case, by its name and solver."""
    return {f"{case} {solver}": _entry(finished, case, solver) for case, solver in cases}


def _entry(finished: Finished, case: str, solver: str) -> dict[str, Any]:
    row = finished.rows[case, solver]
    history = finished.history(case, solver)
    reference = finished.history(case, REFERENCES.get(solver, ""))
    errors: dict[str, Value] = {}
    if history is not None and reference is not None:
        for column in (DISPLACEMENT, PRESSURE):
            value = relative_l2(history.columns[column], reference.columns[column])
            errors[column] = float(f"{value:.3e}") if isinstance(value, float) else value
    work = {name: row.work[name] for name in WORK if name in row.work}
    return {"errors": errors, "work": work, "seconds": dict(row.seconds)}


def ratios(current: Mapping[str, Entry], committed: Mapping[str, Entry]) -> dict[str, float]:
    """Return the worst ratio of an error, and of a work count, to the recorded one, over the cases of both.

    A number that only one of them has, or that is undefined, is infinitely worse; a part in which nothing can be
    compared is absent.
    """
    ratios_by_part: dict[str, list[float]] = {}
    for name in committed.keys() & current.keys():
        for part, floor in (("errors", ROUNDING), ("work", 1)):
            numbers = current[name][part]
            recorded = committed[name][part]
            ratios_by_part.setdefault(part, []).extend(
                _ratio(numbers.get(key), recorded.get(key), floor) for key in numbers.keys() | recorded.keys()
            )
    return {part: max(values) for part, values in ratios_by_part.items() if values}


def _ratio(now: Value, then: Value, floor: float) -> float:
    if not isinstance(now, int | float) or not isinstance(then, int | float):
        return math.inf
    return max(now, floor) / max(then, floor)


def compare(finished: Finished, cases: Sequence[tuple[str, str]], committed: Mapping[str, Entry]) -> dict[str, float]:
    """Return the worst ratios to the record.

    Raises
    ------
    ValueError
        A case is not recorded, or the record holds one that is not there.
    """
    current = measured(finished, cases)
    if not current.keys() & committed.keys():
        raise ValueError("holds no case of the study work-precision; nothing was compared")
    unrecorded = current.keys() - committed.keys()
    missing = committed.keys() - current.keys()
    for names, defect in ((unrecorded, "lacks"), (missing, "alone holds")):
        if names:
            raise ValueError(f"{defect} {len(names)} cases, such as {min(names)}; write it anew with --update-record")
    return ratios(current, committed)


def compared(cases: tuple[tuple[str, str], ...]) -> Derived:
    """Return the row that compares a run with the record."""

    def compute(finished: Finished) -> Mapping[str, Value]:
        worst_ratios = compare(finished, cases, load()["cases"])
        return {f"record.{part}": value for part, value in worst_ratios.items()}

    return Derived("work-precision", "record", cases, compute)


def gates() -> Iterator[Gate]:
    """Yield the gates on the record."""
    for part, slack in SLACK.items():
        why = (
            f"worst ratio of {part} to the committed record ({PATH.name} beside this study): no case may be worse, "
            "and where all are better `dda-validate record --update-record` is due"
        )
        yield Gate("work-precision", ("record",), f"record.{part}", *about(1, slack), why, OWN)


def update(finished: Finished, cases: Sequence[tuple[str, str]], reason: str) -> None:
    """Write the record with the reason for it.

    Raises
    ------
    InputError
        The reason is missing, or a case that did not complete has nothing to record.
    """
    if not reason.strip():
        raise InputError("must say why the record changes", field="--reason", value="nothing")
    reasons = [*(load()["reasons"] if PATH.exists() else []), reason.strip()]
    entries = measured(finished, cases)
    for name, entry in entries.items():
        if not entry["work"] or any(isinstance(value, str) for value in entry["errors"].values()):
            raise InputError(
                "must have completed with errors and work that are numbers", field=name, advice="nothing was written"
            )
    data = {"reasons": reasons, "cases": entries}
    text = json.dumps(data, indent=1, sort_keys=True) + "\n"
    write_atomically(PATH, lambda stream: stream.write(text.encode()))
