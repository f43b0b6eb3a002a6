"""A gate beside numbers worked out by hand: refusals, what its band is about, margins, records, verdicts."""

import math

import pytest

from validation.gates.gate import LARGEST, Gate, Status, judge, rounded, settled


def gate(low=0.0, high=4.0, **more):
    given = {"scene": "s[a=1]", "pair": ("dda", "bar"), "metric": "displacement.l2", "reason": "so"} | more
    return Gate(low=low, high=high, **given)


def test_a_band_that_is_none_is_refused():
    for fault in (
        {"low": math.nan},
        {"reference_uncertainty": 4.5},
        {"reference_kind": "guess"},
        {"reason": ""},
    ):
        with pytest.raises(ValueError, match=r"^s\[a=1\]:dda-bar:displacement.l2: "):
            gate(**fault)
    assert gate(4.0, 4.0).low == gate(0.5, 0.75, reference_uncertainty=0.25).low + 3.5


def test_what_a_band_is_about_and_the_way_to_its_edges():
    inf = math.inf
    for low, high, value, target, tolerance, margin in (
        (0.0, 4.0, 1.0, 0.0, 4.0, 0.75),
        (4e-6, 4.0, 1.0, 0.0, 4.0, 0.75),
        (5e-6, 4.0, 4.0, 2.0000025, 0.9999975, 0.0),
        (2.0, 6.0, 5.0, 4.0, 0.5, 0.5),
        (2.0, 6.0, 1.0, 4.0, 0.5, -0.5),
        (-3.0, 1.0, -1.0, 0.0, 3.0, 2 / 3),
        (-0.6, -0.2, -0.5, -0.4, 0.5, 0.5),
        (-2.0, 0.0, 0.5, 0.0, 2.0, None),
        (-2.0, 0.0, 0.0, 0.0, 2.0, None),
        (0.0, 4.0, 0.0, 0.0, 4.0, 1.0),
        (0.0, inf, 1.0, 0.0, inf, None),
        (1.0, 1 + 1e-10, 1.0, 1.0, 5e-11, None),
        (0.0, 0.0, 0.0, 0.0, 0.0, None),
    ):
        one = gate(low, high)
        assert one.target == pytest.approx(target, rel=1e-9), (low, high)
        assert one.tolerance == pytest.approx(tolerance, rel=1e-5), (low, high)
        assert one.margin(value) == pytest.approx(margin, abs=1e-6), (low, high)
    assert gate(3.0, 3.0 + 6e-9).margin(3.0) == pytest.approx(0.0, abs=1e-6)  # of 1e-9 and no less


def test_inside_passes_and_what_has_no_number_fails():
    for value, status in ((0.0, "PASS"), (4.0, "PASS"), (-1e-9, "FAIL"), (4.001, "FAIL")):
        assert (judge(gate(), value).status, judge(gate(), value).why) == (status, ""), value
    told = judge(gate(1e-6 / 3), 1.23456).record("t")
    assert (told["value"], told["margin"], told["band"]) == (1.235, 0.691, [3.33333333333e-07, 4.0])
    for value in ("undefined", None, math.nan):
        told = judge(gate(), value)
        assert told.status is Status.FAIL and told.why
        assert told.value == (value if isinstance(value, str) else None)


def test_numbers_are_rounded_alike_on_every_processor():
    inputs = (1e-12, -1e-12, 1.0009e-12, 0.0, 123456.0, -2.34567e-9, 1.2345e-10, 9.999e-10, 1e-9, -math.inf, math.nan)
    outputs = (0.0, 0.0, 1e-12, 0.0, 123500.0, -2.346e-9, 1.2e-10, 1e-9, 1e-9, -LARGEST)
    assert [settled(value) for value in inputs[:-1]] == list(outputs)
    assert [rounded(x, 2) for x in (3e-13, -3e-13, 0.0126, math.inf)] == [1e-12, -1e-12, 0.013, LARGEST]
