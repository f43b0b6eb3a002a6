"""Commands that run: ``list``, ``run`` and ``solve``."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from validation.gates.gate import Verdict
    from validation.runs.records import Judged
    from validation.runs.results import Results
    from validation.runs.run import Run
    from validation.scenes.scene import Scene
    from validation.solvers.contract import Solver
from validation.cli.app import (
    BAD_INPUT,
    GATE_FAILED,
    NUMERICAL_FAILURE,
    PASSED,
    RESULTS,
    BaselineOption,
    FullOption,
    RanksOption,
    ResultsOption,
    SetOption,
    SummaryOption,
    _progress,
    app,
    one_case,
)


@app.command("list")
def list_command(
    what: Annotated[
        str | None, typer.Argument(help="metrics, scenes, solvers or studies: that list in full.", metavar="LIST")
    ] = None,
) -> None:
    """List studies, built-in scenes, solvers and metrics, or one of the four with units, needs and descriptions.

    Example: [bold]dda-validate list[/bold] or [bold]dda-validate list metrics[/bold]
    """
    from validation.cli.listing import LISTS, in_columns
    from validation.errors import InputError
    from validation.metrics.catalogue import METRICS
    from validation.scenes.scene import load_scene, scene_names
    from validation.solvers.registry import solver_names
    from validation.studies.catalogue import STUDIES, get_study

    if what is not None and what not in LISTS:
        raise InputError(f"list: must be one of {', '.join(sorted(LISTS))}, got {what!r}")
    if what is not None:
        typer.echo(in_columns(LISTS[what]()))
        return
    typer.echo("studies")
    for name in STUDIES:
        typer.echo(f"  {name:<18} {get_study(name).title}")
    typer.echo("scenes")
    for name in scene_names():
        typer.echo(f"  {name:<18} {load_scene(name).title}")
    typer.echo(f"solvers\n  {', '.join(solver_names())}\nmetrics\n  {', '.join(METRICS)}")


@app.command()
def run(
    targets: Annotated[
        list[str] | None,
        typer.Argument(
            help="Studies, built-in scenes or scene files (default: core).", metavar="[STUDY|SCENE|FILE]..."
        ),
    ] = None,
    results: ResultsOption = RESULTS,
    assignments: SetOption = None,
    full: FullOption = False,
    ranks: RanksOption = 1,
    jobs: Annotated[int | None, typer.Option(help="Worker processes; default: the machine's cores.", min=1)] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Run on the workers of this Dask scheduler instead.", metavar="tcp://HOST:PORT")
    ] = None,
    require: Annotated[
        list[str] | None,
        typer.Option(help="Fail if gates of this solver were NOT RUN, or if there are none.", metavar="NAME"),
    ] = None,
    summary: SummaryOption = None,
    baseline: BaselineOption = None,
) -> None:
    """Run studies or scenes, judge them and print one table of verdicts.

    Finished cases are kept: the same command after an interruption goes on from there.

    Example: [bold]dda-validate run core[/bold] or [bold]dda-validate run my-scene.toml --set time.step=0.001[/bold]
    """
    from validation.cli import tables
    from validation.cli.output import heard
    from validation.engine import measured
    from validation.engine.cluster import executor
    from validation.engine.run import run_study
    from validation.runs.results import Results
    from validation.scenes.scene import parse_assignment, scene_names
    from validation.studies.catalogue import STUDIES, resolve

    studies = resolve(targets or ["core"], dict(map(parse_assignment, assignments or [])))
    kept, required = Results(results), require or []
    before = _checked(kept, required, summary, baseline)
    workers, runs = jobs or os.cpu_count() or 1, []
    with executor(scheduler) as pool:
        for study in studies:
            with _progress(study.name) as progress:
                verdicts = run_study(
                    study, kept, full=full, ranks=ranks, jobs=workers, executor=pool, progress=progress
                )
            runs.append(measured.Judged(study, verdicts, tables.outcomes(kept, study.name)))
    names, verdicts = [study.name for study in studies], [verdict for run in runs for verdict in run.verdicts]
    since = tables.after_run([v for name in names for v in kept.verdicts(name)], names, summary, before)
    sentences = [*measured.complaints(runs), *measured.wanting(runs, required)]
    worse = None if since is None else any(change.worse for change in since)
    status = _status(verdicts, required, any(run.refused for run in runs), worse, sentences)
    with heard():
        tables.print_verdicts(verdicts, kept, names)
        tables.print_alarms(kept, names)
        tables.print_failures(kept, names)
        if since is not None:
            tables.print_changes(since)
        for sentence in (*measured.unjudged(runs), *sentences):
            typer.echo(sentence)
        for run in runs:
            if not run.verdicts and run.study.name not in STUDIES:
                tables.print_differences(kept, run.study.name, run.study.name not in scene_names())
    raise typer.Exit(status)


def _checked(kept: Results, required: list[str], summary: Path | None, baseline: Path | None) -> list[Judged] | None:
    """Check before anything runs what would be refused at the end; return the baseline's verdicts."""
    from validation.errors import InputError
    from validation.gates.changes import read_verdicts
    from validation.solvers.registry import is_solver, solver_names

    for name in required:
        if not is_solver(name):
            raise InputError(f"--require: must be among {', '.join(solver_names())}, or module:attribute, got {name!r}")
    if summary is not None and (summary.is_dir() or not summary.parent.is_dir()):
        raise InputError(f"--summary: must be a file in a directory that is there, got {str(summary)!r}")
    kept.check()
    return None if baseline is None else read_verdicts(baseline)


