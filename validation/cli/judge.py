"""The command ``judge``: what a program answers, by a solver, a file or a folder of answers, and gates on its steps."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from validation.cli.app import (
    BAD_INPUT,
    GATE_FAILED,
    NUMERICAL_FAILURE,
    ColumnsOption,
    JsonOption,
    ScaleOption,
    SetOption,
    _progress,
    app,
    one_case,
    print_warnings,
)
from validation.cli.printing.output import echo, echo_json, print_blocks
from validation.errors import InputError
from validation.runs import extras

if TYPE_CHECKING:
    from validation.problems.answers import AnswerSet
    from validation.problems.problem import Problem

ASKED = "judge --help names the problems, dda-validate list scenes the built-in scenes"
INSTALLED = "installed"  # in the place of a source: all solvers that installed packages bring


@app.command()
def judge(
    source: Annotated[
        str,
        typer.Argument(
            help="Who answers: a solver (module:attribute, or a name of `list solvers`), ./program, a table of one "
            "history, a folder of answers or a directory of such; `installed`: all solvers of other packages.",
            metavar="SOLVER|FILE|DIR",
        ),
    ],
    asked: Annotated[
        list[str] | None,
        typer.Argument(
            help="What is asked: problems, scenes or scene files; by default all problems, of a folder those that it "
            "answers.",
            metavar="[PROBLEM|SCENE]...",
        ),
    ] = None,
    beside: Annotated[
        list[str] | None, typer.Option("--beside", help="Another one who answers, for a table.", metavar="SOLVER|DIR")
    ] = None,
    study: Annotated[
        list[str] | None,
        typer.Option(
            "--study",
            help="Put the solver in the place of dda and run the gates of this study that apply, `all` of every one.",
            metavar="NAME",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Write the site of the answers into a directory, a table, pages with curves, badges, verdicts.json; "
            "or the table as a PDF.",
            metavar="DIR|FILE.pdf",
        ),
    ] = None,
    keep: Annotated[
        Path | None,
        typer.Option(help="Copy judged folders of answers to DIR/PROGRAM/VERSION/SETTINGS.", metavar="DIR"),
    ] = None,
    layout: Annotated[
        bool, typer.Option("--layout", help="Refuse folders that do not lie in PROGRAM/VERSION/SETTINGS.")
    ] = False,
    require: Annotated[
        list[str] | None,
        typer.Option("--require", help="Fail with status 3 if this solver gives no answer at all.", metavar="NAME"),
    ] = None,
    columns: ColumnsOption = None,
    scale: ScaleOption = None,
    assignments: SetOption = None,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="List all failing gates.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Judge what a program answers against exact motions and numbers, with the cause of a failure.

    Problems of one block: locked, opening, rebound, sliding, creep, rocking; of columns: column, stack, mass-ratio,
    spall, cradle, joint; of boxes on a ground, whose numbers are judged: standing, restitution, bouncing, tumbling,
    pile, heavy-top, toppling, shaken, impact, and their cases. They and a folder to fill in come with dda-validate
    export-pack. A column passes where its error is below what one per cent of the problem's data changes. PARTIAL: the
    columns that it reports pass, others that the problem asks for are withheld. Stale: it answers an earlier pack, in
    which the problem was another. What is wrong with files is listed: file and field, in tables line and character.
    Exit status: 0 all passes, 1 something does not or in part only, 2 bad input, 3 a run ended in a named failure.

    Example: [bold]dda-validate judge my_solver:solve locked[/bold] or [bold]dda-validate judge answers/[/bold]
    """
    if study:
        options = {"--beside": beside, "--out": out, "--keep": keep, "--set": assignments}
        for option, value in options.items():
            if value:
                raise InputError("excludes --study", field=option, value=value)
        _judge_by_gates(source, study, verbose, as_json)
    if out is not None:
        extras.require("--out", *(extras.PDF if out.suffix == ".pdf" else extras.SITE))
    if assignments and not asked:
        raise InputError("goes with a problem or a scene", field="--set", value=assignments[0])
    with all_defects(), _progress("judge") as progress:
        problems = [_asked(name, assignments) for name in asked or ()]
        sets = []
        for one in _sources([source, *(beside or ())]):
            sets += _answers(one, problems, layout, (columns, scale), progress)
        if len(sets) == 1 and len(sets[0].answers) == 1:
            _refuse_inapplicable(sets[0])
        judged, written = _judged_and_written(sets, out, keep, progress)
    _print(judged, as_json)
    for line in written:
        if not as_json:
            echo(line)
    raise typer.Exit(_status(judged, require or ()))


