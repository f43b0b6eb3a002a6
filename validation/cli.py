"""The command line ``dda-validate``; heavy modules are imported by the command that needs them."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli_options import BaselineOption, RanksOption, SummaryOption

if TYPE_CHECKING:
    from validation.gates import Verdict
    from validation.scene import Scene

PASSED, GATE_FAILED, BAD_INPUT, NUMERICAL_FAILURE, INTERRUPTED = 0, 1, 2, 3, 130
SLOW = 2.0  # seconds after which progress is shown

app: typer.Typer = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    help="Cross-validation of Discontinuous Deformation Analysis (DDA) against finite elements and exact solutions "
    "on the two-block model.\n\nExample: [bold]dda-validate run core && dda-validate report[/bold]",
)

ResultsOption = Annotated[Path, typer.Option("--results", help="Results directory.", metavar="DIR")]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Set a value of the scene, as in --set time.step=0.001; may be repeated.",
        metavar="KEY=VALUE",
    ),
]
FullOption = Annotated[
    bool,
    typer.Option(
        "--full",
        help="Switch the numerical savings off: no dropped unknowns, no single column, no half block, no small space, "
        "no blocked steps.",
    ),
]
RESULTS: Path = Path("reports/results")


@app.command("list")
def list_command() -> None:
    """List studies, built-in scenes, solvers and metrics.

    Example: [bold]dda-validate list[/bold]
    """
    from validation.metrics import METRICS
    from validation.scene import load_scene, scene_names
    from validation.solvers import solver_names
    from validation.studies import STUDIES, get_study

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
    from validation import cli_tables as tables
    from validation.cluster import executor
    from validation.engine import run_study
    from validation.results import Results
    from validation.scene import parse_assignment
    from validation.studies import resolve

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
    worse = cli_verdicts.after_run([v for name in names for v in kept.verdicts(name)], summary, baseline)
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
    from validation.cases import attempt, check
    from validation.history import Outcome, atomic_path, write_csv
    from validation.scene import SceneError
    from validation.solvers import DISTRIBUTED, get_solver

    if ranks > 1 and solver not in DISTRIBUTED:
        raise SceneError(f"--ranks: goes with {', '.join(DISTRIBUTED)}, got {solver!r}")
    solver = solver if ranks == 1 else f"{solver}:{ranks}"
    case, chosen = one_case(scene, assignments), get_solver(solver.removesuffix(":full"))
    if fields is not None and fields.suffix not in (".xdmf", ".vtu"):
        raise SceneError(f"--fields: must end in .xdmf or .vtu, got {str(fields)!r}")
    with atomic_path(fields) if fields is not None else nullcontext() as part:
        done = check(attempt(chosen, case, full or solver.endswith(":full"), part), case)
        if done.outcome in (Outcome.REFUSED, Outcome.NOT_APPLICABLE):
            raise SceneError("; ".join(done.notes))
    if csv is not None and done.outcome is Outcome.COMPLETED and done.history is not None:
        write_csv(done.history, csv)
    if done.outcome is Outcome.NOT_RUN:
        raise SceneError(f"NOT RUN: {'; '.join(done.notes)}")
    for note in done.notes:
        typer.echo(f"note: {note}", err=True)
    if done.outcome is not Outcome.COMPLETED:
        typer.echo(f"{case.name} {solver}: {done.outcome}: {done.outcome.sentence}")
        raise typer.Exit(NUMERICAL_FAILURE)
    _print_run(case, solver, done)


@app.command()
def report(
    out: Annotated[Path, typer.Option(help="The PDF.", metavar="FILE.pdf")] = Path("reports/report.pdf"),
    results: ResultsOption = RESULTS,
) -> None:
    """Write the PDF report: a chapter for each study in the results directory; nothing is computed.

    Example: [bold]dda-validate report --out report.pdf[/bold]
    """
    from validation.report import build
    from validation.results import Results

    typer.echo(f"wrote {build(Results(results), out)}")


@app.command()
def figures(
    study: Annotated[str, typer.Argument(help="A study or scene whose results are there.")],
    out: Annotated[Path, typer.Option(help="Directory for the SVG and PNG files.", metavar="DIR")] = Path("figures"),
    results: ResultsOption = RESULTS,
) -> None:
    """Write a study's figures as SVG and PNG.

    Example: [bold]dda-validate figures core --out figures[/bold]
    """
    from validation.report import figures as write_figures
    from validation.results import Results

    for path in write_figures(study, Results(results), out):
        typer.echo(f"wrote {path}")


def one_case(source: str, assignments: list[str] | None) -> Scene:
    """Return the single case of a scene, with values set; say which are to be picked where a sweep is left."""
    from validation.scene import SceneError, load_scene, parse_assignment
    from validation.studies import check_words

    scene = load_scene(source).with_values(dict(map(parse_assignment, assignments or [])))
    check_words(scene, source)
    if scene.sweep:
        fields = ", ".join(field for field in scene.sweep if field != "mode")
        raise SceneError(f"{source}: sweep: one value must be picked for {fields}; use --set KEY=VALUE")
    return scene


def _print_run(case: Scene, solver: str, done: object) -> None:
    from validation.history import Run

    if not isinstance(done, Run):
        return
    work = ", ".join(f"{count} {name}" for name, count in done.work.items())
    last = {name: float(values[-1]) for name, values in done.history.columns.items()} if done.history else {}
    ends = ", ".join(f"{name} {value:.6g}" for name, value in last.items())
    typer.echo(f"{case.name} {solver}: {case.time.steps} steps to t = {case.time.duration:g} s; last: {ends}; {work}")


@contextmanager
def _progress(title: str) -> Iterator[Callable[[int, int, str], None]]:
    """Yield a callback that shows a progress bar once the work has taken two seconds."""
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    start = time.monotonic()
    bar = Progress(
        TextColumn("{task.description}"),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[label]}"),
        console=Console(stderr=True),
        transient=True,
    )
    task = bar.add_task(title, label="")

    def show(done: int, total: int, label: str) -> None:
        if time.monotonic() - start > SLOW and not bar.live.is_started:
            bar.start()
        bar.update(task, completed=done, total=total, label=label)

    try:
        yield show
    finally:
        if bar.live.is_started:
            bar.stop()


def _status(verdicts: list[Verdict], required: list[str], refused: bool, worse: bool | None) -> int:
    """Status of a run; `worse` says whether a gate did better in the baseline, None without one."""
    if refused:
        return BAD_INPUT
    missing = [v for v in verdicts if v.status == "NOT RUN" and set(required) & set(v.gate.pair)]
    failed = any(v.status == "FAIL" for v in verdicts) if worse is None else worse
    return GATE_FAILED if missing or failed else PASSED


USAGE_ERROR: type[Exception] = typer.BadParameter.__mro__[1]  # typer exports no name for the base of its usage errors


def main() -> None:
    """Run the command line; bad input is one line and status 2, an interruption status 130."""
    from validation.errors import SceneError

    try:
        status = app(standalone_mode=False)
    except SceneError as error:
        _stop(f"error: {error}", BAD_INPUT)
    except USAGE_ERROR as error:
        text = " ".join(error.format_message().split())  # type: ignore[attr-defined]
        _stop(f"error: {text} (see dda-validate --help)", BAD_INPUT)
    except (KeyboardInterrupt, typer.Abort):
        status = INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = PASSED
    if status == INTERRUPTED:  # which typer may have made of the interruption itself
        typer.echo("interrupted: finished rows are kept, the same command goes on from there", err=True)
        sys.stdout.flush()
        os._exit(INTERRUPTED)  # not through the pool's own exit, which may wait for a worker that is gone
    sys.exit(status or PASSED)


def _stop(line: str, status: int) -> None:
    typer.echo(line, err=True)
    sys.exit(status)


from validation import cli_compare, cli_damping, cli_verdicts, cli_work  # noqa: E402, F401  (add their commands to app)

if __name__ == "__main__":
    main()
