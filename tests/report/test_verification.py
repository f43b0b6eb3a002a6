"""The verification matrix: the tightest gate of a reason stands for it; what did not run is not counted."""

import pytest

from validation.gates.gate import Gate, Status, Verdict, judge
from validation.report import verification
from validation.report.verification import matrix_table, phenomenon_table, standing, verdict_blocks
from validation.suite.matrix import Phenomenon

WIDE = Gate("response-a[x=1]", ("dda", "bar"), "displacement.l2", 0.0, 0.04, "one", "exact", 1e-3)
TIGHT = Gate("response-b", ("dda", "bar"), "displacement.max", 0.0, 0.02, "one", "exact", 1e-3)
IDLE = Gate("response-c", ("dda",), "pressure.static", 4.9e6, 5.1e6, "one", "exact")
OTHER = Gate("response-d", ("bar", "continuum"), "pressure.l2", 0.1, 0.3, "two", "other code", 1e-4, until=0.2)
ROUNDING = Gate("response-e", ("fem",), "displacement.static", 2 - 1e-13, 2 + 1e-13, "three", "exact")


def test_a_phenomenon_stands_by_its_tightest_gates(kept, monkeypatch):
    shown = Phenomenon("Swings", "response", "@feng2017")
    shown.__dict__["gates"] = (WIDE, TIGHT, IDLE, OTHER, ROUNDING)
    measured = [judge(WIDE, 0.03), judge(TIGHT, 0.015), judge(OTHER, 0.35), judge(ROUNDING, 2.0)]
    verdicts = [*measured, Verdict(IDLE, None, Status.NOT_RUN, "absent")]
    records = [verdict.record("response") for verdict in verdicts]
    stands = standing(shown, [*records, judge(TIGHT, 9.0).record("another")])
    assert stands.passed == {"dda": (2, 2), "bar": (0, 1), "fem": (1, 1)}
    assert stands.values[TIGHT.id] == (0.015, pytest.approx(0.25)) and {WIDE.id, IDLE.id}.isdisjoint(stands.values)
    listed = [(shown, stands)]
    few, every = (verdict_blocks(shown, verdicts, every) for every in (False, True))
    kept("verification", [phenomenon_table(listed), matrix_table(listed), *few])
    (more,) = set(every[1].rows) - set(few[1].rows)
    assert more[1].startswith(WIDE.scene) and (more[0], more[-1]) == ("PASS", "25 %")
    assert verification.matrix([]) == []
    monkeypatch.setattr(verification, "standings", lambda verdicts: listed)
    heading, *tables, missing = verification.matrix(records)
    assert (heading.level, tables) == (2, [phenomenon_table(listed), matrix_table(listed)])
    assert len(missing.rows) > 3 and all(len(row) == 2 and all(row) for row in missing.rows)
    tiny = Gate("s", ("dda",), "displacement.static", 0.0, 1.0, "so")
    assert [verification.noted_value(tiny, value) for value in (0.0, 1e-15, 0.25)] == ["<1×10⁻⁹", "<1×10⁻⁹", "0.25"]
    assert verification.noted_value(Gate("s", ("dda",), "displacement.static", 0.0, 0.0, "so"), 0.0) == "0"
