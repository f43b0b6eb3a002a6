"""Commands that run: ``list``, ``run`` and ``solve``."""

from __future__ import annotations

import itertools
import os
import time
from contextlib import closing, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from validation.runs.progress import Progress

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from validation.cli.printing.answer import RunAnswer
    from validation.engine.measured import JudgedStudy
    from validation.engine.run import StudyCases
    from validation.gates.gate import Verdict
    from validation.runs.records import BaselineVerdict
    from validation.runs.results import Results
    from validation.runs.run import Run
    from validation.scenes.scene import Scene
    from validation.solvers.contract import Prepared, Solver
    from validation.suite.declaration import Study
from validation.cli.app import (
    BAD_INPUT,
    GATE_FAILED,
    NUMERICAL_FAILURE,
    PASSED,
    RESULTS,
    BaselineOption,
    FullOption,
    JsonOption,
    RanksOption,
    ResultsOption,
    SceneArgument,
    SetOption,
    SummaryOption,
    _progress,
    app,
    known_scenes,
    known_targets,
    one_case,
    print_warnings,
    refuse_bad_input,
    writable,
)
from validation.cli.printing.output import echo, echo_json
from validation.cli.signals import promise_rows

RequireOption = Annotated[
    list[str] | None,
    typer.Option("--require", help="Fail if gates of this solver were NOT RUN, or if there are none.", metavar="NAME"),
]
VerboseOption = Annotated[bool, typer.Option("--verbose", help="Print every gate and how every run ended.")]
QuietOption = Annotated[bool, typer.Option("--quiet", help="Print nothing: the exit status is the answer.")]
GATES_LISTED = 12  # of a scene, one by one without --verbose


def default_jobs() -> int:
    """Return how many cases run at once unless it is said: one a processor."""
    return os.cpu_count() or 1


@app.command("list")
def list_command(
    what: Annotated[
        str | None,
        typer.Argument(help="keys, metrics, schemes, scenes, solvers or studies: that list in full.", metavar="LIST"),
    ] = None,
) -> None:
    """List what there is: studies, scenes, solvers, schemes, metrics, keys of a scene; or one of these in full.

    Example: [bold]dda-validate list[/bold] or [bold]dda-validate list metrics[/bold]
    """
    from validation.advice.limits import check_choice
    from validation.cli.printing.listing import LISTS, short
    from validation.cli.printing.output import broken, columns

    if what is not None:
        check_choice("list", what, sorted(LISTS))
        echo(columns(LISTS[what]()))
        return
    echo(columns(short()))
    echo()
    echo(broken("dda-validate list NAME shows one of them in full, dda-validate show SCENE a scene and its numbers"))


@app.command()
def run(
    targets: Annotated[
        list[str] | None,
        typer.Argument(
            help="Studies, built-in scenes or scene files (default: core; all: every study).",
            metavar="[STUDY|SCENE|FILE]...",
            autocompletion=known_targets,
        ),
    ] = None,
    results: ResultsOption = RESULTS,
    scene: Annotated[
        str | None,
        typer.Option(
            help="Run the study for this scene in place of its own ones: cost.",
            metavar="SCENE",
            autocompletion=known_scenes,
        ),
    ] = None,
    assignments: SetOption = None,
    full: FullOption = False,
    ranks: RanksOption = 1,
    jobs: Annotated[int | None, typer.Option(help="Worker processes; default: the machine's cores.", min=1)] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Run on the workers of this Dask scheduler instead.", metavar="tcp://HOST:PORT")
    ] = None,
    require: RequireOption = None,
    summary: SummaryOption = None,
    baseline: BaselineOption = None,
    verbose: VerboseOption = False,
    as_json: JsonOption = False,
    quiet: QuietOption = False,
) -> None:
    """Run studies or scenes, judge them, and print a line for each study and every gate that fails.

    Finished cases are kept: the same command after an interruption continues from there.

    Example: [bold]dda-validate run core[/bold] or [bold]dda-validate run my-scene.toml --set time.step=0.001[/bold]
    or [bold]dda-validate run cost --scene my-scene.toml[/bold]
    """
    from validation.errors import InputError
    from validation.runs.results import Results
    from validation.scenes.scene import parse_assignment
    from validation.suite.folders import resolve, study_names, study_of_scene

    judging = Judging(require or [], summary, baseline, verbose, as_json, quiet)
    before = judging.check()
    promise_rows()
    values = dict(map(parse_assignment, assignments or []))
    names = targets or ["core"]
    if scene is not None and len(names) != 1:
        raise InputError("goes with one study", field="--scene", value=" ".join(names))
    studies = resolve(names, values) if scene is None else [study_of_scene(names[0], scene, values)]
    store = Results(results)
    store.check()
    machine = Machine(full, ranks, jobs or default_jobs(), scheduler)
    for study in studies:
        if study.name not in study_names():  # the suite's own studies are extreme on purpose
            for declared in study.scenes[:1]:  # a user's scene, or the first of those that are made of it
                if not isinstance(declared, str):
                    print_warnings(declared)
    runs, seconds = _run_studies(studies, store, machine, judging)
    answer_and_exit(runs, seconds, store, judging, before)


