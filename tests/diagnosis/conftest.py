"""Every answer of these tests is compared with what it was."""

from pathlib import Path

import pytest
from oracles.kept_answers import compared

KEPT = Path(__file__).with_name("answers.toml")
FUNCTIONS = (
    *("compare", "answer_of", "answer_on", "judged_without_rectangle", "verdict_of", "verdict_on", "habits_of"),
    *("simple", "twofold", "with_same_rows", "verdict_of_solvers", "read"),
)


@pytest.fixture(autouse=True)
def answers_as_kept(request):
    """Compare the answers of a test."""
    yield from compared(request, KEPT, *FUNCTIONS)
