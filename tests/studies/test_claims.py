"""The register of claims: computed, gated, and not deaf: thresholds and code turn verdicts over."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import refused, thinned
from faults import seams
from faults.fault import soft_springs, told, with_scheme
from faults.kill_matrix import whole

from validation import solve
from validation.engine.judge import evaluate
from validation.engine.run import _derived_record, finish
from validation.gates.gate import Status
from validation.runs.results import Results
from validation.scenes.scene import load_scene
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


# Ways in a second by an independent program of six unknowns and two corners [mm], by time step [s].
WAYS = {0.01: 1.0790587, 0.002: 2.7461378, 0.001: 5.1759751}


@pytest.mark.parametrize("step", thinned(WAYS, 3))
def test_a_stable_block_slides_the_farther_the_finer_the_step_and_stands_in_the_end(step):
    case = next(s for s in load_scene("creep-claim").expand() if s.contact.rules == "consistent")
    columns = ["displacement", "contact_pressure", "horizontal_displacement", "slide_m", "slide_n"]
    values = {"time.step": step, "time.steps": round(1 / step), "run.columns": columns}
    way = solve(case.with_values(values), "dda").history.columns["horizontal_displacement"]
    assert 1e3 * way[-1] == pytest.approx(WAYS[step], abs=1e-6)
    assert np.ptp(way[-len(way) // 4 :]) < 1e-6  # of 1 mm and more: it stands