@dataclass(frozen=True)
class Judging:
    """What a run must satisfy beside its gates, and how its answer is printed."""

    required: list[str]
    summary: Path | None
    baseline: Path | None
    verbose: bool
    as_json: bool
    quiet: bool

    def check(self) -> list[BaselineVerdict] | None:
        """Refuse before anything runs what would be refused at the end; return the baseline, None without one."""
        from validation.errors import InputError
        from validation.gates.changes import read_verdicts
        from validation.solvers.registry import is_solver, solver_names

        output_options = {"--verbose": self.verbose, "--json": self.as_json, "--quiet": self.quiet}
        exclusive = [option for option, is_set in output_options.items() if is_set]
        if len(exclusive) > 1:
            raise InputError(f"{exclusive[0]}, {exclusive[1]}: exclude each other", value="both")
        for name in self.required:
            if not is_solver(name):
                raise InputError(
                    f"must be among {', '.join(solver_names())}, or module:attribute",
                    field="--require",
                    value=repr(name),
                )
        return None if self.baseline is None else read_verdicts(self.baseline)


def answer_and_exit(
    runs: list[JudgedStudy],
    seconds: list[float],
    results: Results,
    judging: Judging,
    before: list[BaselineVerdict] | None,
) -> NoReturn:
    """Print what studies have shown, and exit with the status of a run; `before` are the baseline's verdicts."""
    from validation.cli.printing.answer import RunAnswer, as_data
    from validation.cli.printing.output import tolerate_closed_pipe
    from validation.cli.printing.tables import after_run
    from validation.engine.measured import complaints, missing_gates
    from validation.suite.folders import study_names

    names = [judged.study.name for judged in runs]
    records = list(itertools.chain.from_iterable(map(results.verdicts, names)))
    changes = after_run(records, names, judging.summary, before)
    worse = None if changes is None else any(change.worse for change in changes)
    messages = [*complaints(runs), *missing_gates(runs, judging.required)]
    verdicts = list(itertools.chain.from_iterable(judged.verdicts for judged in runs))
    status = _status(verdicts, judging.required, any(judged.refused for judged in runs), worse, messages)
    answer = RunAnswer(runs, seconds, results, messages, changes, frozenset(names) - set(study_names()), status)
    with tolerate_closed_pipe():
        if judging.as_json:
            echo_json(as_data(answer))
        elif not judging.quiet:
            _print_answer(answer, judging.verbose)
    raise typer.Exit(status)


@dataclass(frozen=True)
class Machine:
    """How cases are run: without savings, on so many ranks, processes, or on a cluster."""

    full: bool
    ranks: int
    jobs: int
    scheduler: str | None


@contextmanager
def _running(
    groups: Sequence[StudyCases], results: Results, machine: Machine, judging: Judging
) -> Iterator[Iterator[StudyCases]]:
    """Yield the cases of each study as they have ended, run on one pool with one progress bar."""
    from validation.engine.cluster import executor
    from validation.engine.run import run_cases
    from validation.solvers.logs import errors_only

    title = groups[0].study.name if len(groups) == 1 else f"{len(groups)} studies"
    solvers = {case.solver for group in groups for case in group.cases}
    with (
        errors_only() if judging.quiet else nullcontext(),
        executor(machine.scheduler, sorted(solvers)) as pool,
        _progress(title, not judging.quiet) as progress,
        closing(run_cases(groups, results, jobs=machine.jobs, executor=pool, progress=progress)) as ended,
    ):
        yield ended


def _run_studies(
    studies: Sequence[Study], results: Results, machine: Machine, judging: Judging
) -> tuple[list[JudgedStudy], list[float]]:
    """Run the studies; return them judged, and the seconds from the end of one that ended before to its own end."""
    from validation.engine.run import judge_study, study_cases

    last = time.monotonic()
    groups = [study_cases(study, machine.full, machine.ranks) for study in studies]
    runs = {}
    seconds = {}
    with _running(groups, results, machine, judging) as ended:
        for group in ended:
            runs[group.study.name] = judge_study(group, results)
            now = time.monotonic()
            seconds[group.study.name] = now - last
            last = now
    return [runs[study.name] for study in studies], [seconds[study.name] for study in studies]


