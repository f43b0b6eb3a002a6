"""What theory predicts of programs as they come.

A program whose default integrator is known answers, on the model of the problem, what this suite's DDA answers under
the same formulas: two independent programs. Where they agree, the adapter states the problem rightly, and the program's
failure is its scheme's.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from validation.engine.finished import Derived, Finished
from validation.gates.gate import Gate
from validation.metrics.pairs import relative_l2
from validation.problems.problem import PREFIX
from validation.runs.history import DISPLACEMENT
from validation.runs.row import Value
from validation.scenes.scene import Scene
from validation.studies.field.scenes import scene_of
from validation.suite.programs import HABIT

APART = "difference from its integrator"


@dataclass(frozen=True)
class Prediction:
    """What a program as it comes is predicted to answer: this suite's DDA under its formulas."""

    program: str
    problem: str
    values: Mapping[str, Any]  # of the scene's [time]
    band: float  # relative L2
    why: str

    @property
    def scene(self) -> Scene:
        """The scene that predicts it."""
        name = f"{PREFIX}{self.problem} as {self.program} steps"
        predicting = scene_of(self.problem).with_values({**self.values, "run.solvers": [HABIT]})
        return predicting.model_copy(update={"name": name})

    @property
    def name(self) -> str:
        """Name of the derived row."""
        return f"{self.program} as predicted"


PREDICTIONS = (
    Prediction(
        "opensees-default",
        "locked",
        {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "zero"},
        1e-6,
        "its transient analysis is Newmark's with 1/2 and 1/4 from zero acceleration: dda with alpha = 1/4, "
        "delta = 1/2 by other code; band: its tolerance of Newton's iteration, well above rounding",
    ),
    Prediction(
        "siconos-default",
        "locked",
        {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"},
        1e-6,
        "theta = 1/2 of a linear system without contact is the trapezoidal rule, which is Newmark's with 1/4 and 1/2 "
        "from M A0 = F: dda by other code; band: sums of a printed answer, well above rounding",
    ),
)


def scenes() -> Iterator[Scene]:
    """Yield the scenes that predict."""
    for prediction in PREDICTIONS:
        yield prediction.scene


def derived() -> Iterator[Derived]:
    """Yield the differences from what is predicted."""
    for prediction in PREDICTIONS:
        needs = (PREFIX + prediction.problem, prediction.program), (prediction.scene.name, HABIT)
        compute = functools.partial(difference, needs)
        yield Derived(PREFIX + prediction.problem, prediction.name, needs, compute)


def difference(needs: tuple[tuple[str, str], ...], finished: Finished) -> Mapping[str, Value]:
    """Return the difference of an answer from the predicted one."""
    answer, expected = (finished.history(*need) for need in needs)
    if answer is None or expected is None:
        return {}
    return {APART: relative_l2(answer.columns[DISPLACEMENT], expected.columns[DISPLACEMENT])}


def gates() -> Iterator[Gate]:
    """Yield the gates on predictions."""
    for prediction in PREDICTIONS:
        yield Gate(PREFIX + prediction.problem, (prediction.name,), APART, 0.0, prediction.band, prediction.why)
