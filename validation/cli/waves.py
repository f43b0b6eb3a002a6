"""The part ``response`` of ``advise``: how a scene answers a load or a base that vibrates."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli.app import SceneArgument, SetOption, one_case, parts
from validation.cli.printing.output import columns, echo

if TYPE_CHECKING:
    from validation.advice.response import Peak, Response
    from validation.scenes.scene import Scene

FigureOption = Annotated[
    Path | None, typer.Option("--figure", help="Draw into a file .svg, .pdf or .png.", metavar="FILE")
]
PEAKS = 3  # that are printed
EXACT = "exact in time"
CONTINUA = ("continuum", "layers")  # solvers that are exact in space too: of a block, of a column


@parts.command()
def response(
    scene: SceneArgument,
    solver: Annotated[str, typer.Option("--solver", help="Solver whose model is used.", metavar="NAME")] = "dda",
    low: Annotated[float, typer.Option("--from", help="Lowest frequency.", metavar="HZ")] = 0.1,
    high: Annotated[float, typer.Option("--to", help="Highest frequency.", metavar="HZ")] = 200.0,
    points: Annotated[int, typer.Option("--points", help="Number of frequencies.", min=1)] = 1000,
    logarithmic: Annotated[bool, typer.Option("--log", help="Space frequencies by their logarithm.")] = False,
    exact: Annotated[bool, typer.Option("--exact", help="Write the model's answer that is exact in time.")] = False,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table.", metavar="FILE")] = None,
    figure: FigureOption = None,
    assignments: SetOption = None,
) -> None:
    """Show how a scene answers a load or a base that vibrates, over frequency; no step is run.

    Example: [bold]dda-validate advise response figures-3-4 --set time.step=0.002 --from 1 --figure response.svg[/bold]
    """
    from validation.advice.response import response as answer
    from validation.runs.files import check_ending

    case = one_case(scene, assignments)
    import numpy as np

    from validation.errors import InputError

    if not (math.isfinite(low) and math.isfinite(high) and 0 <= low <= high):
        raise InputError(
            "must be finite, not negative and in this order", field="--from, --to", value=f"{low:g} and {high:g}"
        )
    if logarithmic and low == 0:
        raise InputError("must be greater than 0 with --log", field="--from", value="0")
    spaced = np.geomspace if logarithmic else np.linspace
    frequencies = np.asarray(spaced(low, high, points), dtype=np.float64)
    check_ending(figure, "--figure")
    answers = {solver: answer(case, frequencies, solver), EXACT: answer(case, frequencies, solver, exact=True)}
    if csv is not None:
        response = answers[EXACT if exact else solver]
        from validation.advice.response import HEADER
        from validation.runs.files import csv_text, write_text

        table = response.table().tolist()
        write_text(csv, csv_text([HEADER, *table]))
        echo(f"wrote {csv}: {len(table)} frequencies")
    if figure is not None:
        _draw(case, answers, logarithmic, figure)
    _print_peaks(case, answers)


def _draw(case: Scene, answers: dict[str, Response], logarithmic: bool, path: Path) -> None:
    """Draw the solver as stepped and exact in time, and the continuum where it applies."""
    import numpy as np

    from validation.advice.response import polar
    from validation.advice.response import response as answer
    from validation.report.figures.response import ResponseCurve, response_figure, save_as
    from validation.solvers.registry import get_solver

    drawn = dict(answers)
    continuum = next((name for name in CONTINUA if get_solver(name).refusal(case) is None), None)
    if continuum is not None:
        drawn[continuum] = answer(case, answers[EXACT].frequency, continuum)
    curves = []
    for name, response in drawn.items():
        # Beyond half the sampling rate the steps show the alias of a lower frequency.
        is_drawn = (response.frequency <= 0.5 / case.time.step) | response.exact | (name == continuum)
        columns = {}
        for column, values in response.columns.items():
            amplitude, phase = polar(values)
            columns[column] = (np.where(is_drawn, amplitude, np.nan), np.where(is_drawn, phase, np.nan))
        label = {EXACT: f"{response.solver}, exact in time", continuum: "continuum"}.get(name, f"{name} as stepped")
        curves.append(ResponseCurve(label, response.solver, name == EXACT, response.frequency, columns))
    echo(f"wrote {save_as(response_figure(curves, logarithmic, answers[EXACT].base), path)}")


def _print_peaks(case: Scene, answers: dict[str, Response]) -> None:
    """Say where the answers peak, and where the steps see an alias."""
    import numpy as np

    from validation.runs.history import DISPLACEMENT, PRESSURE

    exact_response = answers[EXACT]
    load = "per metre of base motion" if exact_response.base else "under the scene's loads"
    echo(f"{case.name}, {exact_response.solver}: {len(exact_response.frequency)} frequencies, {load}; no step is run")
    unit = "/m" if exact_response.base else ""
    limit = 0.5 / case.time.step * (1 + 1e-12)
    heads = "", "peak [Hz]", f"displacement [m{unit}]", "peak [Hz]", f"contact pressure [Pa{unit}]"
    rows: list[tuple[str, ...]] = [heads]
    listed: list[list[Peak]] = []
    for name, answer in answers.items():
        if name != EXACT and all(np.array_equal(answer.columns[c], exact_response.columns[c]) for c in answer.columns):
            continue  # of a solver that takes no steps
        highest = math.inf if answer.exact else limit  # what steps show beyond is the alias of another peak
        both = [
            [peak for peak in answer.peaks(column) if peak.frequency <= highest] for column in (DISPLACEMENT, PRESSURE)
        ]
        listed += both
        cells = [[(f"{peak.frequency:.6g}", _amplitude(peak)) for peak in peaks[:PEAKS]] for peaks in both]
        for displacement, pressure in itertools.zip_longest(*cells, fillvalue=("", "")):
            rows.append((name if name == EXACT else "as stepped", *displacement, *pressure))
    if len(rows) == 1:
        rows = [(f"no peak from {exact_response.frequency[0]:g} to {exact_response.frequency[-1]:g} Hz",)]
    echo(columns(rows))
    if any(len(peaks) > PEAKS for peaks in listed):
        echo(f"note: {PEAKS} peaks of each at most, unbounded ones before the highest others")
    if any(not peaks[0].is_bounded for peaks in listed if peaks):  # which come first
        echo("note: unbounded: no damping; the amplitude has no limit at this natural frequency")
    if exact_response.frequency[-1] > limit:
        echo(f"note: above {limit:g} Hz, 1 / (2 dt), the steps see a load as its alias at a lower frequency")


def _amplitude(peak: Peak) -> str:
    return f"{peak.amplitude:.6g}" if peak.is_bounded else "unbounded"
