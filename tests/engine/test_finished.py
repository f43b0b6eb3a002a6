"""What is derived from finished cases."""

import re

import numpy as np
import pytest
from oracles.made_cases import made_row

from validation.engine.finished import Derived, Finished, NothingToDerive
from validation.engine.judge import evaluate
from validation.engine.run import _derived_record
from validation.gates.gate import Gate, Status
from validation.runs.results import Results
from validation.runs.run import Outcome


@pytest.mark.parametrize(
    ("ended", "status"),
    [(Outcome.TIMEOUT, Status.FAIL), (Outcome.NOT_APPLICABLE, Status.NOT_RUN), (None, Status.NOT_RUN)],
)
def test_what_is_derived_ends_as_the_run_that_it_needs(ended, status, tmp_path):
    rows = {} if ended is None else {("scene", "dda"): made_row("dda", {}, "scene", outcome=ended)}
    recipe = Derived("scene", "name", (("scene", "dda"),), lambda finished: {"first": 1.0})
    finished = Finished(rows, Results(tmp_path), {("scene", "name"): recipe})
    verdict = evaluate(Gate("scene", ("name",), "first", 0.0, 2.0, "why"), finished)
    assert verdict.status is status and {"dda", "scene"} <= {*re.findall(r"\w+", verdict.why)}


def nothing(finished):
    raise NothingToDerive("no peak")


@pytest.mark.parametrize(("compute", "outcome"), [(nothing, Outcome.NOT_RUN), (lambda done: 1 / 0, Outcome.RAISED)])
def test_what_cannot_be_derived_is_a_named_outcome(compute, outcome, tmp_path):
    recipe = Derived("scene", "name", (("scene", "dda"),), compute)
    rows = {("scene", "dda"): made_row("dda", {}, "scene")}
    finished = Finished(rows, Results(tmp_path), {("scene", "name"): recipe})
    row = finished.row("scene", "name")
    assert row.outcome is outcome and row is finished.row("scene", "name")
    assert row.notes == ("no peak" if compute is nothing else "ZeroDivisionError: division by zero",)
    with pytest.raises(ValueError, match=r"^scene: .* dda, got none$"):
        finished.needed_history("scene", "dda")


def test_what_is_derived_is_kept_as_plain_numbers(tmp_path):
    recipe = Derived("scene", "name", (("scene", "dda"),), lambda finished: {"first": np.float64(0.5), "word": "none"})
    made = Finished({("scene", "dda"): made_row("dda", {}, "scene")}, Results(tmp_path), {("scene", "name"): recipe})
    record = _derived_record(made, "scene", "name")
    assert record == {"scene": "scene", "name": "name", "metrics": {"first": 0.5, "word": "none"}}
    assert type(record["metrics"]["first"]) is float
