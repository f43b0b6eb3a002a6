"""Answers of programs, judged: those that a folder holds, and those that a solver gives when it is asked."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from validation.engine.measure import completed
from validation.gates.gate import Status
from validation.metrics.sameness import is_identical, largest_difference
from validation.problems.answers import Answer, AnswerSet, stated_by
from validation.problems.bands import Standard, standard
from validation.problems.cause import Cause, cause
from validation.problems.judge import Judgement, judge
from validation.problems.problem import Problem
from validation.runs.history import History
from validation.runs.numbers import error_percent
from validation.runs.progress import Progress
from validation.runs.run import Outcome, Run
from validation.solvers.contract import Solver
from validation.solvers.foreign import SAME_AS
from validation.solvers.registry import get_solver
from validation.solvers.user import Outside

# The first answers of a user's solver that took no longer [s] are run a second time, which shows whether it repeats.
REPEATED, REPEATED_WITHIN = 2, 10.0
# A run that ends so has told that it is wrong; every other end says nothing of the program's mechanics.
WRONG = (Outcome.WRONG_UNITS, Outcome.NOT_A_NUMBER, Outcome.OVERFLOW, Outcome.UNSTABLE)
MISSING = "is not installed"  # what an adapter says where its program is absent
DEFAULTS = "-default"  # ending of the name of a program as it comes
HANDED_BACK = "It is bit for bit the exact motion that it is judged by: the suite's own answer, handed back."


@dataclass(frozen=True, eq=False, kw_only=True)
class JudgedAnswer(Answer):
    """An answer with its verdict."""

    problem: Problem
    history: History
    standard: Standard | None  # None of numbers, which no exact motion is needed for
    judgement: Judgement
    cause: Cause | None  # of a failure


def judged_answer(answer: Answer) -> Answer:
    """Judge an answer, and look for the cause of a failure; one without a history has nothing to judge."""
    problem = answer.problem
    history = answer.history
    if problem is None or history is None:
        return answer
    reference = None if problem.numbers else standard(problem)
    judgement = judge(problem, history, reference)
    identified_cause = None
    warnings = answer.warnings
    # of numbers no other motion is at hand that could explain theirs
    if reference is not None:
        if judgement.status is Status.FAIL:
            identified_cause = cause(problem, history, reference)
        if is_identical(history, reference.exact):
            warnings = (*warnings, HANDED_BACK)
    verdict = {"standard": reference, "judgement": judgement, "cause": identified_cause, "warnings": warnings}
    return JudgedAnswer(**{**vars(answer), **verdict})


def judged_sets(sets: Sequence[AnswerSet], progress: Progress) -> list[AnswerSet]:
    """Judge all answers of some programs."""
    total = sum(len(answer_set.answers) for answer_set in sets)
    number = 0
    judged_of_sets = []
    for answer_set in sets:
        judged = []
        for answer in answer_set.answers:
            progress(number, total, f"{answer_set.program} {answer.name}")
            judged.append(judged_answer(answer))
            number += 1
        judged_of_sets.append(replace(answer_set, answers=tuple(judged)))
    return judged_of_sets


# ---- a solver's answers ----


def answers_of(name: str, problems: Sequence[Problem], progress: Progress) -> AnswerSet:
    """Return what a solver answers to problems.

    Raises
    ------
    InputError
        There is no such solver, or what it reads is no history.
    """
    solver = get_solver(name)
    solver.check_module()
    about = solver.about()
    answers = []
    repeats = REPEATED if isinstance(solver, Outside) else 0
    for number, problem in enumerate(problems):
        progress(number, len(problems), f"{name} {problem.name}")
        answer = _answer(solver, problem)
        if repeats and answer.history is not None and (answer.seconds or 0.0) < REPEATED_WITHIN:
            repeats -= 1
            again = completed(solver, problem.scene).history
            answer = replace(answer, warnings=(*answer.warnings, *_not_repeatable(answer.history, again)))
        answers.append(answer)
    # What a solver says of itself, as a folder of answers states it.
    settings_name = "default" if name.endswith(DEFAULTS) else "chosen"
    if "program" not in about:
        settings_name = ""
    return AnswerSet(
        Path(name),
        stated_by(
            about.get("program", name),
            version=about.get("version", ""),
            settings_name=settings_name,
            settings=about.get("settings", ""),
            contact_model=about.get("model", ""),
        ),
        tuple(answers),
    )


def _answer(solver: Solver, problem: Problem) -> Answer:
    run = completed(solver, problem.scene)
    seconds = sum(run.seconds.values()) if run.seconds else None
    if run.outcome is not Outcome.COMPLETED:
        return Answer(problem.name, problem, None, *_ending(run), seconds=seconds)
    same = [note for note in run.notes if note.startswith(SAME_AS)]
    warnings = tuple(f"It is {note}: the suite's own solver was judged." for note in same)
    return Answer(problem.name, problem, run.history, warnings=warnings, seconds=seconds)


def _ending(run: Run) -> tuple[Status, str]:
    """Return the status of a run without a history, and why."""
    note = run.notes[-1] if run.notes else run.outcome.sentence
    if run.outcome in WRONG:
        sentence = run.outcome.sentence[0].lower() + run.outcome.sentence[1:].rstrip(".")
        return Status.FAIL, note if run.outcome is Outcome.WRONG_UNITS else f"{sentence} ({note})"
    refused = run.outcome in (Outcome.NOT_APPLICABLE, Outcome.REFUSED)
    if refused and MISSING not in note:
        return Status.NOT_APPLICABLE, note
    return Status.NOT_RUN, note if refused or run.outcome is Outcome.NOT_RUN else f"{run.outcome.sentence} {note}"


def _not_repeatable(history: History, again: History | None) -> Iterator[str]:
    """Yield how far a second run of a user's solver is from the first; nothing where it is the same."""
    if again is None:
        yield "Not repeatable: a second run gave no history; the verdict is one of several."
        return
    column, difference = largest_difference(history, again)
    if column:
        size = "in length or columns" if math.isinf(difference) else f"by {error_percent(difference)} in {column}"
        yield f"Not repeatable: a second run differs {size} (relative L2); the verdict may change from run to run."