def _sources(named: Sequence[str]) -> list[str]:
    """Return who answers, `installed` spelled out; each once."""
    from validation.solvers.registry import entry_points

    sources: list[str] = []
    for name in named:
        sources += entry_points() if name == INSTALLED else [name]
    if not sources:
        raise InputError("no other package brings a solver", field="SOLVER", value=repr(INSTALLED))
    return list(dict.fromkeys(sources))


def _asked(name: str, assignments: list[str] | None) -> Problem:
    """Return a problem of the pack by name, or the one that a scene poses."""
    from validation.problems.problem import names, problem, problem_of
    from validation.scenes.scene import parse_assignment, scene_names
    from validation.scenes.unknown import did_you_mean

    if name not in names():
        if name not in scene_names() and not Path(name).exists():
            advice = did_you_mean(Path(name).stem, [*names(), *scene_names()]) or ASKED
            raise InputError("no such problem, scene or scene file", source=name, advice=advice)
        return problem_of(one_case(name, assignments))
    if not assignments:
        return problem(name)
    scene = problem(name).scene.with_values(dict(map(parse_assignment, assignments)))
    print_warnings(scene)
    return problem_of(scene)


def _answers(
    source: str, problems: Sequence[Problem], layout: bool, header: tuple[str | None, str | None], progress: Any
) -> list[AnswerSet]:
    """Return what one source answers; `header` is what tables call columns, and factors of them."""
    from validation.problems import answers
    from validation.problems.problem import names, problem
    from validation.solvers.history_table import HeaderNames
    from validation.solvers.registry import is_program, is_solver, solver_names
    from validation.suite.judging import answers_of

    place = Path(source)
    if os.sep not in source and source not in solver_names() and is_program(os.path.join(".", source)):
        source = os.path.join(".", source)
    if source in solver_names() or is_program(source) or (is_solver(source) and ":" in source):
        return [answers_of(source, problems or list(map(problem, names())), progress)]
    if place.is_dir() and (layout or any(place.rglob(answers.FILE))):
        return answers.read_sets(place, layout, progress, {posed.name: posed for posed in problems} or None)
    if place.is_dir() or place.is_file():
        answered = (name for name in names() if (place / f"{name}{answers.TABLE}").exists())
        asked = problems or list(map(problem, answered))  # to pose them all takes a second
        ours = list(dict.fromkeys(["time", *(column for posed in asked for column in posed.columns)]))
        return [answers.read_tables(place, asked, HeaderNames.typed(*header, ours))]
    rule = "must be a solver, module:attribute, ./program, a file of a history or a directory of answers"
    raise InputError(rule, field="SOLVER", value=repr(source), advice=answers.EXPORT)


def _refuse_inapplicable(answer_set: AnswerSet) -> None:
    """Refuse a solver's only answer where it does not apply, and end the command where it gave none."""
    from validation.gates.gate import Status

    (answer,) = answer_set.answers
    if answer.status is Status.NOT_APPLICABLE:
        raise InputError(f"solver {answer_set.place} does not apply: {answer.reason}", source=answer.name)
    if answer.status in (Status.NOT_RUN, Status.FAIL):
        echo(f"{answer.name} {answer_set.place}: {answer.status}: {answer.reason}")
        raise typer.Exit(NUMERICAL_FAILURE)


def _judged_and_written(
    sets: Sequence[AnswerSet], out: Path | None, keep: Path | None, progress: Any
) -> tuple[list[AnswerSet], list[str]]:
    """Judge answers, keep them and write their pages where that is asked for; return what was written in words."""
    from validation.problems import answers
    from validation.suite.judging import judged_sets

    judged = judged_sets(sets, progress)
    places = [] if keep is None else answers.keep(sets, keep)  # first: what it refuses leaves no page
    written = [f"kept in {place}" for place in places]
    if out is not None and out.suffix == ".pdf":
        from validation.report.chapters.answers import first_page
        from validation.report.render.pdf import write_document

        written.append(f"wrote {write_document(out, lambda directory: first_page(judged))}")
    elif out is not None:
        from validation.report.site.submissions import write_site

        written.append(f"wrote {write_site(judged, out, progress)}")
    return judged, written


