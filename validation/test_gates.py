"""The accuracy gates as tests: ``pytest --pyargs validation -m validation`` runs one test a gate.

With ``--dda-solver module:attribute`` that solver takes the place of `dda`, and the gates on `dda` are run.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from validation.entry.siblings import shadowed

if sentence := shadowed():  # before the imports that would fail on it
    pytest.exit(sentence, returncode=2)

from validation.engine.case import Case
from validation.engine.finished import Finished
from validation.engine.judge import evaluate
from validation.engine.run import finish
from validation.gates.gate import Status, Verdict
from validation.runs.results import Results
from validation.suite.own_solver.gates import applying, asked, cases, gates, recipes, study_of
from validation.suite.own_solver.session import Session, plain


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make one test of each gate; with ``--dda-solver`` of those on `dda` only."""
    selected_gates = gates() if metafunc.config.getoption("--dda-solver", None) is None else applying()
    # By themselves pytest's ids are no longer the names where these are long.
    metafunc.parametrize("name", list(selected_gates), ids=list(selected_gates))


@pytest.fixture(scope="session")
def finished(finished_cases: Path) -> Finished:
    """Return the cases run in this session, filled as gates ask for them."""
    return Finished({}, Results(finished_cases))


@pytest.fixture(scope="session")
def finished_studies() -> dict[str, Finished]:
    """Return by study the same cases with what is derived from them, which is computed once for all gates that ask."""
    return {}


@pytest.fixture(scope="session")
def session(finished_cases: Path, pytestconfig: pytest.Config) -> Session | None:
    """Return the user's solver on its way through the gates, None where the suite judges its own."""
    user = pytestconfig.getoption("--dda-solver", None)
    return None if user is None else Session(user, Results(finished_cases))


@pytest.mark.validation
def test_gate(
    name: str,
    finished: Finished,
    finished_studies: dict[str, Finished],
    session: Session | None,
    tell: Callable[[Mapping[str, object]], None],
) -> None:
    """Run what the gate asks for and judge it."""
    if session is None:
        verdict = _verdict(name, finished, finished_studies)
    else:
        verdict, statement = session.judge(name)
        tell(plain(statement))
    if verdict.status is Status.NOT_RUN:
        pytest.skip(f"NOT RUN: {verdict.why}")
    gate = verdict.gate
    measured = f"{verdict.value} is outside [{gate.low:g}, {gate.high:g}]; the band: {gate.reason}"
    if verdict.status is Status.FAIL:
        pytest.fail(f"{gate.id}: {verdict.why or measured}", pytrace=False)


def _verdict(name: str, finished: Finished, finished_studies: dict[str, Finished]) -> Verdict:
    """Judge one of the suite's own solvers, whose cases are run where they were not yet."""
    study, gate = gates()[name]
    missing = [pair for pair in study_of(study).needs(gate) if pair not in finished.rows]
    if missing:
        finished_keys = finished.results.rows()
        pending = [_gated_case(cases(study)[pair], finished_keys) for pair in missing]
        finished.rows.update(finish(pending, study_of(study), finished.results).rows)
    if study not in finished_studies:
        finished_studies[study] = Finished(finished.rows, finished.results, recipes(study))
    return evaluate(gate, finished_studies[study])


def _gated_case(case: Case, finished_keys: Container[str]) -> Case:
    """Return a case with the metrics that gates ask for, or with all of them where a row holds them already."""
    required_metrics = asked().get((case.scene.name, case.solver), frozenset())
    return case if case.key() in finished_keys else replace(case, only=required_metrics)