def _print_answer(answer: RunAnswer, verbose: bool) -> None:
    """Print every gate where there are few or all are asked for, then the answer, then what to do with a scene."""
    from validation.cli.printing import tables
    from validation.cli.printing.answer import lines
    from validation.cli.printing.output import print_blocks, print_lines, width
    from validation.scenes.scene import scene_names
    from validation.suite.folders import folder_of

    if answer.verdicts and (verbose or (answer.user_scenes and len(answer.verdicts) <= GATES_LISTED)):
        print_blocks([tables.verdict_table(answer.verdicts, answer.results, answer.names)])
        echo()
    if verbose:
        tables.print_ends(answer.results, answer.names)
    print_lines(lines(answer, width()))
    if answer.changes is not None:
        print_blocks(tables.change_blocks(answer.changes))
    for judged in answer.runs:
        name = judged.study.name
        folder = folder_of(name)
        if name in answer.user_scenes and folder is not None:
            print_blocks(folder.module("answer").answer(answer.results.manifest(name)))
        elif name in answer.user_scenes and not judged.verdicts:
            print_blocks(tables.difference_blocks(answer.results, name, name not in scene_names()))


@app.command()
def solve(
    scene: SceneArgument,
    solver: Annotated[str, typer.Option(help="Solver, see `dda-validate list`.", metavar="NAME")] = "dda",
    csv: Annotated[
        Path | None, typer.Option(help="Write the history as CSV.", metavar="FILE", callback=writable)
    ] = None,
    fields: Annotated[
        Path | None,
        typer.Option(
            help="Write displacement and stress fields for ParaView (.xdmf: all steps, .vtu: the last one).",
            metavar="FILE",
            callback=writable,
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
    from validation.runs import extras
    from validation.runs.files import write_csv
    from validation.runs.run import Outcome
    from validation.solvers.registry import FULL, distributed, get_solver

    adapter = get_solver(solver)
    adapter.check_module()
    if ranks > 1:
        if not adapter.distributed:
            raise InputError(f"goes with {', '.join(distributed())}", field="--ranks", value=repr(solver))
        adapter = adapter.option(str(ranks))
        solver = f"{solver}:{ranks}"
    case = one_case(scene, assignments)
    if fields is not None and fields.suffix not in (".xdmf", ".vtu"):
        raise InputError("must end in .xdmf or .vtu", field="--fields", value=repr(str(fields)))
    if fields is not None:
        extras.require("--fields", *extras.MESH)
    is_full = full or solver.endswith(FULL)
    with _progress(f"solve {solver}") as show:
        show(0, 1, "")
        ended = _run_case(adapter, case, is_full, fields, partial(_watch, show))
    refuse_bad_input(case.name, solver, ended)
    if csv is not None and ended.outcome is Outcome.COMPLETED and ended.history is not None:
        write_csv(ended.history, csv)
    if ended.outcome is Outcome.NOT_RUN:
        raise InputError(f"NOT RUN: {'; '.join(ended.notes)}")
    for note in ended.notes:
        echo(f"note: {note}", err=True)
    if ended.outcome is not Outcome.COMPLETED:
        echo(f"{case.name} {solver}: {ended.outcome}: {ended.outcome.sentence}")
        raise typer.Exit(NUMERICAL_FAILURE)
    work = ", ".join(f"{count} {name}" for name, count in ended.work.items())
    last = {name: float(values[-1]) for name, values in ended.history.columns.items()} if ended.history else {}
    ends = ", ".join(f"{name} {value:.6g}" for name, value in last.items())
    echo(f"{case.name} {solver}: {case.time.steps} steps to t = {case.time.duration:g} s; last: {ends}; {work}")


class _Abandoned(Exception):
    """A run that did not complete leaves no fields."""


def _watch(show: Progress, prepared: Prepared) -> None:
    """Show how far a run is, where its solver says so."""
    prepared.progress = lambda share: show(round(100 * share), 100, "% of the time that is simulated")


def _run_case(solver: Solver, case: Scene, full: bool, fields: Path | None, watch: Callable[[Prepared], None]) -> Run:
    """Run a case; a file of fields takes its name only when the run has completed."""
    from validation.engine.measure import completed
    from validation.errors import InputError
    from validation.runs.files import atomic_path
    from validation.runs.run import Outcome

    if fields is None:
        return completed(solver, case, full, watch=watch)
    with suppress(_Abandoned), atomic_path(fields) as part:
        run = completed(solver, case, full, part, watch)
        if run.outcome is not Outcome.COMPLETED:
            raise _Abandoned
        if part.stat().st_size == 0:
            raise InputError(f"{solver.name} has written none", field="--fields", value=repr(str(fields)))
    return run


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
