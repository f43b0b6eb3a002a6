"""The command ``judge``: answers to problems, from any program."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.cli.app import GATE_FAILED, NUMERICAL_FAILURE, JsonOption, SetOption, _progress, app, one_case
from validation.cli.judging import all_defects, judged_answer, judged_sets, made_directory
from validation.cli.printing.output import echo, echo_json, print_blocks
from validation.errors import InputError
from validation.runs import extras

REPEATED_WITHIN = 30.0  # s: a user's solver that took no longer runs a second time, which shows whether it repeats

if TYPE_CHECKING:
    from validation.problems.problem import Problem
    from validation.report.chapters.judged import JudgedAnswer
    from validation.report.site.submissions import JudgedSet
    from validation.runs.history import History
    from validation.runs.run import Run


@app.command()
def judge(
    target: Annotated[
        str,
        typer.Argument(
            help="Directory with submission.json and the answers as CSV files, or a directory of such; with --solver a "
            "problem, scene or scene file.",
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
        typer.Option(
            help="Directory for page and badge, by default that of the submission; of answers to several problems the "
            "directory for their site, by default none.",
            metavar="DIR",
        ),
    ] = None,
    keep: Annotated[
        Path | None,
        typer.Option(help="Copy the judged answers to DIR/PROGRAM/VERSION/SETTINGS, see docs.", metavar="DIR"),
    ] = None,
    site: Annotated[
        Path | None,
        typer.Option(
            help="Write the site of all submissions below the directory, PROGRAM/VERSION/SETTINGS: a table, a page a "
            "program, badges, verdicts.json; verdicts leave the exit status alone.",
            metavar="DIR",
        ),
    ] = None,
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Judge answers to problems against their exact motions, and write page and badge.

    Problems of one block: locked, opening, rebound, sliding, creep, rocking; of columns: column, stack, mass-ratio,
    spall, cradle, joint; of rigid boxes, whose numbers are judged: standing, restitution, bouncing, tumbling, pile,
    heavy-top, toppling, shaken, impact, and in folders of answers their cases. They and folders to fill in, of one
    problem or of all, come with dda-validate export-pack. A column passes where its error is below what one per cent of
    the problem's data changes. PARTIAL: the columns that it reports pass, others that the problem asks for are
    withheld. Stale: it answers an earlier pack, in which the problem was another. What is wrong with the files is
    listed with file, line and character. Exit status: 0 it passes, 1 it does not or in part only, 2 bad input, 3 the
    solver ended in a named failure.

    Example: [bold]dda-validate judge my-answer[/bold] or [bold]dda-validate judge locked --solver
    my_solver:solve[/bold]
    """
    if site is not None:
        given = {"--solver": solver, "--scene": scene, "--out": out, "--keep": keep, "--set": assignments}
        for option, value in given.items():
            if value:
                raise InputError("excludes --site", field=option, value=value)
        extras.require("--site", *extras.SITE)
        _write_submissions(Path(target), site)
        return
    if out is not None:
        extras.require("--out", *extras.SITE)
    if solver is None and scene is None and _has_answers(Path(target)):
        _refuse_set(assignments)
        with all_defects():
            _judge_folder(Path(target), out, keep, as_json)
        return
    if keep is not None:
        rule = "goes with a folder of answers, whose submission.json says licence, scheme and step"
        raise InputError(rule, field="--keep", advice="dda-validate export-pack DIR writes one to fill in")
    with all_defects(), _progress("judge") as progress:
        judged, program = _judge_target(target, solver, scene, assignments, progress)
        directory = Path(target) if out is None and solver is None else out
        written: list[Path] = []
        page_lacks = extras.missing(*extras.SITE)
        if directory is not None and page_lacks is None:
            from validation.report.site.judged import write_judged

            progress(3, 3, "page and badge")
            written = write_judged(judged, program, made_directory(directory))
    if as_json:
        from validation.report.chapters.judged import as_data

        echo_json(as_data(judged, program))
    else:
        _print(judged, program, written)
    if directory is not None and page_lacks is not None:
        echo(f"no page and badge: {page_lacks}", err=True)
    if judged.judgement.word != "PASS":  # PARTIAL neither: what is withheld may be what is wrong
        raise typer.Exit(GATE_FAILED)


def _has_answers(directory: Path) -> bool:
    """Whether a directory is not that of an answer to one problem, stated by itself."""
    from validation.problems.data import SUBMISSION
    from validation.problems.stated import read_document
    from validation.problems.submission import EXPORT, FILE

    if not directory.is_dir():
        return False
    if not (directory / FILE).exists():
        return any(directory.rglob(FILE))
    with all_defects():
        stated = read_document(directory / FILE, EXPORT).content
    return stated.get("format") != SUBMISSION and "problem" not in stated


def _refuse_set(assignments: list[str] | None) -> None:

    if assignments:
        raise InputError("goes with --scene or --solver", field="--set", value="a submission to a problem of the pack")


def _judge_folder(root: Path, out: Path | None, keep: Path | None, as_json: bool) -> None:
    """Judge folders of answers, write their site and keep them where that is asked for."""
    from validation.problems import answers
    from validation.problems.judge import Word
    from validation.report.site.submissions import summary, verdicts, write_site

    with _progress("judge", between_calls=True) as progress:
        sets = answers.read_sets(root, progress=progress)
        judged = judged_sets(sets, progress)
        places = [] if keep is None else answers.keep(sets, keep)  # first: what it refuses leaves no page
        written = [f"kept in {place}" for place in places]
        if out is not None:
            written.append(f"wrote {write_site(judged, out, progress)}")
    if as_json:
        echo_json(verdicts(judged))
    else:
        for one in judged:
            _print_set(one)
        for line in written:
            echo(line)
    if any(count for word, count in summary(judged).items() if word != Word.PASS):
        raise typer.Exit(GATE_FAILED)


