"""The cause of a failure, where it is certain."""

from __future__ import annotations

from dataclasses import dataclass, field

from validation.problems.bands import Standard
from validation.problems.problem import Problem
from validation.runs.history import History

NOT_EXPLAINED = "not explained"


@dataclass(frozen=True)
class Cause:
    """Why an answer fails: ids and numbers, and one line; no id where it is not explained."""

    sentence: str = NOT_EXPLAINED
    ids: tuple[str, ...] = ()
    values: dict[str, float] = field(default_factory=dict)


def cause(problem: Problem, history: History, held: Standard) -> Cause:
    """Return the cause of a failure; silent rather than wrong."""
    return Cause()
