"""Commands that run: ``list``, ``run`` and ``solve``."""

from __future__ import annotations

import os
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli.options import BaselineOption, RanksOption, SummaryOption

if TYPE_CHECKING:
    from validation.gates.gate import Verdict
    from validation.scenes.scene import Scene
from validation.cli.app import (
    BAD_INPUT,
    GATE_FAILED,
    NUMERICAL_FAILURE,
    PASSED,
    RESULTS,
    FullOption,
    ResultsOption,
    SetOption,
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
        list[str] | None, typer.Option(help="Fail if gates of this solver were NOT RUN.", metavar="NAME")
    ] = None,
    summary: SummaryOption = None,
    baseline: BaselineOption = None,
) -> None:
    """Run studies or scenes, judge them and print one table of verdicts.

    Finished cases are kept: the same command after an interruption goes on from there.

    Example: [bold]dda-validate run core[/bold] or [bold]dda-validate run my-scene.toml --set time.step=0.001[/bold]
    """
    from validation.cli import tables
    from validation.engine.cluster import executor
    from validation.engine.run import run_study
    from validation.runs.results import Results
    from validation.scenes.scene import parse_assignment
    from validation.studies.catalogue import resolve

    studies = resolve(targets or ["core"], dict(map(parse_assignment, assignments or [])))
    kept, verdicts = Results(results), []
    workers = jobs or os.cpu_count() or 1
    with executor(scheduler) as pool:
        for study in studies:
            with _progress(study.name) as progress:
                verdicts += run_study(
                    study, kept, full=full, ranks=ranks, jobs=workers, executor=pool, progress=progress
                )
    names = [study.name for study in studies]
    tables.print_verdicts(verdicts, kept, names)
    tables.print_alarms(kept, names)
    refused = tables.print_failures(kept, names)
    worse = tables.after_run([v for name in names for v in kept.verdicts(name)], summary, baseline)
    raise typer.Exit(_status(verdicts, require or [], refused, worse))


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
    from validation.engine.measure import completed
    from validation.errors import InputError
    from validation.runs.files import atomic_path, write_csv
    from validation.runs.run import Outcome
    from validation.solvers.registry import FULL, distributed, get_solver

    chosen = get_solver(solver)
    if ranks > 1 and not chosen.distributed:
        raise InputError(f"--ranks: goes with {', '.join(distributed())}, got {solver!r}")
    chosen = chosen if ranks == 1 else chosen.option(str(ranks))
    case, solver = one_case(scene, assignments), solver if ranks == 1 else f"{solver}:{ranks}"
    if fields is not None and fields.suffix not in (".xdmf", ".vtu"):
        raise InputError(f"--fields: must end in .xdmf or .vtu, got {str(fields)!r}")
    with atomic_path(fields) if fields is not None else nullcontext() as part:
        done = completed(chosen, case, full or solver.endswith(FULL), part)
        if done.outcome in (Outcome.REFUSED, Outcome.NOT_APPLICABLE):
            raise InputError("; ".join(done.notes))
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


def _print_run(case: Scene, solver: str, done: object) -> None:
    from validation.runs.run import Run

    if not isinstance(done, Run):
        return
    work = ", ".join(f"{count} {name}" for name, count in done.work.items())
    last = {name: float(values[-1]) for name, values in done.history.columns.items()} if done.history else {}
    ends = ", ".join(f"{name} {value:.6g}" for name, value in last.items())
    typer.echo(f"{case.name} {solver}: {case.time.steps} steps to t = {case.time.duration:g} s; last: {ends}; {work}")


def _status(verdicts: list[Verdict], required: list[str], refused: bool, worse: bool | None) -> int:
    """Status of a run; `worse` says whether a gate did better in the baseline, None without one."""
    if refused:
        return BAD_INPUT
    missing = [v for v in verdicts if v.status == "NOT RUN" and set(required) & set(v.gate.pair)]
    failed = any(v.status == "FAIL" for v in verdicts) if worse is None else worse
    return GATE_FAILED if missing or failed else PASSED