def _write_submissions(source: Path, out: Path) -> None:
    """Judge all submitted answers and write their site."""
    from validation.problems.answers import read_sets
    from validation.report.site.submissions import write_site

    with all_defects(), _progress("judge", between_calls=True) as progress:
        sets = read_sets(source, in_layout=True, progress=progress)
        page = write_site(judged_sets(sets, progress), out, progress)
    echo(f"wrote {page}: {len(sets)} folder{'s' if len(sets) > 1 else ''} of answers")


def _print_set(judged: JudgedSet) -> None:
    """Print the verdict on each answer of a folder, then how many passed."""
    from validation.report.blocks import TableColumn, table
    from validation.report.site.submissions import NOT_ANSWERED, cells, headline

    name = " ".join(part for part in (judged.answers.program, judged.answers.settings_name) if part)
    echo(f"{name}: {headline(judged)}\n")
    answered_cells = [cell for cell in cells(judged) if cell.word != NOT_ANSWERED]
    rows = []
    for cell in answered_cells:
        explanation = "; ".join(text for text in (cell.column, cell.reason) if text)
        rows.append((cell.problem, cell.word, cell.error, cell.allowed, explanation))
    error, allowed = (TableColumn(title, "decimal") for title in ("error", "allowed"))
    print_blocks([table(("problem", "verdict", error, allowed, "what decides, and the cause"), rows)])
    missing = len(cells(judged)) - len(answered_cells)
    echo(f"\n{missing} problems of the pack are not answered\n" if missing else "")


def _judge_target(
    target: str, solver: str | None, scene: str | None, assignments: list[str] | None, progress: Any
) -> tuple[JudgedAnswer, str]:
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
    if scene is None:
        _refuse_set(assignments)
    scene_problem = None if scene is None else problem_of(one_case(scene, assignments))
    progress(0, 3, "reading, and the exact motion")
    submission = read_submission(Path(target), scene_problem)
    data = submission.data
    about = [(field, printable(getattr(data, field))) for field in ("program", "version", "settings", "who")]
    if data.not_reported:
        about.append(("not reported", ", ".join(data.not_reported)))
    name = printable(f"{data.program} {data.version}")
    return judged_answer(submission.problem, submission.history, tuple(about), _step(progress)), name


def _step(progress: Any) -> Callable[[str], None]:
    """Return what tells a progress bar what is done next with one answer."""
    steps = ("the exact motion and the bands", "the cause")
    return lambda label: progress(1 + steps.index(label), 3, label)


def _judge_solver(target: str, solver: str, assignments: list[str] | None, progress: Any) -> tuple[JudgedAnswer, str]:
    from validation.engine.measure import completed
    from validation.problems.boxes import ASKS as BOX_PROBLEMS
    from validation.problems.problem import PROBLEMS, problem, problem_of, scene_name
    from validation.solvers.registry import get_solver
    from validation.solvers.user import SAME_AS, UserSolver

    of_pack = target in PROBLEMS or target in BOX_PROBLEMS
    source = scene_name(target) if of_pack else target
    case = one_case(source, assignments)
    posed_problem: Problem = problem(target) if of_pack and not assignments else problem_of(case)
    adapter = get_solver(solver)
    if isinstance(adapter, UserSolver):
        adapter.check_module()
    progress(0, 3, f"{case.name} {solver}")
    run = completed(adapter, case)
    history = _completed_history(run, case.name, solver)
    if not isinstance(adapter, UserSolver):
        return judged_answer(posed_problem, history, (("solver", solver),), _step(progress)), solver
    warnings = [f"It is {note}: the suite's own solver was judged." for note in run.notes if note.startswith(SAME_AS)]
    if sum(run.seconds.values()) < REPEATED_WITHIN:
        warnings += _not_repeatable(history, completed(adapter, case).history)
    about = (("solver", solver), *adapter.about().items())
    return judged_answer(posed_problem, history, about, _step(progress), warnings), solver


def _not_repeatable(history: History, again: History | None) -> list[str]:
    """Return in a sentence how far a second run of a user's solver is from the first; nothing where it is the same."""
    from validation.metrics.sameness import largest_difference
    from validation.runs.numbers import error_percent

    if again is None:
        return ["Not repeatable: a second run gave no history; the verdict is one of several."]
    column, difference = largest_difference(history, again)
    if not column:
        return []
    size = "in length or columns" if difference == float("inf") else f"by {error_percent(difference)} in {column}"
    return [f"Not repeatable: a second run differs {size} (relative L2); the verdict may change from run to run."]


def _completed_history(run: Run, case: str, solver: str) -> History:
    """Return the history of a run, or end the command with what it ended in."""
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


def _print(judged: JudgedAnswer, program: str, written: list[Path]) -> None:
    """Print the verdict first, then what it rests on."""
    from validation.report.chapters.judged import verdict_blocks

    print_blocks(verdict_blocks(judged, f"{program} on {judged.problem.name}: "))
    for path in written:
        echo(f"wrote {path}")