def _print(judged: Sequence[AnswerSet], as_json: bool) -> None:
    """Print one answer with what its verdict rests on, several as a table, those of several programs side by side."""
    from validation.report.chapters import answers
    from validation.report.chapters.judged import verdict_blocks
    from validation.suite.judging import JudgedAnswer

    if as_json:
        echo_json(answers.verdicts(judged))
        return
    if len(judged) > 1 and all(one.place.name == str(one.place) for one in judged):
        print_blocks([answers.answer_table(judged), *answers.reason_blocks(judged)])
        return
    for one in judged:
        answer = one.answers[0]
        if len(one.answers) == 1 and isinstance(answer, JudgedAnswer):
            print_blocks(verdict_blocks(answer, f"{one.program} on {answer.problem.name}: "))
        else:
            _print_set(one)


def _print_set(judged: AnswerSet) -> None:
    """Print the verdict on each answer of a program, then how many passed."""
    from validation.gates.gate import Status
    from validation.report.blocks import TableColumn, table
    from validation.report.chapters.answers import answered, cells, headline

    echo(f"{judged.title}: {headline(judged)}\n")
    rows = []
    unanswered: dict[str, list[str]] = {}
    for cell in answered(judged):
        if cell.status in (Status.NOT_APPLICABLE, Status.NOT_RUN):
            unanswered.setdefault(f"{cell.status}: {cell.reason}", []).append(cell.problem)
            continue
        explanation = "; ".join(text for text in (cell.column, cell.reason) if text)
        rows.append((cell.problem, str(cell.status), cell.error, cell.allowed, explanation))
    error, allowed = (TableColumn(title, "decimal") for title in ("error", "allowed"))
    if rows:
        print_blocks([table(("problem", "verdict", error, allowed, "what decides, and the cause"), rows)])
    for reason, problems in unanswered.items():
        echo(f"\n{reason}\n  {', '.join(problems)}")
    missing = len(cells(judged)) - len(answered(judged))
    echo(f"\n{missing} problems of the pack are not answered\n" if missing else "")


def _status(judged: Sequence[AnswerSet], required: Sequence[str]) -> int:
    """Return the exit status: PARTIAL is no PASS, since what is withheld may be what is wrong."""
    from validation.gates.gate import Status
    from validation.report.chapters.answers import summary

    for name in required:
        of_solver = [one.answers for one in judged if str(one.place) == name]
        reasons = [answer.reason for answers in of_solver for answer in answers if answer.history is None]
        if not any(answer.history is not None for answers in of_solver for answer in answers):
            echo(
                f"error: --require: {name} answered nothing: {reasons[0] if reasons else 'it was not asked'}", err=True
            )
            return NUMERICAL_FAILURE
    return GATE_FAILED if any(status is not Status.PASS for status in summary(judged)) else 0


@contextmanager
def all_defects() -> Iterator[None]:
    """End the command with all defects of answers' files, one a line, where there are several."""
    from validation.runs.defects import DefectsError
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


# ---- gates ----


def _judge_by_gates(source: str, studies: Sequence[str], verbose: bool, as_json: bool) -> NoReturn:
    """Run the gates of studies with a solver in the place of dda, and print what they tell."""
    import tempfile

    from validation.gates.gate import Status
    from validation.runs.results import Results
    from validation.solvers.registry import get_solver
    from validation.suite.own_solver.block import block, wrapped
    from validation.suite.own_solver.gates import applying
    from validation.suite.own_solver.session import Session, plain

    get_solver(source).check_loads()
    known = list(dict.fromkeys(study for study, _ in applying().values()))
    for name in studies:
        if name not in (*known, "all"):
            raise InputError(f"must be all or one of {', '.join(known)}", field="--study", value=repr(name))
    gates = [name for name, (study, _) in applying().items() if study in studies or "all" in studies]
    reports = []
    with tempfile.TemporaryDirectory() as place, _progress("judge") as progress:
        session = Session(source, Results(Path(place)))
        for number, name in enumerate(gates):
            progress(number, len(gates), name)
            reports.append(session.judge(name)[1])
        lines = block(reports, every=verbose)
    if as_json:
        echo_json([plain(report) | {"results": ""} for report in reports])
    else:
        for line in wrapped(lines):
            echo(line)
    judged = [report.status for report in reports if report.status != Status.NOT_RUN]
    if not judged:
        echo("no gate was judged", err=True)
    raise typer.Exit(GATE_FAILED if not judged or Status.FAIL in judged else 0)
