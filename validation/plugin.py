"""pytest plugin: registers the marker of the accuracy gates; imports nothing heavy."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pytest


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, so that the gates run under strict markers in any project."""
    config.addinivalue_line("markers", "validation: the accuracy gates of dda-validation, one test a gate")
    # pytest-xdist registers it as well; without xdist the gates still carry it.
    config.addinivalue_line("markers", "xdist_group(name): tests that one worker of pytest-xdist runs together")
