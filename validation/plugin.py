"""pytest plugin: the marker of the accuracy gates and the options that put a user's own solver through them.

It imports nothing heavy, since every pytest of every project that has this package installed loads it.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
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
