"""The accuracy gates as tests: ``pytest --pyargs validation -m validation`` runs one test a gate."""

from __future__ import annotations

from functools import cache

import pytest

from validation.cases import Case
from validation.engine import Finished, evaluate, finish
from validation.gates import Gate, Status
from validation.results import Results
from validation.studies import get_study, judged_studies


@cache
def _gates() -> dict[str, tuple[str, Gate]]:
    return {gate.id: (study, gate) for study in judged_studies() for gate in get_study(study).gates()}


@cache
def _cases(study: str) -> dict[tuple[str, str], Case]:
    return {(case.scene.name, case.solver): case for case in get_study(study).cases()}


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Finished:
    """Return the cases run in this session, filled as gates ask for them."""
    return Finished({}, Results(tmp_path_factory.mktemp("results")))


@pytest.mark.validation
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.xdist_group(gate.scene.partition("[")[0]))
        for name, (_, gate) in _gates().items()
    ],
)
def test_gate(name: str, finished: Finished) -> None:
    """Run what the gate asks for and judge it."""
    study, gate = _gates()[name]
    missing = [_cases(study)[pair] for pair in get_study(study).needs(gate) if pair not in finished.rows]
    fresh = finish(missing, get_study(study), finished.results)
    finished.rows.update(fresh.rows)
    verdict = evaluate(gate, Finished(finished.rows, finished.results, fresh.derived))
    if verdict.status is Status.NOT_RUN:
        pytest.skip(f"NOT RUN: {verdict.why}")
    assert verdict.status is Status.PASS, (
        f"{gate.id}: {verdict.value} is outside [{gate.low:g}, {gate.high:g}] {verdict.why}: {gate.reason}"
    )
