"""The register of claims: computed, gated, and not deaf: thresholds and code turn verdicts over."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import refused
from faults import seams
from faults.fault import soft_springs, told, with_scheme
from faults.kill_matrix import whole

from validation.engine.judge import evaluate
from validation.engine.run import _derived_record, finish
from validation.gates.gate import Status
from validation.runs.results import Results
from validation.studies.paper import open_close
from validation.studies.paper.formulas import CLAIMS, CLAIMS_OF_THE_PAPER
from validation.suite.claims import REGISTER, Band, Evidence, Finding, page
from validation.suite.folders import get_study

ROOT = Path(__file__).parents[2]
PAPER = get_study("paper")
NEEDED = {need for claim in CLAIMS for need in claim.needs}
OPENED = {need for claim in CLAIMS if claim.id in open_close.TESTS for need in claim.needs}


def run(directory, needed=NEEDED):
    cases = [case for case in PAPER.cases() if (case.scene.name, case.solver) in needed]
    return finish(cases, PAPER, Results(directory))


@pytest.fixture(scope="module")
def finished(finished_cases):
    """Return the finished cases of the register."""
    return run(finished_cases)


@pytest.mark.long
def test_every_claim_has_its_expected_verdict_and_every_number_its_gate(finished):
    found = {claim.id: finished.row(REGISTER, claim.id).metrics["verdict"] for claim in CLAIMS}
    assert found == {claim.id: claim.expected for claim in CLAIMS}
    assert all(evaluate(gate, finished).status is Status.PASS for gate in PAPER.gates())


@pytest.mark.long
def test_a_changed_threshold_turns_the_verdict_over(finished):
    for claim in CLAIMS:
        numbers = claim.measure(Evidence(finished))
        bands = (*claim.printed, *claim.conditional)
        assert {band.number for band in bands} | {name for name, _, _ in claim.numbers} <= numbers.keys(), claim.id
        wide = tuple(Band(band.number, -np.inf, np.inf) for band in claim.printed)
        shut = tuple(Band(band.number, band.high + 1, band.high + 2) for band in claim.printed)
        changed = replace(claim, printed=shut if claim.expected is Finding.CONFIRMED else wide)
        assert changed.finding(numbers) is not claim.expected, claim.id
        for band in claim.conditional:
            shut = (replace(band, low=band.high + 1, high=band.high + 2),)
            assert replace(claim, conditional=shut).finding(numbers) is Finding.REFUTED, claim.id
        assert evaluate(replace(claim.gate(), low=-1.0, high=-0.5), finished).status is Status.FAIL


@pytest.mark.long
def test_the_page_in_docs_is_what_a_fresh_run_writes(finished):
    rows = [_derived_record(finished, REGISTER, claim.id) for claim in CLAIMS]
    text = (ROOT / CLAIMS_OF_THE_PAPER.page).read_text(encoding="utf-8")
    assert text == page(CLAIMS_OF_THE_PAPER, rows)
    assert not re.search(r"e-1[0-9]", text)


def test_the_page_has_every_claim_with_its_finding_and_a_condition_where_that_is_needed():
    findings = [*Finding]
    rows = []
    expected = []
    for number, claim in enumerate(CLAIMS):
        finding = findings[number % len(findings)]
        rows.append({"name": claim.id, "metrics": {"verdict": float(finding.value), "x": 1.0}})
        condition = f" ({claim.condition})" if finding is Finding.CONDITIONAL else ""
        expected.append(f"## {claim.id}: {finding.words}{condition}")
    lines = page(CLAIMS_OF_THE_PAPER, rows).splitlines()
    assert [line for line in lines if line.startswith("## ")] == expected
    assert len(lines) == 3 + 4 * len(CLAIMS)


def test_a_band_holds_its_edges():
    held = [Band("x", 1.0, 2.0).holds({"x": value}) for value in (0.9, 1.0, 2.0, 2.1)]
    assert held == [False, True, True, False] and not Band("x", 1.0, 2.0).holds({"y": 1.5})


def damped(delta):
    return delta + 0.05


def held(found):
    """Count the corners as closed."""
    return {"closed": np.ones_like(found.closed)}


FAULTS = {  # seam, what is made of it, and the claims that it turns over
    "velocity with another delta": (seams.DDA_VELOCITY, with_scheme(0, delta=damped), {"C9", "C12", "S13"}),
    "springs half as stiff": (seams.DDA_STIFFNESS, soft_springs(0.5), {"C1"}),
    "load reversed": (seams.DDA_SEGMENT_LOAD, lambda sound: lambda *a: -sound(*a), {"S29"}),
    "average acceleration everywhere": (
        seams.DDA_VELOCITY,
        with_scheme(0, delta=lambda delta: 0.5),
        {"C1", "C6", "C7", "C10"},
    ),
    "gg 0.1 % low": (seams.DDA_VELOCITY, with_scheme(0, gg=lambda gg: 0.999 * gg), {"C9", "C12", "C18"}),
    "contact that stays closed": (seams.DDA_OPENED, told(held), {"C15", "C16"}),
    "gg missing": (seams.DDA_PREDICTOR, with_scheme(0, gg=lambda gg: 1.0), {"C12"}),
}


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """Gates that fail under each fault; all of them pass in the sound run."""
    found = {}
    for fault, (seam, replacement, _) in FAULTS.items():
        with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
            seam.wrap(patch, replacement)
            faulty = run(tmp_path_factory.mktemp("faulty"), OPENED if seam is seams.DDA_OPENED else NEEDED - OPENED)
            whole(fault, faulty)
            found[fault] = {gate.id for gate in PAPER.gates() if evaluate(gate, faulty).status is Status.FAIL}
    return found


@pytest.mark.long
@pytest.mark.parametrize("fault", FAULTS)
def test_changed_code_turns_verdicts_over(fault, killed):
    turned = {f"{REGISTER}:{claim}:verdict" for claim in FAULTS[fault][2]}
    assert turned <= killed[fault], sorted(turned - killed[fault])


@pytest.mark.long
def test_every_number_is_bitten_and_every_verdict_that_a_fault_could_mend(killed):
    bitten = set().union(*killed.values())
    unbitten = {gate.id for gate in PAPER.gates()} - bitten
    # no fault of ours makes a refuted statement true: those gates are bitten by changed thresholds alone
    refuted = {claim.gate().id for claim in CLAIMS if claim.expected is Finding.REFUTED}
    assert unbitten <= refuted, sorted(unbitten - refuted)


def test_the_command_needs_results(tmp_path):
    assert "run paper" in refused("claims", "--results", tmp_path)
