"""The field of contact engines as a table, read from a results directory; no solver is called."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

STUDY = "engines"


@dataclass(frozen=True)
class Quantity:
    """A number of an answer, and what it is judged by.

    Attributes
    ----------
    name, unit
        What is measured, such as ``"creep"`` in ``"mm/s"``.
    case
        The values of the problem's sweep that it belongs to, in words; empty where there is one case.
    value
        Of the program; None where it cannot be measured on the answer.
    exact
        The exact value.
    band
        Lower and upper edge of what passes.
    word
        PASS, FAIL or "not reported".
    reason
        Why the band ends there.
    """

    name: str
    unit: str
    case: str
    value: float | None
    exact: float
    band: tuple[float, float]
    word: str
    reason: str


@dataclass(frozen=True)
class WorkPoint:
    """A run of a curve of error over cost: the program's step halved `refine` times.

    The error is the largest of the problem's errors, each over the half-width of its band; 1 is just allowed.
    """

    refine: int
    step: float  # the program's own [s]
    steps: int
    seconds: float | None
    error: float | None  # None where the run did not complete
    outcome: str


@dataclass(frozen=True)
class EngineCell:
    """A program's answer to a problem.

    Attributes
    ----------
    problem, program
        Row and column.
    verdict
        PASS, PARTIAL, FAIL, NOT RUN, not applicable or not judged.
    says
        What came out, short enough for a table: ``"creeps 48 mm/s"``, ``"stands from 0.2 deg on"``.
    finding
        What its curve shows, in a sentence: "the error halves with the step", "does not shrink with the step".
    error
        Of the quantity that is furthest from its exact value beside its band: the error over the band; 1 is just
        allowed.
    seconds
        Of the run; None where it did not complete.
    reason
        Why there is no PASS or FAIL.
    quantities
        Every quantity of every case.
    points
        The curve of error over cost, coarsest first; empty where the problem has none.
    """

    problem: str
    program: str
    verdict: str
    says: str = ""
    finding: str = ""
    error: float | None = None
    seconds: float | None = None
    reason: str = ""
    quantities: tuple[Quantity, ...] = ()
    points: tuple[WorkPoint, ...] = ()


@dataclass(frozen=True)
class EngineProblem:
    """A problem: what it asks, and which quantity decides."""

    name: str
    scene: str
    title: str
    asks: str


@dataclass(frozen=True)
class EngineProgram:
    """A program; `about` is what it says of itself (program, version, recipe, model, settings)."""

    name: str
    title: str
    recipe: str
    kind: str  # "suite", "chosen" (settings chosen for accuracy), "default" (as it comes) or "user"
    family: str  # "suite", "mechanics", "robotics", "games" or "user"
    installed: bool
    about: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class EngineTable:
    """The field of engines: every problem has a cell for every program."""

    problems: tuple[EngineProblem, ...]
    programs: tuple[EngineProgram, ...]
    cells: Mapping[tuple[str, str], EngineCell]  # by names of problem and program
