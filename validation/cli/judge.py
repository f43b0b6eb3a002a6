"""The command ``judge``: an answer to a problem, from any program."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.cli.app import GATE_FAILED, NUMERICAL_FAILURE, SetOption, _progress, app, one_case
from validation.cli.damping import JsonOption
from validation.cli.printing.output import echo

REPEATED_WITHIN = 30.0  # s: a user's solver that took no longer runs a second time, which shows whether it repeats

if TYPE_CHECKING:
    from validation.problems.bands import Standard
    from validation.problems.cause import Cause
    from validation.problems.problem import Problem
    from validation.report.chapters.judged import Judged
    from validation.runs.history import History
    from validation.runs.run import Run


@app.command()
def judge(
    target: Annotated[
        str,
        typer.Argument(
            help="Directory with submission.json and one CSV file; with --solver a problem, scene or scene file.",
            metavar="DIR|PROBLEM|SCENE",
        ),
    ],
    solver: Annotated[
        str | None, typer.Option(help="Run this solver and judge its answer, see `dda-validate list`.", metavar="NAME")
    ] = None,
    scene: Annotated[
        str | None,
        typer.Option(help="The submission answers this scene, not a problem of the pack.", metavar="SCENE"),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Directory for page and badge; by default that of the submission.", metavar="DIR"),
    ] = None,
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Judge an answer to a problem against its exact motion, and write page and badge.

    The problems and a submission to fill in come with dda-validate export-pack. A column passes where its error is
    below what one per cent of the problem's data changes. PARTIAL: the columns that it reports pass, others that the
    problem asks for are withheld. Exit status: 0 it passes, 1 it does not or in part only, 2 bad input, 3 the solver
    ended in a named failure.

    Example: [bold]dda-validate judge my-answer[/bold] or [bold]dda-validate judge locked --solver
    my_solver:solve[/bold]
    """
    with _progress("judge") as progress:
        judged, program = _judged(target, solver, scene, assignments, progress)
        place = out or (Path(target) if solver is None else None)
        written = [] if place is None else _written(judged, program, place, progress)
    if as_json:
        echo(json.dumps(as_data(judged, program), indent=1, allow_nan=False))
    else:
        _print(judged, program, written)
    if judged.judgement.word != "PASS":  # PARTIAL neither: what is withheld may be what is wrong
        raise typer.Exit(GATE_FAILED)


def _judged(
    target: str, solver: str | None, scene: str | None, assignments: list[str] | None, progress: Any
) -> tuple[Judged, str]:
    from validation.errors import InputError
    from validation.problems.problem import problem_of
    from validation.problems.submission import read_submission
    from validation.runs.text import printable

    if solver is not None:
        if scene is not None:
            raise InputError(f"--scene: goes with a submission, got it with --solver {solver}; name the scene first")
        return _of_solver(target, solver, assignments, progress)
    if assignments and scene is None:
        raise InputError("--set: goes with --scene or --solver, got it with a problem of the pack")
    own = None if scene is None else problem_of(one_case(scene, assignments))
    progress(0, 3, "reading, and the exact motion")
    found = read_submission(Path(target), own)
    data = found.data
    about = [(field, printable(getattr(data, field))) for field in ("program", "version", "settings", "who")]
    about += [("not reported", ", ".join(data.not_reported))] if data.not_reported else []
    name = printable(f"{data.program} {data.version}")
    return _with_cause(found.problem, found.history, tuple(about), progress), name


def _of_solver(target: str, solver: str, assignments: list[str] | None, progress: Any) -> tuple[Judged, str]:
    from validation.engine.measure import completed
    from validation.problems.problem import PREFIX, PROBLEMS, problem, problem_of
    from validation.solvers.registry import get_solver
    from validation.solvers.user import SAME_AS, UserSolver

    case = one_case(PREFIX + target if target in PROBLEMS else target, assignments)
    asked: Problem = problem(target) if target in PROBLEMS and not assignments else problem_of(case)
    chosen = get_solver(solver)
    progress(0, 3, f"{case.name} {solver}")
    run = completed(chosen, case)
    history = _history(run, case.name, solver)
    if not isinstance(chosen, UserSolver):
        return _with_cause(asked, history, (("solver", solver),), progress), solver
    warnings = [f"It is {note}: the suite's own solver was judged." for note in run.notes if note.startswith(SAME_AS)]
    if sum(run.seconds.values()) < REPEATED_WITHIN:
        warnings += _not_repeatable(history, completed(chosen, case).history)
    about = (("solver", solver), *chosen.about().items())
    return _with_cause(asked, history, about, progress, warnings), solver


