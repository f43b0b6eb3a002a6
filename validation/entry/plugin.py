"""pytest plugin: the marker of the accuracy gates and the options that put a user's own solver through them.

It imports nothing heavy, since every pytest of every project that has this package installed loads it, and nothing of
`validation` before a solver is to be judged: that name may be a folder of that project's own.
"""

from __future__ import annotations

import itertools
import json
import os
from collections.abc import Callable, Generator, Mapping
from pathlib import Path

import pytest

from .siblings import shadowed

STATEMENT = "dda-validation"  # the property of a report that holds what a gate said of a user's solver, as JSON
GATE = "test_gates.py::test_gate["  # in the id of a gate's test
FAILED = "failed gates"  # how pytest counts them; the block at the end tells them, once, in the place of its own list


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--dda-solver`` and ``--dda-timeout``."""
    group = parser.getgroup("dda-validation", "accuracy gates for your own DDA solver")
    group.addoption(
        "--dda-solver",
        metavar="MODULE:ATTRIBUTE",
        help="put this solver, solve(scene) -> history, in place of `dda` and run every gate that applies to it",
    )
    group.addoption(
        "--dda-timeout",
        metavar="SECONDS",
        type=float,
        default=60.0,
        help="time limit of the solver for one case in seconds, plus 5 ms for each of its steps (default: 60)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, so that the gates run under strict markers in any project."""
    config.addinivalue_line("markers", "validation: the accuracy gates of dda-validation, one test a gate")
    if user := config.getoption("--dda-solver", None):
        if sentence := shadowed():
            raise pytest.UsageError(sentence)
        from validation.solvers.registry import is_solver

        if not is_solver(user):
            rule = "module:attribute, or a name that `dda-validate list` shows"
            raise pytest.UsageError(f"--dda-solver: must be {rule}, got {user!r}")
        os.environ["DDA_VALIDATE_TIMEOUT"] = str(config.getoption("--dda-timeout"))
        if not hasattr(config, "workerinput"):  # the workers of pytest-xdist need not try it again
            _check_loads(user)


def _check_loads(user: str) -> None:
    """Refuse a solver that cannot be loaded, once and in one line, before any gate is run."""
    from validation.errors import InputError
    from validation.solvers.registry import get_solver

    try:
        get_solver(user).check_loads()
    except InputError as error:
        raise pytest.UsageError(f"--dda-solver: {error}") from None


@pytest.fixture(scope="session")
def finished_cases(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the directory of this run's finished cases, which the workers of pytest-xdist share."""
    base = tmp_path_factory.getbasetemp()
    return (base.parent if hasattr(request.config, "workerinput") else base) / "finished-cases"


@pytest.fixture
def tell(request: pytest.FixtureRequest) -> Callable[[Mapping[str, object]], None]:
    """Return a function that hands what a gate said of a user's solver to the block at the end.

    The fixture `record_property` of pytest does the same, with a warning for each gate under --junitxml.
    """
    properties = request.node.user_properties
    return lambda statement: properties.append((STATEMENT, json.dumps(statement)))


@pytest.hookimpl(tryfirst=True)
def pytest_report_teststatus(report: pytest.TestReport) -> tuple[str, str, str] | None:
    """Count the failing gates of a user's solver apart: the block at the end tells them by what they mean."""
    return (FAILED, "F", "FAILED") if report.failed and _statements(report) else None


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """Fail a session in which gates were selected and none was judged: what judged nothing is not green."""
    if exitstatus == pytest.ExitCode.OK and _judged_nothing(session.config):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def _judged_nothing(config: pytest.Config) -> bool:
    """Whether every gate of a session was skipped; a worker of pytest-xdist, which sees a part, does not tell."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None or hasattr(config, "workerinput"):
        return False
    every = itertools.chain.from_iterable(reporter.stats.values())
    of_gates = [report for report in every if isinstance(report, pytest.TestReport) and GATE in report.nodeid]
    judged = [report for report in of_gates if report.failed or (report.when == "call" and report.passed)]
    return not judged and any(report.skipped for report in of_gates)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> Generator[None, None, None]:
    """Write what the gates tell of a user's solver, after everything else."""
    yield
    if _judged_nothing(config):
        terminalreporter.write_line("no gate was judged: exit status 1")
    user = config.getoption("--dda-solver", None)
    statements: list[str] = []
    for report in itertools.chain.from_iterable(terminalreporter.stats.values()):
        if isinstance(report, pytest.TestReport):
            statements += _statements(report)
    if user is None or not statements:
        return
    from validation.suite.own_solver.block import block, wrapped
    from validation.suite.own_solver.session import GateReport

    terminalreporter.write_sep("=", f"{user}: what the gates tell")
    reports = [GateReport(**json.loads(text)) for text in statements]
    for line in wrapped(block(reports, every=config.getoption("verbose") > 0)):
        terminalreporter.write_line(line)


def _statements(report: pytest.TestReport) -> list[str]:
    """Return what a report says of a gate of a user's solver: one text, or nothing."""
    properties = report.user_properties if report.when == "call" else []
    return [str(value) for name, value in properties if name == STATEMENT]
