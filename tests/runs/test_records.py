"""Records are read where they bear themselves out: a verdict by its own value and band, a gate once."""

import pytest

from validation.runs.records import _ordered, sound, unique


def judged(verdict, value, band=(1.0, 2.0), name="g"):
    return {"id": name, "study": "s", "value": value, "band": list(band), "verdict": verdict}


@pytest.mark.parametrize(
    ("verdict", "value"), [("PASS", 2.01), ("PASS", 0.99), ("PASS", None), ("PASS", "undefined"), ("FAIL", 1.5)]
)
def test_a_verdict_that_its_value_does_not_bear_out_is_refused(verdict, value):
    with pytest.raises(ValueError, match=rf"g says {verdict}, got {value!r} in \[1, 2\]"):
        sound(judged(verdict, value))


def test_two_verdicts_of_one_gate_are_refused():
    two = [judged("PASS", 1.5), judged("PASS", 1.5, name="h")]
    assert unique(two) == two and _ordered([1.5, 1.5])
    with pytest.raises(ValueError, match=r"^g .* s$"):
        unique([*two, judged("FAIL", 3.0)])
    with pytest.raises(ValueError, match=r"^g{200} .* s{200}$"):
        unique(2 * [judged("PASS", 1.5, name=300 * "g") | {"study": 300 * "s"}])
