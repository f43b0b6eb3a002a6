"""Every answer of these tests is compared with what it was."""

from pathlib import Path

import pytest
from oracles.kept_answers import compared

KEPT = Path(__file__).with_name("answers.toml")
FUNCTIONS = ("judge", "cause")


@pytest.fixture(autouse=True)
def answers_as_kept(request):
    """Compare the answers of a test."""
    yield from compared(request, KEPT, *FUNCTIONS)
