"""The accuracy gates as tests: ``pytest --pyargs validation -m validation`` runs one test a gate.

With ``--dda-solver module:attribute`` that solver takes the place of `dda`, and the gates on `dda` are run.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from validation.engine.case import Case
from validation.engine.finished import Derived, Finished
from validation.engine.judge import evaluate
from validation.engine.run import finish
from validation.engine.study import Study
from validation.gates.gate import Gate, Status, Verdict
from validation.metrics.values import NOT_REPORTED
from validation.runs.case_name import scene_of
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.studies.catalogue import get_study, judged_studies

JUDGED = "dda"  # whose place a user's solver takes
PATIENCE = 2  # cases that may hang before the rest are not tried
PENCIL = 1e-6  # the ratio of a history of these scenes is the operator's to this, see the gates on measured damping


@cache
def _gates() -> dict[str, tuple[str, Gate]]:
    return {gate.id: (study, gate) for study in judged_studies() for gate in get_study(study).gates()}


@cache
def _untimed(study: str) -> Study:
    """Return a study without the repeats of timings, of which no gate speaks."""
    return replace(get_study(study), timed=False)


@cache
def _recipes(study: str) -> dict[tuple[str, str], Derived]:
    return get_study(study).recipes()


@cache
def _cases(study: str) -> dict[tuple[str, str], Case]:
    return {(case.scene.name, case.solver): case for case in _untimed(study).cases()}


def _applies(name: str) -> bool:
    """Whether a gate is one on the two-block model of `dda`: one block, a centred pressure, a sound history."""
    study, gate = _gates()[name]
    if gate.pair[0] != JUDGED or gate.cases[0] not in _cases(study):
        return False
    case = _cases(study)[gate.cases[0]]
    if case.scene.column is not None:
        return False
    return case.scene.block.subdivide is None and case.scene.load.centred and "stability" not in case.measures


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make one test of each gate; with ``--dda-solver`` of those on `dda` only."""
    user = metafunc.config.getoption("--dda-solver", None)
    names = [name for name in _gates() if user is None or _applies(name)]
    marks = {name: pytest.mark.xdist_group(scene_of(_gates()[name][1].scene)) for name in names}
    metafunc.parametrize("name", [pytest.param(name, marks=marks[name], id=name) for name in names])


@pytest.fixture(scope="session")
def finished(finished_cases: Path) -> Finished:
    """Return the cases run in this session, filled as gates ask for them."""
    return Finished({}, Results(finished_cases))


@pytest.mark.validation
def test_gate(name: str, finished: Finished, pytestconfig: pytest.Config) -> None:
    """Run what the gate asks for and judge it."""
    study, gate = _gates()[name]
    user = pytestconfig.getoption("--dda-solver", None)
    judged = gate if user is None else replace(gate, pair=(user, *gate.pair[1:]))
    missing = _missing(study, gate, user, finished)
    if missing and sum(row.outcome is Outcome.TIMEOUT for row in finished.rows.values()) >= PATIENCE:
        pytest.fail(f"{gate.id}: {user} hung in {PATIENCE} cases already and is not tried again", pytrace=False)
    if missing:
        finished.rows.update(finish(missing, _untimed(study), finished.results).rows)
    found = Finished(finished.rows, finished.results, _recipes(study))
    verdict = _verdict(judged, found, foreign=user is not None)
    if verdict.status is Status.NOT_RUN:
        pytest.skip(f"NOT RUN: {verdict.why}")
    measured = f"{verdict.value} is outside [{gate.low:g}, {gate.high:g}]; the band: {gate.reason}"
    if verdict.status is Status.FAIL:
        pytest.fail(f"{gate.id}: {verdict.why or measured}", pytrace=False)


def _missing(study: str, gate: Gate, user: str | None, finished: Finished) -> list[Case]:
    """Return the cases that a gate needs and that were not run yet; the user's solver takes the judged one's place."""
    needed = [(pair, _cases(study)[pair]) for pair in get_study(study).needs(gate)]
    if user is not None:
        needed = [
            ((pair[0], user), replace(case, solver=user)) if pair == gate.cases[0] else (pair, case)
            for pair, case in needed
        ]
    return [case for pair, case in needed if pair not in finished.rows]


def _verdict(gate: Gate, finished: Finished, foreign: bool) -> Verdict:
    """Judge a gate; a user's solver without modes by its measured damping, and what it does not report is not run."""
    verdict = evaluate(gate, finished)
    if foreign and verdict.value == NOT_REPORTED and gate.metric == "mode1.damping" and len(gate.pair) == 1:
        measured = replace(gate, metric="mode1.measured_damping", low=gate.low - PENCIL, high=gate.high + PENCIL)
        verdict = evaluate(measured, finished)
    if foreign and verdict.value == NOT_REPORTED:
        return replace(verdict, status=Status.NOT_RUN, why=f"{gate.pair[0]} does not report {gate.metric}")
    return verdict