def _not_repeatable(history: History, again: History | None) -> list[str]:
    """Return in a sentence how far a second run of a user's solver is from the first; nothing where it is the same."""
    from validation.metrics.sameness import largest_difference
    from validation.report.chapters.judged import per_cent

    if again is None:
        return ["Not repeatable: a second run gave no history; the verdict is one of several."]
    column, difference = largest_difference(history, again)
    if not column:
        return []
    size = "in length or columns" if difference == float("inf") else f"by {per_cent(difference)} in {column}"
    return [f"Not repeatable: a second run differs {size} (relative L2); the verdict may change from run to run."]


def _history(run: Run, case: str, solver: str) -> History:
    """Return the history of a run, or end the command with what it ended in."""
    from validation.errors import InputError
    from validation.runs.run import Outcome

    why = "; ".join(run.notes)
    if run.outcome in (Outcome.NOT_APPLICABLE, Outcome.REFUSED):
        raise InputError(f"{case}: solver {solver} does not apply: {why}")
    if run.outcome is Outcome.NOT_RUN:
        raise InputError(f"NOT RUN: {why}")
    if run.outcome is not Outcome.COMPLETED or run.history is None:
        echo(f"{case} {solver}: {run.outcome}: {run.outcome.sentence} {why}".rstrip())
        raise typer.Exit(NUMERICAL_FAILURE)
    return run.history


def _with_cause(
    problem: Problem,
    history: History,
    about: tuple[tuple[str, str], ...],
    progress: Any,
    warnings: Sequence[str] = (),
) -> Judged:
    from validation.metrics.sameness import is_identical
    from validation.problems.bands import standard
    from validation.problems.judge import Word
    from validation.problems.judge import judge as judgement_of
    from validation.report.chapters.judged import Judged

    progress(1, 3, "the exact motion and the bands")
    held: Standard = standard(problem)
    found = judgement_of(problem, history, held)
    why = None
    if found.word is Word.FAIL:
        from validation.problems.cause import cause

        progress(2, 3, "the cause")
        why = cause(problem, history, held)
    if is_identical(history, held.exact):
        warnings = [
            *warnings,
            "It is bit for bit the exact motion that it is judged by: the suite's own answer, handed back.",
        ]
    return Judged(problem, history, held, found, why, about, tuple(warnings))


def _written(judged: Judged, program: str, place: Path, progress: Any) -> list[Path]:
    from validation.errors import InputError
    from validation.gallery.judged import write_judged

    progress(3, 3, "page and badge")
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out: cannot be made: {place}: {error.strerror}; choose another place") from None
    return write_judged(judged, program, place)


def as_data(judged: Judged, program: str) -> dict[str, Any]:
    """Return the judgement as plain data."""
    from validation.problems.data import PACK, united

    columns = [
        {
            "column": united(one.name),
            "verdict": str(one.word),
            "error": one.error if one.error is None or one.error < float("inf") else "inf",
            "allowed": one.band,
            "until_s": one.until,
            "within_until_s": one.within,
            "reason": one.reason,
        }
        for one in judged.judgement.columns
    ]
    why = judged.cause
    return {
        "pack": PACK,
        "problem": judged.problem.name,
        "program": program,
        "verdict": str(judged.judgement.word),
        "not_reported": [united(name) for name in judged.judgement.withheld],
        "cause": None if why is None else _cause_data(why),
        "columns": columns,
        "warnings": list(judged.warnings),
        "about": dict(judged.about),
    }


def _cause_data(why: Cause) -> dict[str, Any]:
    told = {"sentence": why.sentence, "ids": list(why.ids), "values": why.values}
    return told | ({"would_tell": why.would_tell} if why.would_tell else {})


def _print(judged: Judged, program: str, written: list[Path]) -> None:
    """Print the verdict first, then what it rests on."""
    from validation.problems.data import united
    from validation.problems.judge import Word
    from validation.report.chapters.judged import datum, headline, per_cent, reached

    echo(f"{program} on {judged.problem.name}: {headline(judged)}")
    if judged.judgement.word is Word.PARTIAL:
        missing = ", ".join(map(united, judged.judgement.withheld))
        echo(f"no full PASS (exit status {GATE_FAILED}): the problem asks for {missing} too; report it to be judged")
    for sentence in judged.warnings:
        echo(f"warning: {sentence}")
    if judged.cause is not None:
        echo(f"cause: {judged.cause.sentence}")
        echo(reached(judged))
        if judged.cause.would_tell:
            echo(f"what would tell: {judged.cause.would_tell}")
    echo(f"\n  {'column':<25} {'verdict':<12} {'error':>11} {'allowed':>8}  what one per cent changes")
    for one in judged.judgement.columns:
        why = datum(one, judged.held) or one.reason
        echo(f"  {united(one.name):<25} {one.word:<12} {per_cent(one.error):>11} {per_cent(one.band):>8}  {why}")
    for path in written:
        echo(f"wrote {path}")
