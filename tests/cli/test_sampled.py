"""Gates for a disagreement are not proposed; modes are told where samples show an alias of them."""

import pytest
from conftest import typed

from validation.cli.printing import tables


@pytest.mark.parametrize(("value", "proposed"), [(0.034, True), (0.49, True), (1.02, False), (1.5e47, False)])
def test_a_gate_is_proposed_for_what_agrees(value, proposed):
    record = {"scene": "s", "solver": "dda", "reference": "fem", "metrics": {"displacement.l2": value}}
    text = "\n".join(tables._next([record], [], True))
    assert ("[[gate]]" in text) is proposed


def test_modes_are_told_where_a_frequency_is_aliased_and_no_bar_answers():
    values = ("time.alpha=0.1", "time.delta=0.6", "time.allow_unstable=true", "time.step=0.05")
    sets = [word for value in values for word in ("--set", value)]
    assert typed("advise", "damping", "figures-3-4", *sets).returncode == 0
