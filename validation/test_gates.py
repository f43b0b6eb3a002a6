"""The accuracy gates as tests: ``pytest --pyargs validation -m validation`` runs one test a gate.

With ``--dda-solver module:attribute`` that solver takes the place of `dda`, and the gates on `dda` are run.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from validation.entry.siblings import shadowed

if sentence := shadowed():  # before the imports that would fail on it
    pytest.exit(sentence, returncode=2)

from validation.gates.gate import Gate, Status
from validation.runs.results import Results
from validation.suite.folders import get_study, judged_studies
from validation.suite.own_solver.gates import applying
from validation.suite.own_solver.session import GateRuns, Session, plain


@functools.cache
def gates() -> Mapping[str, tuple[str, Gate]]:
    """Return every gate of the suite that the tests judge: id to study and gate."""
    return {gate.id: (study, gate) for study in judged_studies() for gate in get_study(study).gates()}


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make one test of each gate; with ``--dda-solver`` of those on `dda` only."""
    selected_gates = gates() if metafunc.config.getoption("--dda-solver", None) is None else applying()
    # By themselves pytest's ids are no longer the names where these are long.
    metafunc.parametrize("name", list(selected_gates), ids=list(selected_gates))


@pytest.fixture(scope="session")
def runs(finished_cases: Path, pytestconfig: pytest.Config) -> GateRuns:
    """Return the cases run in this session, filled as gates ask for them, by the suite's own solvers or a user's."""
    user = pytestconfig.getoption("--dda-solver", None)
    results = Results(finished_cases)
    return GateRuns(results, judged_studies()) if user is None else Session(user, results)


@pytest.mark.validation
def test_gate(name: str, runs: GateRuns, tell: Callable[[Mapping[str, object]], None]) -> None:
    """Run what the gate asks for and judge it."""
    if isinstance(runs, Session):
        verdict, statement = runs.judge(name)
        tell(plain(statement))
    else:
        verdict = runs.verdict(*gates()[name])
    if verdict.status is Status.NOT_RUN:
        pytest.skip(f"NOT RUN: {verdict.why}")
    gate = verdict.gate
    measured = f"{verdict.value} is outside [{gate.low:g}, {gate.high:g}]; the band: {gate.reason}"
    if verdict.status is Status.FAIL:
        pytest.fail(f"{gate.id}: {verdict.why or measured}", pytrace=False)
