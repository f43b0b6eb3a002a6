"""What `judge` does with files: answers judged, defects of submitted files printed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from validation.cli.app import BAD_INPUT
from validation.cli.printing.output import echo
from validation.errors import InputError

if TYPE_CHECKING:
    from validation.problems.answers import AnswerSet
    from validation.problems.problem import Problem
    from validation.report.chapters.judged import JudgedAnswer
    from validation.report.chapters.judged_boxes import JudgedBoxes
    from validation.report.site.submissions import JudgedSet
    from validation.runs.history import History

Progress = Callable[[int, int, str], None]


def judged_answer(
    problem: Problem,
    history: History,
    about: tuple[tuple[str, str], ...],
    step: Callable[[str], None],
    warnings: Sequence[str] = (),
) -> JudgedAnswer:
    """Judge an answer, and look for the cause of a failure.

    Parameters
    ----------
    problem
        The problem.
    history
        The answer.
    about
        What the answer says of itself: field and text.
    step
        Told what is done next.
    warnings
        What makes the verdict worth less, in sentences.
    """
    from validation.metrics.sameness import is_identical
    from validation.problems.bands import standard
    from validation.problems.judge import Word, judge
    from validation.report.chapters.judged import JudgedAnswer

    step("the exact motion and the bands")
    reference = standard(problem)
    judgement = judge(problem, history, reference)
    identified_cause = None
    # of rigid boxes no other motion is at hand that could explain theirs
    if judgement.word is Word.FAIL and problem.scene.rigid is None:
        from validation.problems.cause import cause

        step("the cause")
        identified_cause = cause(problem, history, reference)
    if is_identical(history, reference.exact):
        warnings = [
            *warnings,
            "It is bit for bit the exact motion that it is judged by: the suite's own answer, handed back.",
        ]
    return JudgedAnswer(problem, history, reference, judgement, identified_cause, about, tuple(warnings))


def judged_sets(sets: Sequence[AnswerSet], progress: Progress) -> list[JudgedSet]:
    """Judge all answers of folders."""
    from validation.problems.boxes import measured
    from validation.problems.problem import Problem
    from validation.problems.questions import BoxQuestion
    from validation.report.chapters.judged_boxes import JudgedBoxes
    from validation.report.site.submissions import JudgedSet

    total = sum(len(answer_set.answers) for answer_set in sets)
    number = 0
    judged_of_sets = []
    for answer_set in sets:
        judged: dict[str, JudgedAnswer | JudgedBoxes] = {}
        for answer in answer_set.answers:
            name = " ".join([answer_set.program, answer_set.settings_name, answer.name])

            def step(label: str, name: str = name, number: int = number) -> None:
                progress(number, total, f"{name}: {label}")

            if isinstance(answer.problem, BoxQuestion) and answer.history is not None:
                step("the numbers")
                numbers = measured(answer.problem.quantities, answer.history)
                judged[answer.name] = JudgedBoxes(answer.problem, answer.history, numbers)
            elif isinstance(answer.problem, Problem) and answer.history is not None:
                about = (("not reported", ", ".join(answer.withheld)),) if answer.withheld else ()
                judged[answer.name] = judged_answer(answer.problem, answer.history, about, step)
            number += 1
        judged_of_sets.append(JudgedSet(answer_set, judged))
    return judged_of_sets


@contextmanager
def all_defects() -> Iterator[None]:
    """End the command with all defects of submitted files, one a line, where there are several."""
    from validation.problems.defects import DefectsError
    from validation.runs.text import printable

    try:
        yield
    except DefectsError as error:
        for defect in error.defects:
            echo(f"error: {printable(str(defect))}", err=True)
        if len(error.defects) > 1:
            files = len({str(defect.source).partition(":")[0] for defect in error.defects})
            echo(f"{len(error.defects)} defects in {files} file{'s' if files > 1 else ''}; nothing is judged", err=True)
        raise typer.Exit(BAD_INPUT) from None


def made_directory(place: Path) -> Path:
    """Return a directory, made where it is not there yet.

    Raises
    ------
    InputError
        It cannot be made.
    """
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"cannot be made: {place}: {error.strerror}", field="--out", advice="choose another place"
        ) from None
    return place
