"""The commands of frequencies: ``response``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli.app import SetOption, app, one_case

if TYPE_CHECKING:
    from validation.advice.response import Response
    from validation.runs.history import Array
    from validation.scenes.scene import Scene

SceneArgument = Annotated[str, typer.Argument(help="Built-in scene or scene file.")]
FigureOption = Annotated[
    Path | None, typer.Option("--figure", help="Draw into a file .svg, .pdf or .png.", metavar="FILE")
]
FigureEndings = (".svg", ".pdf", ".png")
PEAKS = 3  # that are printed


@app.command()
def response(
    scene: SceneArgument,
    solver: Annotated[str, typer.Option("--solver", help="Solver whose model answers.", metavar="NAME")] = "dda",
    low: Annotated[float, typer.Option("--from", help="Lowest frequency.", metavar="HZ")] = 0.1,
    high: Annotated[float, typer.Option("--to", help="Highest frequency.", metavar="HZ")] = 200.0,
    points: Annotated[int, typer.Option("--points", help="Number of frequencies.", min=1)] = 1000,
    logarithmic: Annotated[bool, typer.Option("--log", help="Space frequencies by their logarithm.")] = False,
    exact: Annotated[bool, typer.Option("--exact", help="Write the model's answer that is exact in time.")] = False,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table.", metavar="FILE")] = None,
    figure: FigureOption = None,
    assignments: SetOption = None,
) -> None:
    """Give the answer to a load or a base that vibrates, over frequency; no step is run.

    Example: [bold]dda-validate response figures-3-4 --set time.step=0.002 --from 1 --figure response.svg[/bold]
    """
    from validation.advice.response import response as answer

    case = one_case(scene, assignments)
    frequencies = _frequencies(low, high, points, logarithmic)
    check_figure(figure)
    answers = {solver: answer(case, frequencies, solver), EXACT: answer(case, frequencies, solver, exact=True)}
    if csv is not None:
        _write(answers[EXACT if exact else solver], csv)
    if figure is not None:
        _draw(case, answers, logarithmic, figure)
    _print_peaks(case, answers)


EXACT = "exact in time"


def _frequencies(low: float, high: float, points: int, logarithmic: bool) -> Array:
    """Return the frequencies of a sweep [Hz], or refuse its ends."""
    import math

    import numpy as np

    from validation.errors import InputError

    if not (math.isfinite(low) and math.isfinite(high) and 0 <= low <= high):
        raise InputError(f"--from, --to: must be finite, not negative and in this order, got {low:g} and {high:g}")
    if logarithmic and low == 0:
        raise InputError("--from: must be greater than 0 with --log, got 0")
    spaced = np.geomspace if logarithmic else np.linspace
    return np.asarray(spaced(low, high, points), dtype=np.float64)


def check_figure(path: Path | None) -> None:
    """Refuse a figure's file of an unknown kind before anything is computed."""
    from validation.errors import InputError

    if path is not None and path.suffix.lower() not in FigureEndings:
        raise InputError(f"--figure: must end in {', '.join(FigureEndings)}, got {path.name!r}")


def _write(found: Response, path: Path) -> None:
    """Write the table with all digits."""
    from validation.advice.response import HEADER
    from validation.runs.files import write_atomically

    lines = [",".join(HEADER), *(",".join(map(repr, row)) for row in found.table().tolist())]
    write_atomically(path, lambda stream: stream.write(("\n".join(lines) + "\n").encode()))
    typer.echo(f"wrote {path}: {len(lines) - 1} frequencies")


def _draw(case: Scene, answers: dict[str, Response], logarithmic: bool, path: Path) -> None:
    """Draw the solver as stepped and exact in time, and the continuum where it applies."""
    import numpy as np

    from validation.advice.response import polar
    from validation.advice.response import response as answer
    from validation.report.figures.response import ResponseCurve, response_figure, save_as
    from validation.solvers.registry import get_solver

    shown = dict(answers)
    if get_solver("continuum").refusal(case) is None:
        shown["continuum"] = answer(case, answers[EXACT].frequency, "continuum")
    curves = []
    for name, found in shown.items():
        seen = (found.frequency <= 0.5 / case.time.step) | found.exact | (name == "continuum")
        columns = {c: tuple(np.where(seen, part, np.nan) for part in polar(v)) for c, v in found.columns.items()}
        label = {EXACT: f"{found.solver}, exact in time", "continuum": "continuum"}.get(name, f"{name} as stepped")
        curves.append(ResponseCurve(label, found.solver, name == EXACT, found.frequency, columns))  # type: ignore[arg-type]
    typer.echo(f"wrote {save_as(response_figure(curves, logarithmic, answers[EXACT].base), path)}")


def _print_peaks(case: Scene, answers: dict[str, Response]) -> None:
    """Say where the answers peak, and where the steps see an alias."""
    from validation.cli.damping import print_table
    from validation.runs.history import DISPLACEMENT, PRESSURE

    found = answers[EXACT]
    load = "per metre of base motion" if found.base else "under the scene's loads"
    typer.echo(f"{case.name}, {found.solver}: {len(found.frequency)} frequencies, {load}; no step is run")
    unit = "/m" if found.base else ""
    heads = "", "peak [Hz]", f"displacement [m{unit}]", "peak [Hz]", f"contact pressure [Pa{unit}]"
    rows: list[tuple[str, ...]] = [heads]
    for name, answer in answers.items():
        label = name if name == EXACT else "as stepped"
        columns = [answer.peaks(column)[:PEAKS] for column in (DISPLACEMENT, PRESSURE)]
        for i in range(max(map(len, columns), default=0)):
            cells = [(f"{p[i][0]:.6g}", f"{p[i][1]:.6g}") if i < len(p) else ("", "") for p in columns]
            rows.append((label, *cells[0], *cells[1]))
    print_table(rows if len(rows) > 1 else [("no peak between the ends",)])
    limit = 0.5 / case.time.step
    if found.frequency[-1] > limit * (1 + 1e-12):
        typer.echo(f"note: above {limit:g} Hz, 1 / (2 dt), the steps see a load as its alias at a lower frequency")