@app.command()
def solve(
    scene: Annotated[str, typer.Argument(help="Built-in scene or scene file.")],
    solver: Annotated[str, typer.Option(help="Solver, see `dda-validate list`.", metavar="NAME")] = "dda",
    csv: Annotated[Path | None, typer.Option(help="Write the history as CSV.", metavar="FILE")] = None,
    fields: Annotated[
        Path | None,
        typer.Option(
            help="Write displacement and stress fields for ParaView (.xdmf: all steps, .vtu: the last one).",
            metavar="FILE",
        ),
    ] = None,
    assignments: SetOption = None,
    full: FullOption = False,
    ranks: RanksOption = 1,
) -> None:
    """Run one scene with one solver; a scene with a sweep needs --set to pick one value.

    Example: [bold]dda-validate solve figures-3-4 --set time.step=0.002 --solver dda --csv history.csv[/bold]
    """
    from validation.errors import InputError
    from validation.runs.files import write_csv
    from validation.runs.run import Outcome
    from validation.solvers.registry import FULL, distributed, get_solver

    chosen = get_solver(solver)
    if ranks > 1 and not chosen.distributed:
        raise InputError(f"--ranks: goes with {', '.join(distributed())}, got {solver!r}")
    chosen = chosen if ranks == 1 else chosen.option(str(ranks))
    case, solver = one_case(scene, assignments), solver if ranks == 1 else f"{solver}:{ranks}"
    if fields is not None and fields.suffix not in (".xdmf", ".vtu"):
        raise InputError(f"--fields: must end in .xdmf or .vtu, got {str(fields)!r}")
    done = _solved(chosen, case, full or solver.endswith(FULL), fields)
    if done.outcome is Outcome.REFUSED:
        raise InputError("; ".join(done.notes))
    if done.outcome is Outcome.NOT_APPLICABLE:
        raise InputError(f"{case.name}: solver {solver} does not apply: {'; '.join(done.notes)}")
    if csv is not None and done.outcome is Outcome.COMPLETED and done.history is not None:
        write_csv(done.history, csv)
    if done.outcome is Outcome.NOT_RUN:
        raise InputError(f"NOT RUN: {'; '.join(done.notes)}")
    for note in done.notes:
        typer.echo(f"note: {note}", err=True)
    if done.outcome is not Outcome.COMPLETED:
        typer.echo(f"{case.name} {solver}: {done.outcome}: {done.outcome.sentence}")
        raise typer.Exit(NUMERICAL_FAILURE)
    _print_run(case, solver, done)


class _Abandoned(Exception):
    """A run that did not complete leaves no fields."""


def _solved(solver: Solver, case: Scene, full: bool, fields: Path | None) -> Run:
    """Run a case; a file of fields takes its name only when the run has completed."""
    from validation.engine.measure import completed
    from validation.errors import InputError
    from validation.runs.files import atomic_path
    from validation.runs.run import Outcome

    if fields is None:
        return completed(solver, case, full)
    with suppress(_Abandoned), atomic_path(fields) as part:
        done = completed(solver, case, full, part)
        if done.outcome is not Outcome.COMPLETED:
            raise _Abandoned
        if part.stat().st_size == 0:
            raise InputError(f"--fields: {solver.name} has written none, got {str(fields)!r}")
    return done


def _print_run(case: Scene, solver: str, done: Run) -> None:
    work = ", ".join(f"{count} {name}" for name, count in done.work.items())
    last = {name: float(values[-1]) for name, values in done.history.columns.items()} if done.history else {}
    ends = ", ".join(f"{name} {value:.6g}" for name, value in last.items())
    typer.echo(f"{case.name} {solver}: {case.time.steps} steps to t = {case.time.duration:g} s; last: {ends}; {work}")


def _status(
    verdicts: list[Verdict], required: list[str], refused: bool, worse: bool | None, sentences: Sequence[str] = ()
) -> int:
    """Status of a run; `worse` says whether a gate did better in the baseline, None without one.

    `sentences` say what was not measured, which fails a run with a baseline as well: a baseline knows gates only.
    """
    if refused:
        return BAD_INPUT
    missing = [v for v in verdicts if v.status == "NOT RUN" and set(required) & set(v.gate.pair)]
    failed = any(v.status == "FAIL" for v in verdicts) if worse is None else worse
    return GATE_FAILED if missing or failed or sentences else PASSED
