"""The record of errors and work: what is missing, undefined or not recorded is never as good as recorded."""

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from oracles.made_cases import made_history, made_row

from validation.errors import InputError
from validation.studies.work import record

CASES = [("a", "dda"), ("a", "bar")]
ENTRY = {"errors": {"displacement": 0.1}, "work": {"solves": 40}, "seconds": {}}


def finished(displacement: float = 1.2, **work: int) -> Any:
    histories = {"dda": made_history(0.1, 1.32 * np.ones(9), np.ones(9)),
                 "bar": made_history(0.1, displacement * np.ones(9), np.ones(9))}  # fmt: skip
    rows = {("a", name): made_row(name, {}, "a", work=work or {"solves": 40}) for name in histories}
    return SimpleNamespace(rows=rows, history=lambda case, name: histories.get(name))


def test_a_case_that_only_one_side_has_is_refused() -> None:
    then = record.measured(finished(), CASES)
    assert record.compare(finished(), CASES, then) == {"errors": 1.0, "work": 1.0}
    with pytest.raises(ValueError, match="alone holds 1 cases, such as a bar"):
        record.compare(finished(), CASES[:1], then)
    with pytest.raises(ValueError, match="lacks 1 cases, such as a bar"):
        record.compare(finished(), CASES, {"a dda": then["a dda"]})
    with pytest.raises(ValueError, match="nothing was compared"):
        record.compare(finished(), CASES, {})


@pytest.mark.parametrize("part", ["errors", "work"])
@pytest.mark.parametrize("value", ["undefined", None])
def test_a_number_that_only_one_side_has_is_infinitely_worse(part: str, value: str | None) -> None:
    name = {"errors": "displacement", "work": "solves"}[part]
    other = ENTRY | {part: {} if value is None else {name: value}}
    for now, then in ((ENTRY, other), (other, ENTRY), *([(other, other)] if value else [])):
        assert record.ratios({"a": now}, {"a": then})[part] == math.inf


@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0, None, [1.0]])
def test_a_record_of_what_is_no_error_is_refused(
    value: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(record, "PATH", tmp_path / "record.json")
    entry = ENTRY | {"errors": {"displacement": value}}
    record.PATH.write_text(json.dumps({"cases": {"a dda": entry}}))
    with pytest.raises(InputError, match=r"record.json: must be "):
        record.load()


def test_a_record_is_not_written_of_what_did_not_complete(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(record, "PATH", tmp_path / "record.json")
    with pytest.raises(InputError, match="nothing was written"):
        record.update(finished(displacement=0.0), CASES, "a test")  # a relative error of a zero signal is undefined
    with pytest.raises(InputError, match="nothing was written"):
        record.update(finished(other=1), CASES, "a test")
    assert not record.PATH.exists()
    record.update(finished(), CASES, "a test")
    assert record.load()["reasons"] == ["a test"]
