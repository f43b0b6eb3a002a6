"""What is derived from finished cases."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from validation.engine.finished import Derived, Finished
from validation.engine.judge import evaluate
from validation.gates.gate import Gate, Status
from validation.runs.results import Results
from validation.runs.row import Value


def test_a_derived_row_is_computed_once_for_all_gates(tmp_path: Path) -> None:
    asked = []

    def compute(finished: Finished) -> Mapping[str, Value]:
        asked.append(finished)
        return {"first": 1.0, "second": 2.0}

    row = Derived("scene", "name", (), compute)
    finished = Finished({}, Results(tmp_path), {("scene", "name"): row})
    for metric, value in (("first", 1.0), ("second", 2.0)):
        gate = Gate("scene", ("name",), metric, value, value, "a reason")
        assert evaluate(gate, finished).status is Status.PASS
    assert asked == [finished]
