"""What theory predicts of programs as they come, and whether a program answers at all.

A program whose default integrator is known answers, on the model of the problem, what this suite's DDA answers under
the same formulas: two independent programs. Where they agree, the adapter states the problem rightly, and the program's
failure is its scheme's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from validation.engine.finished import Derived, Finished, NothingToDerive
from validation.gates.gate import Gate
from validation.metrics.pairs import relative_l2
from validation.problems.problem import PREFIX
from validation.runs.history import DISPLACEMENT
from validation.runs.row import Value
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.studies.field.programs import HABIT, known
from validation.studies.field.scenes import FIELD_PROBLEMS, scene_of
from validation.studies.field.table import STUDY, is_absent

APART = "difference from its integrator"
ANSWERED = "problems answered"


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
    """Yield the differences from what is predicted, and how many problems each program answers."""
    for prediction in PREDICTIONS:
        scene = prediction.scene.name
        needs = (PREFIX + prediction.problem, prediction.program), (scene, HABIT)
        yield Derived(PREFIX + prediction.problem, prediction.name, needs, _difference(needs))
    for program in known():
        yield Derived(STUDY, program.name, (), _answered(program.name, program.recipe))


def _difference(needs: tuple[tuple[str, str], tuple[str, str]]) -> Callable[[Finished], Mapping[str, Value]]:
    def compute(finished: Finished) -> Mapping[str, Value]:
        answer, expected = (finished.history(*need) for need in needs)
        if answer is None or expected is None:
            return {}
        return {APART: relative_l2(answer.columns[DISPLACEMENT], expected.columns[DISPLACEMENT])}

    return compute


def _answered(program: str, recipe: str) -> Callable[[Finished], Mapping[str, Value]]:
    def compute(finished: Finished) -> Mapping[str, Value]:
        rows = [finished.rows.get((PREFIX + name, program)) for name in FIELD_PROBLEMS]
        present = [row for row in rows if row is not None]
        endings = [(row.outcome is Outcome.NOT_APPLICABLE, "; ".join(row.notes)) for row in present]
        if not present or is_absent(endings):
            raise NothingToDerive(f"not installed: {recipe}")
        return {ANSWERED: float(sum(row.outcome is Outcome.COMPLETED for row in present))}

    return compute


def gates() -> Iterator[Gate]:
    """Yield the gates on predictions, and that a program which is installed answers."""
    for prediction in PREDICTIONS:
        yield Gate(PREFIX + prediction.problem, (prediction.name,), APART, 0.0, prediction.band, prediction.why)
    for program in known():
        why = "a program that is installed answers a problem at least; there are no more than all"
        yield Gate(STUDY, (program.name,), ANSWERED, 1.0, float(len(FIELD_PROBLEMS)), why)
