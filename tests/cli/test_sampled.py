"""Gates for a disagreement are not proposed."""

import pytest

from validation.cli.printing import tables


@pytest.mark.parametrize(("value", "proposed"), [(0.034, True), (0.49, True), (1.02, False), (1.5e47, False)])
def test_a_gate_is_proposed_for_what_agrees(value, proposed):
    record = {"scene": "s", "solver": "dda", "reference": "fem", "metrics": {"displacement.l2": value}}
    text = "\n".join(tables._next([record], [], True))
    assert ("[[gate]]" in text) is proposed
