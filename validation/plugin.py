"""pytest plugin: the marker of the accuracy gates and the options that put a user's own solver through them.

It imports nothing heavy, since every pytest of every project that has this package installed loads it.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--dda-solver`` and ``--dda-timeout``."""
    group = parser.getgroup("dda-validation", "accuracy gates for your own DDA solver")
    group.addoption(
        "--dda-solver",
        metavar="MODULE:ATTRIBUTE",
        help="put this solver, solve(scene) -> history, in the place of `dda` and run every gate that applies to it",
    )
    group.addoption(
        "--dda-timeout",
        metavar="SECONDS",
        type=float,
        default=60.0,
        help="time limit of the solver for one case (default: 60)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, so that the gates run under strict markers in any project."""
    config.addinivalue_line("markers", "validation: the accuracy gates of dda-validation, one test a gate")
    # pytest-xdist registers it as well; without xdist the gates still carry it.
    config.addinivalue_line("markers", "xdist_group(name): tests that one worker of pytest-xdist runs together")
    if config.getoption("--dda-solver", None):
        os.environ["DDA_VALIDATE_TIMEOUT"] = str(config.getoption("--dda-timeout"))


@pytest.fixture(scope="session")
def finished_cases(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the directory of this run's finished cases, which the workers of pytest-xdist share."""
    base = tmp_path_factory.getbasetemp()
    return (base.parent if hasattr(request.config, "workerinput") else base) / "finished-cases"
