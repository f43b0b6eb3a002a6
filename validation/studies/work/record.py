"""The committed record of errors and work counts of the study `work-precision`, and how a run compares with it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from validation.engine.finished import Derived, Finished
from validation.errors import InputError
from validation.gates.gate import Gate
from validation.metrics.pairs import relative_l2
from validation.runs.files import write_atomically
from validation.runs.history import DISPLACEMENT, PRESSURE
from validation.runs.row import Value

PATH = Path(__file__).resolve().parents[1] / "reports" / "record.json"
REFERENCES = {"dda": "bar", "fem": "bar", "bar": "continuum"}
WORK = ("unknowns", "factorisations", "solves")
SLACK = {"errors": 0.02, "work": 0.15}  # other libraries round otherwise, and may ask for one check of a space more
ROUNDING = 1e-10  # an error below is rounding
Entry = Mapping[str, Any]


def load() -> dict[str, Any]:
    """Return the record; empty where the suite is installed without its reports."""
    return dict(json.loads(PATH.read_text(encoding="utf-8"))) if PATH.exists() else {}


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


def ratios(now: Mapping[str, Entry], then: Mapping[str, Entry]) -> dict[str, float]:
    """Return the worst ratio of an error, and of a work count, to the recorded one."""
    worst = {"errors": 0.0, "work": 0.0}
    for name in then.keys() & now.keys():
        for part, floor in (("errors", ROUNDING), ("work", 1)):
            for key, value in then[name][part].items():
                found = now[name][part].get(key)
                if isinstance(found, int | float) and isinstance(value, int | float):
                    worst[part] = max(worst[part], max(found, floor) / max(value, floor))
    return worst


def compared(cases: tuple[tuple[str, str], ...]) -> Derived:
    """Return the row that compares a run with the record."""

    def compute(finished: Finished) -> Mapping[str, Value]:
        then = load().get("cases", {})
        found = ratios(measured(finished, cases), then)
        return {"record.errors": found["errors"], "record.work": found["work"]} if then else {}

    return Derived("work-precision", "record", cases, compute)


def gates() -> Iterator[Gate]:
    """Yield the gates on the record, where there is one."""
    if not PATH.exists():
        return
    for part, slack in SLACK.items():
        yield Gate(
            "work-precision",
            ("record",),
            f"record.{part}",
            1 - slack,
            1 + slack,
            f"worst ratio of {part} to the committed record (reports/record.json): no case may be worse, and where "
            "all are better `dda-validate record --update-record` is due",
            reference_kind="own last value",
        )


def update(finished: Finished, cases: Sequence[tuple[str, str]], reason: str) -> None:
    """Write the record with the reason for it.

    Raises
    ------
    InputError
        The reason is missing.
    """
    if not reason.strip():
        raise InputError("--reason: must say why the record changes, got nothing")
    reasons = [*load().get("reasons", []), reason.strip()]
    data = {"reasons": reasons, "cases": measured(finished, cases)}
    PATH.parent.mkdir(exist_ok=True)
    text = json.dumps(data, indent=1, sort_keys=True) + "\n"
    write_atomically(PATH, lambda stream: stream.write(text.encode()))
