"""The register of the paper's claims, and the page of a scene with its alarms."""

import json

from validation.studies.paper.chapter import claims_table, conclusion
from validation.suite.folders import get_study


def test_the_register_lists_every_claim() -> None:
    claims = json.loads(json.dumps(dict(get_study("paper").data())))["claims"]  # as a manifest holds them
    table = claims_table(claims, {"C1": {"verdict": 2.0, "left": 0.001}, "C6": {"verdict": 1.0}})
    rows = {row[0]: row for row in table.rows}
    assert {f"C{i}" for i in range(1, 23)} | {f"S{i}" for i in (13, 16, 20, 21, 25, 29, 32)} == set(rows)
    of_the_paper = ("abstract", "section", "conclusion", "equation")
    assert all(claim["place"].startswith(of_the_paper) for claim in claims)
    assert rows["C1"][1] == "confirmed" and rows["C1"][4] == "left 0.001"
    assert rows["C6"][1] == "under a condition" and "Condition: mode by mode" in rows["C6"][3]
    assert rows["C2"][1] == "not tested"
    assert "1 is confirmed, 1 holds under a condition" in conclusion({"C1": {"verdict": 2.0}, "C6": {"verdict": 1.0}})


def test_the_lead_says_how_many_of_the_refuted_are_misprints() -> None:
    rows = {"C1": {"verdict": 2.0}, "C2": {"verdict": 0.0}, "S16": {"verdict": 0.0}, "S20": {"verdict": 0.0}}
    assert "2 of the 3 refuted are misprints" in conclusion(rows, {"S16", "S20"})
    assert "misprint" not in conclusion(rows, {"C1"})
