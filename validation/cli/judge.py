"""The command ``judge``: an answer to a problem, from any program."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.cli.app import GATE_FAILED, NUMERICAL_FAILURE, JsonOption, SetOption, _progress, app, one_case
from validation.cli.printing.output import echo, echo_json

REPEATED_WITHIN = 30.0  # s: a user's solver that took no longer runs a second time, which shows whether it repeats

if TYPE_CHECKING:
    from validation.problems.bands import Standard
    from validation.problems.cause import Cause
    from validation.problems.problem import Problem
    from validation.report.chapters.judged import JudgedAnswer
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

    Problems of one block: locked, opening, rebound, sliding, creep, rocking; of columns: column, stack, mass-ratio,
    spall, cradle, joint. They and a submission to fill in come with dda-validate export-pack. A column passes where its
    error is below what one per cent of the problem's data changes. PARTIAL: the columns that it reports pass, others
    that the problem asks for are withheld. Exit status: 0 it passes, 1 it does not or in part only, 2 bad input, 3 the
    solver ended in a named failure.

    Example: [bold]dda-validate judge my-answer[/bold] or [bold]dda-validate judge locked --solver
    my_solver:solve[/bold]
    """
    with _progress("judge") as progress:
        judged, program = _judge_target(target, solver, scene, assignments, progress)
        directory = out
        if directory is None and solver is None:
            directory = Path(target)
        written = [] if directory is None else _write_page(judged, program, directory, progress)
    if as_json:
        echo_json(as_data(judged, program))
    else:
        _print(judged, program, written)
    if judged.judgement.word != "PASS":  # PARTIAL neither: what is withheld may be what is wrong
        raise typer.Exit(GATE_FAILED)


def _judge_target(
    target: str, solver: str | None, scene: str | None, assignments: list[str] | None, progress: Any
) -> tuple[JudgedAnswer, str]:
    from validation.errors import InputError
    from validation.problems.problem import problem_of
    from validation.problems.submission import read_submission
    from validation.runs.text import printable

    if solver is not None:
        if scene is not None:
            raise InputError(
                "goes with a submission",
                field="--scene",
                value=f"--solver {solver} too",
                advice="name the scene first",
            )
        return _judge_solver(target, solver, assignments, progress)
    if assignments and scene is None:
        raise InputError("goes with --scene or --solver", field="--set", value="a submission to a problem of the pack")
    scene_problem = None if scene is None else problem_of(one_case(scene, assignments))
    progress(0, 3, "reading, and the exact motion")
    submission = read_submission(Path(target), scene_problem)
    data = submission.data
    about = [(field, printable(getattr(data, field))) for field in ("program", "version", "settings", "who")]
    if data.not_reported:
        about.append(("not reported", ", ".join(data.not_reported)))
    name = printable(f"{data.program} {data.version}")
    return _judge_history(submission.problem, submission.history, tuple(about), progress), name


def _judge_solver(target: str, solver: str, assignments: list[str] | None, progress: Any) -> tuple[JudgedAnswer, str]:
    from validation.engine.measure import completed
    from validation.problems.problem import PREFIX, PROBLEMS, problem, problem_of
    from validation.solvers.registry import get_solver
    from validation.solvers.user import SAME_AS, UserSolver

    of_pack = target in PROBLEMS
    source = PREFIX + target if of_pack else target
    case = one_case(source, assignments)
    posed_problem: Problem = problem(target) if of_pack and not assignments else problem_of(case)
    adapter = get_solver(solver)
    progress(0, 3, f"{case.name} {solver}")
    run = completed(adapter, case)
    history = _completed_history(run, case.name, solver)
    if not isinstance(adapter, UserSolver):
        return _judge_history(posed_problem, history, (("solver", solver),), progress), solver
    warnings = [f"It is {note}: the suite's own solver was judged." for note in run.notes if note.startswith(SAME_AS)]
    if sum(run.seconds.values()) < REPEATED_WITHIN:
        warnings += _not_repeatable(history, completed(adapter, case).history)
    about = (("solver", solver), *adapter.about().items())
    return _judge_history(posed_problem, history, about, progress, warnings), solver


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


def _completed_history(run: Run, case: str, solver: str) -> History:
    """Return the history of a run, or end the command with what it ended in."""
    from validation.errors import InputError
    from validation.runs.run import Outcome

    why = "; ".join(run.notes)
    if run.outcome in (Outcome.NOT_APPLICABLE, Outcome.REFUSED):
        raise InputError(f"solver {solver} does not apply: {why}", source=case)
    if run.outcome is Outcome.NOT_RUN:
        raise InputError(f"NOT RUN: {why}")
    if run.outcome is not Outcome.COMPLETED or run.history is None:
        echo(f"{case} {solver}: {run.outcome}: {run.outcome.sentence} {why}".rstrip())
        raise typer.Exit(NUMERICAL_FAILURE)
    return run.history


def _judge_history(
    problem: Problem,
    history: History,
    about: tuple[tuple[str, str], ...],
    progress: Any,
    warnings: Sequence[str] = (),
) -> JudgedAnswer:
    from validation.metrics.sameness import is_identical
    from validation.problems.bands import standard
    from validation.problems.judge import Word
    from validation.problems.judge import judge as judgement_of
    from validation.report.chapters.judged import JudgedAnswer

    progress(1, 3, "the exact motion and the bands")
    bands: Standard = standard(problem)
    judgement = judgement_of(problem, history, bands)
    identified_cause = None
    if judgement.word is Word.FAIL:
        from validation.problems.cause import cause

        progress(2, 3, "the cause")
        identified_cause = cause(problem, history, bands)
    if is_identical(history, bands.exact):
        warnings = [
            *warnings,
            "It is bit for bit the exact motion that it is judged by: the suite's own answer, handed back.",
        ]
    return JudgedAnswer(problem, history, bands, judgement, identified_cause, about, tuple(warnings))


def _write_page(judged: JudgedAnswer, program: str, place: Path, progress: Any) -> list[Path]:
    from validation.errors import InputError
    from validation.gallery.judged import write_judged

    progress(3, 3, "page and badge")
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"cannot be made: {place}: {error.strerror}", field="--out", advice="choose another place"
        ) from None
    return write_judged(judged, program, place)


def as_data(judged: JudgedAnswer, program: str) -> dict[str, Any]:
    """Return the judgement as plain data."""
    from validation.problems.data import PACK, united

    columns = [
        {
            "column": united(column.name),
            "verdict": str(column.word),
            "error": column.error if column.error is None or column.error < float("inf") else "inf",
            "allowed": column.band,
            "until_s": column.until,
            "within_until_s": column.within,
            "reason": column.reason,
        }
        for column in judged.judgement.columns
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


def _cause_data(cause: Cause) -> dict[str, Any]:
    statement = {"sentence": cause.sentence, "ids": list(cause.ids), "values": cause.values}
    return statement | ({"would_tell": cause.would_tell} if cause.would_tell else {})


def _print(judged: JudgedAnswer, program: str, written: list[Path]) -> None:
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
    for column in judged.judgement.columns:
        why = datum(column, judged.standard) or column.reason
        error = per_cent(column.error)
        allowed = per_cent(column.band)
        echo(f"  {united(column.name):<25} {column.word:<12} {error:>11} {allowed:>8}  {why}")
    for path in written:
        echo(f"wrote {path}")
