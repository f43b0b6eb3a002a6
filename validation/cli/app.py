"""The command line ``dda-validate``: the application, its options and exit statuses."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from validation.runs.progress import Progress as ProgressReport

if TYPE_CHECKING:
    from validation.runs.row import Row
    from validation.runs.run import Run
    from validation.scenes.scene import Scene

PASSED = 0
GATE_FAILED = 1
BAD_INPUT = 2
NUMERICAL_FAILURE = 3
INTERRUPTED = 130
PROGRESS_DELAY = 2.0  # s of work before progress is shown
app: typer.Typer = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    help="Cross-validation of Discontinuous Deformation Analysis (DDA) against finite elements and exact solutions "
    "on the two-block model.\n\nExample: [bold]dda-validate run core && dda-validate report[/bold]",
)


class AdviceGroup(TyperGroup):
    """The parts of ``advise``; where none is named, all that they say is summed up of the scene that is."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the part that sums up before the words of a scene; of two words the first is meant for a part."""
        names_part = len(args) > 1 and not any(word.startswith("-") for word in args[:2])
        if args and args[0] not in (*self.commands, "--help") and not names_part:
            args = ["everything", *args]
        return super().parse_args(ctx, args)


parts: typer.Typer = typer.Typer(
    cls=AdviceGroup,
    rich_markup_mode="rich",
    help="Say what step, springs and discount of a scene really do, and which to take.\n\n"
    "Example: [bold]dda-validate advise figures-3-4 --set time.step=0.002[/bold]\n\n"
    "advise SCENE sums up and is the part everything; --goal, --error, --frequency and --json are options of it. "
    "advise PART SCENE shows one part in full.",
)
app.add_typer(parts, name="advise")


def _print_version(requested: bool) -> None:
    if requested:
        from importlib.metadata import version

        typer.echo(f"dda-validate {version('dda-validation')}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """Take the options that stand before a command."""


def writable(path: Path | None) -> Path | None:
    """Refuse a file that could not be written in the end, before anything is computed."""
    if path is not None:
        from validation.runs.files import check_output

        check_output(path)
    return path


def writable_pdf(path: Path | None) -> Path | None:
    """Refuse a file that is no PDF by its name, could not be written, or needs an extra that is not installed."""
    if path is not None and path.suffix.lower() != ".pdf":
        from validation.errors import InputError

        raise InputError("must end in .pdf", source=path)
    if path is not None:
        from validation.runs import extras

        extras.require("--out", *extras.PDF)
    return writable(path)


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
        help="Run the full model: without the shortcuts that leave out unknowns that do not move, take one column of "
        "elements or half the block, or take many steps at once.",
    ),
]
RanksOption = Annotated[
    int, typer.Option("--ranks", help="MPI ranks of the solvers that can be distributed (fenicsx).", min=1, metavar="N")
]
ColumnsOption = Annotated[
    str | None, typer.Option(help="Column names or numbers in a table.", metavar="time=T,displacement=UY")
]
ScaleOption = Annotated[
    str | None,
    typer.Option(help="Factors that convert its values to SI, upwards positive.", metavar="displacement=-1e-3"),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print plain data instead of text.")]
SummaryOption = Annotated[
    Path | None,
    typer.Option(
        "--summary",
        help="Write the verdicts as Markdown, for the summary page of a CI job.",
        metavar="FILE",
        callback=writable,
    ),
]
BaselineOption = Annotated[
    Path | None,
    typer.Option(
        "--baseline",
        help="Verdicts of an earlier run (verdicts.json or a results directory): fail only on what got worse.",
        metavar="FILE",
    ),
]
RESULTS: Path = Path("reports/results")


def known_scenes(incomplete: str) -> list[str]:
    """Return the built-in scenes that a shell may complete a word to."""
    from validation.scenes.scene import scene_names

    return [name for name in scene_names() if name.startswith(incomplete)]


def known_targets(incomplete: str) -> list[str]:
    """Return the studies and built-in scenes that a shell may complete a word to."""
    from validation.suite.folders import study_names

    return [name for name in (*study_names(), "all") if name.startswith(incomplete)] + known_scenes(incomplete)


SceneArgument = Annotated[str, typer.Argument(help="Built-in scene or scene file.", autocompletion=known_scenes)]


def one_case(source: str, assignments: list[str] | None) -> Scene:
    """Return the single case of a scene, with values set; say which are to be picked where a sweep is left."""
    from validation.scenes import features

    scene = stated_scene(source, assignments)
    features.refuse_sweep(scene, source)
    print_warnings(scene)
    return scene


def stated_scene(source: str, assignments: list[str] | None) -> Scene:
    """Return a scene with values set, all its names known."""
    from validation.scenes.scene import load_scene, parse_assignment
    from validation.solvers.names import check_names

    scene = load_scene(source).with_values(dict(map(parse_assignment, assignments or [])))
    check_names(scene, source)
    return scene


def print_warnings(scene: Scene) -> None:
    """Print a line on standard error for each value of a scene that was probably not meant."""
    from validation.runs.text import visible
    from validation.scenes.plausibility import plausibility_warnings

    for sentence in plausibility_warnings(scene):
        typer.echo(visible(f"warning: {scene.name}: {sentence}"), err=True)


def refuse_bad_input(scene: str, solver: str, ended: Run | Row) -> None:
    """Raise InputError, with its reason, for what a solver refused or does not apply to; other ends are left alone."""
    from validation.errors import InputError
    from validation.runs.run import Outcome

    why = "; ".join(ended.notes)
    if ended.outcome is Outcome.REFUSED:
        raise InputError(why)
    if ended.outcome is Outcome.NOT_APPLICABLE:
        raise InputError(f"solver {solver} does not apply: {why}", source=scene)


@contextmanager
def _progress(title: str, visible: bool = True) -> Iterator[ProgressReport]:
    """Yield a callback that says how far the work is, in a bar that is shown once it has taken two seconds.

    The bar does not wait for a call: one piece of the work may take minutes.
    """
    import threading

    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.table import Column

    console = Console(stderr=True)
    bar = Progress(
        TextColumn("{task.description}"),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.fields[label]}", table_column=Column(no_wrap=True, overflow="ellipsis", ratio=1)),
        console=console,
        transient=True,
        disable=not console.is_terminal,  # of which a file would get an empty line
        expand=True,
    )
    task = bar.add_task(title, total=1, label="")

    def show(completed: int, total: int, label: str) -> None:
        bar.update(task, completed=completed, total=total, label=label)

    timer = threading.Timer(PROGRESS_DELAY, bar.start)
    timer.daemon = True
    if visible:
        timer.start()
    try:
        yield show
    finally:
        timer.cancel()
        if timer.is_alive():  # it may be starting the bar just now
            timer.join()
        if bar.live.is_started:
            bar.stop()
