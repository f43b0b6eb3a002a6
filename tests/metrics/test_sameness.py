"""Two histories that are one bit for bit, and two runs of one program that are not."""

import math

import numpy as np
import pytest

from validation.metrics.sameness import FEWEST_VALUES, ROUNDING, is_identical, largest_difference
from validation.runs.history import History

TIME = 0.1 * np.arange(1, 31)


def history(**columns):
    return History(TIME, columns)


def test_few_values_are_alike_by_chance():
    few = np.minimum(TIME, TIME[FEWEST_VALUES - 2])
    enough = np.minimum(TIME, TIME[FEWEST_VALUES - 1])
    assert not is_identical(history(a=few), history(a=few))
    assert is_identical(history(a=enough), history(a=enough))


@pytest.mark.parametrize(("factor", "column"), [(0.5, ""), (2.0, "b")])
def test_two_runs_differ_by_more_than_rounding(factor, column):
    x = np.sin(TIME)
    name, size = largest_difference(history(a=x, b=x), history(a=x, b=x * (1 + factor * ROUNDING)))
    assert name == column and size == pytest.approx(factor * ROUNDING if column else 0.0, rel=1e-3)


def test_the_worst_column_is_named_and_what_cannot_be_compared_is_infinite():
    x = np.sin(TIME)
    assert largest_difference(history(a=x, b=x), history(a=1.1 * x, b=1.2 * x)) == ("b", pytest.approx(0.2))
    assert largest_difference(history(a=x, b=x), history(a=x)) == ("b", math.inf)
    assert largest_difference(history(a=x), History(TIME[:-1], {"a": x[:-1]})) == ("a", math.inf)
    assert largest_difference(history(a=x), history(a=np.full(30, np.nan))) == ("a", math.inf)
    assert largest_difference(history(a=np.zeros(30)), history(a=np.zeros(30))) == ("", 0.0)
