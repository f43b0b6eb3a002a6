"""What is derived from finished cases."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from oracles.made_cases import made_row

from validation.engine.finished import Derived, Finished
from validation.engine.judge import evaluate
from validation.engine.measured import JudgedStudy, complaints
from validation.gates.gate import Gate, Status, Verdict
from validation.runs.results import Results
from validation.runs.row import Value
from validation.runs.run import Outcome
from validation.suite.folders import get_study


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


@pytest.mark.parametrize(
    ("ended", "status"),
    [(Outcome.TIMEOUT, Status.FAIL), (Outcome.NOT_APPLICABLE, Status.NOT_RUN), (None, Status.NOT_RUN)],
)
def test_what_is_derived_ends_as_the_run_that_it_needs(ended: Outcome | None, status: Status, tmp_path: Path) -> None:
    rows = {} if ended is None else {("scene", "dda"): made_row("dda", {}, "scene", outcome=ended)}
    recipe = Derived("scene", "name", (("scene", "dda"),), lambda finished: {"first": 1.0})
    finished = Finished(rows, Results(tmp_path), {("scene", "name"): recipe})
    verdict = evaluate(Gate("scene", ("name",), "first", 0.0, 2.0, "why"), finished)
    assert verdict.status is status and "needs dda on scene" in verdict.why


# ---- what a run complains of ----------------------------------------------------------------------------------------


def judged(ends: list[Outcome], *words: Status) -> JudgedStudy:
    gate = Gate("s", ("dda",), "displacement.static", 0.0, 1.0, "why")
    cases = {("s", f"a:{i}"): ended for i, ended in enumerate(ends)}
    return JudgedStudy(get_study("core"), [Verdict(gate, None, word) for word in words], cases)


@pytest.mark.parametrize(
    ("run", "said"),
    [
        (judged([Outcome.COMPLETED], Status.PASS, Status.NOT_RUN), []),
        (judged([Outcome.COMPLETED], Status.NOT_RUN, Status.NOT_RUN),
         ["core: none of its 2 gates was judged, all are NOT RUN"]),
        (judged([Outcome.COMPLETED, Outcome.RAISED]), ["core: ended without a measurement: s a:1"]),
        (judged([Outcome.COMPLETED, *[Outcome.TIMEOUT] * 3]), ["core: ended without a measurement: s a:1 and 2 more"]),
        (judged([Outcome.NOT_RUN]), ["core: no case was measured"]),
    ],
)  # fmt: skip
def test_complaints_count_what_they_do_not_name(run: JudgedStudy, said: list[str]) -> None:
    assert list(complaints([run])) == said


# ---- how far two runs agree -----------------------------------------------------------------------------------------
