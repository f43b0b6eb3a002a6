"""What a solver answers to problems, and how it ends where it has no answer."""

import numpy as np
import pytest

from validation.gates.gate import Status
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.suite import judging


@pytest.mark.parametrize(
    ("outcome", "note", "status", "why"),
    [
        (Outcome.WRONG_UNITS, "mm", Status.FAIL, "mm"),
        (Outcome.NOT_A_NUMBER, "at step 2", Status.FAIL, "(at step 2)"),
        (Outcome.REFUSED, "no law", Status.NOT_APPLICABLE, "no law"),
        (Outcome.NOT_RUN, "no licence", Status.NOT_RUN, "no licence"),
        (Outcome.RAISED, "E", Status.NOT_RUN, "E"),
    ],
)
def test_a_run_without_a_history_has_a_status(outcome, note, status, why):
    found, sentence = judging._ending(Run(outcome, None, notes=("first", note)))
    assert found is status
    assert sentence.endswith(why)
    assert (sentence == why) is (outcome not in (Outcome.NOT_A_NUMBER, Outcome.RAISED))


def test_a_second_run_that_is_another_one_is_told():
    x = np.array([1.0, -2.0, 3.0])
    first = History(0.1 * np.arange(1, 4), {"displacement": x})
    assert list(judging._not_repeatable(first, first)) == []
    for other in (
        History(first.time, {"displacement": 1.01 * x}),
        History(first.time[:2], {"displacement": x[:2]}),
        None,
    ):
        assert len(list(judging._not_repeatable(first, other))) == 1
