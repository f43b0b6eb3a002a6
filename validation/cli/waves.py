"""The parts of ``advise`` on frequencies: ``response`` and ``rayleigh``."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli.app import SceneArgument, SetOption, one_case, parts
from validation.cli.printing.output import columns, echo
from validation.runs.numbers import share_text

if TYPE_CHECKING:
    from validation.advice.rayleigh import Rayleigh
    from validation.advice.response import Peak, Response
    from validation.runs.history import Array
    from validation.scenes.scene import Scene
    from validation.theory.stepping import Stepping

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
    frequencies = _frequencies(low, high, points, logarithmic)
    check_ending(figure, "--figure")
    answers = {solver: answer(case, frequencies, solver), EXACT: answer(case, frequencies, solver, exact=True)}
    if csv is not None:
        _write(answers[EXACT if exact else solver], csv)
    if figure is not None:
        _draw(case, answers, logarithmic, figure)
    _print_peaks(case, answers)


def _frequencies(low: float, high: float, points: int, logarithmic: bool) -> Array:
    """Return the frequencies of a sweep [Hz], or refuse its ends."""
    import numpy as np

    from validation.errors import InputError

    if not (math.isfinite(low) and math.isfinite(high) and 0 <= low <= high):
        raise InputError(
            "must be finite, not negative and in this order", field="--from, --to", value=f"{low:g} and {high:g}"
        )
    if logarithmic and low == 0:
        raise InputError("must be greater than 0 with --log", field="--from", value="0")
    spaced = np.geomspace if logarithmic else np.linspace
    return np.asarray(spaced(low, high, points), dtype=np.float64)


def _write(response: Response, path: Path) -> None:
    """Write the table with all digits."""
    from validation.advice.response import HEADER
    from validation.runs.files import write_atomically

    lines = [",".join(HEADER), *(",".join(map(repr, row)) for row in response.table().tolist())]
    write_atomically(path, lambda stream: stream.write(("\n".join(lines) + "\n").encode()))
    echo(f"wrote {path}: {len(lines) - 1} frequencies")


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
    has_unbounded = False
    left_out = 0
    for name, answer in answers.items():
        label = name if name == EXACT else "as stepped"
        if name != EXACT and all(np.array_equal(answer.columns[c], exact_response.columns[c]) for c in answer.columns):
            continue  # of a solver that takes no steps
        highest = math.inf if answer.exact else limit  # what steps show beyond is the alias of another peak
        peak_cells: list[list[tuple[str, str]]] = []
        for column in (DISPLACEMENT, PRESSURE):
            visible = [peak for peak in answer.peaks(column) if peak.frequency <= highest]
            left_out = max(left_out, len(visible) - PEAKS)
            peaks = visible[:PEAKS]
            has_unbounded |= not all(peak.is_bounded for peak in peaks)
            peak_cells.append([(f"{peak.frequency:.6g}", _amplitude(peak)) for peak in peaks])
        for displacement, pressure in itertools.zip_longest(*peak_cells, fillvalue=("", "")):
            rows.append((label, *displacement, *pressure))
    if len(rows) == 1:
        rows = [(f"no peak from {exact_response.frequency[0]:g} to {exact_response.frequency[-1]:g} Hz",)]
    echo(columns(rows))
    if left_out > 0:
        echo(f"note: {PEAKS} peaks of each at most, unbounded ones before the highest others")
    if has_unbounded:
        echo("note: unbounded: no damping; the amplitude has no limit at this natural frequency")
    if exact_response.frequency[-1] > limit:
        echo(f"note: above {limit:g} Hz, 1 / (2 dt), the steps see a load as its alias at a lower frequency")


def _amplitude(peak: Peak) -> str:
    return f"{peak.amplitude:.6g}" if peak.is_bounded else "unbounded"


@parts.command()
def rayleigh(
    scene: SceneArgument,
    assignments: SetOption = None,
    a0: Annotated[
        float | None, typer.Option("--a0", help="In reverse: the mass damping you want.", metavar="1/S")
    ] = None,
    a1: Annotated[
        float | None, typer.Option("--a1", help="In reverse: the stiffness damping you want.", metavar="S")
    ] = None,
    ratios: Annotated[
        list[str] | None,
        typer.Option("--ratio", help="In reverse: a damping ratio at a frequency, 5=0.02; give two.", metavar="HZ=XI"),
    ] = None,
    keep_step: Annotated[bool, typer.Option("--keep-dt", help="In reverse: keep dt and find delta and gg.")] = False,
    low: Annotated[float | None, typer.Option("--from", help="Lowest frequency shown.", metavar="HZ")] = None,
    high: Annotated[float | None, typer.Option("--to", help="Highest frequency shown.", metavar="HZ")] = None,
    figure: FigureOption = None,
) -> None:
    """Translate the damping that a time step hides into Rayleigh's a0 and a1, or what you want into dt, delta and gg.

    Example: [bold]dda-validate advise rayleigh figures-3-4 --set time.step=0.01 --set time.gg=0.99 --to 20[/bold]

    C = a0 M + a1 K, as other codes take it. In reverse, say what you want: --ratio 2=0.05 --ratio 20=0.05, or --a0
    and --a1.
    """
    from dataclasses import replace

    from validation.advice import rayleigh as advice
    from validation.runs.files import check_ending

    check_ending(figure, "--figure")
    case = one_case(scene, assignments)
    scheme = advice.scheme_of(case)
    points: list[tuple[float, float]] = []
    if ratios or a0 is not None or a1 is not None:
        points = advice.points(ratios or [], a0, a1)
        scheme = _back(advice.wanted(points, a0, a1), points, replace(scheme, gg=1.0), keep_step)
    ends = sorted(f for f, _ in points) or [0.005 / scheme.step, 0.2 / scheme.step]
    tables = case.damping
    if tables.present:
        rayleigh_terms = f"a0 = {tables.mass:g} 1/s and a1 = {tables.stiffness:g} s"
        echo(f"note: the scene's own damping tables, {rayleigh_terms}, come on top of what the step hides")
    if tables.kinetic == "adaptive":
        echo("note: the scene's self-adaptive damping, which no a0 and a1 can express, comes on top of it")
    band = low or ends[0], high or ends[1]
    advice.check_band(*band, scheme.step)
    _print_scheme(scheme, band)
    if figure is not None:
        _draw_ratios(scheme, band, figure)


def _back(target: Rayleigh, points: list[tuple[float, float]], scheme: Stepping, keep_step: bool) -> Stepping:
    """Say which scheme hides a wanted damping, and return the best one.

    Two ratios may belong to a scheme although none has them to leading order.

    Raises
    ------
    InputError
        Neither does.
    """
    from validation.advice.rayleigh import ROUNDING, exact_settings, misfit, settings
    from validation.errors import InputError

    leading = None
    echo(f"wanted: a0 = {target.a0:.6g} 1/s, a1 = {target.a1:.6g} s")
    try:
        leading = settings(target, scheme, keep_step)
        echo(f"to leading order: {leading.words}")
    except InputError as error:
        if not points:
            raise
        echo(f"to leading order: none ({error})")
    if not points:
        return leading or scheme
    try:
        exact = exact_settings(points[0], points[1], scheme, keep_step)
    except InputError as error:
        if leading is None:
            raise
        echo(f"exactly: {error}")
        return leading
    missed = misfit(exact, *points)
    how = "exactly" if missed <= ROUNDING else f"within {share_text(missed, 2)}"
    echo(f"{how} at both frequencies: {exact.words}")
    return exact


def _print_scheme(scheme: Stepping, band: tuple[float, float]) -> None:
    """Print a0 and a1 of a scheme and its damping ratio over frequency."""
    import numpy as np

    from validation.advice.rayleigh import hidden, matched, ratio

    leading = hidden(scheme)
    fitted = matched(scheme, *band)
    echo(f"\n{scheme.words} hides the Rayleigh damping")
    rows: list[tuple[str, ...]] = [("", "a0 [1/s]", "a1 [s]", "least xi [%]", "at [Hz]")]
    for name, damping in (("leading order", leading), (f"exact at {band[0]:.4g} and {band[1]:.4g} Hz", fitted)):
        least = ("-", "-") if damping.least is None else (f"{100 * damping.least[1]:.6g}", f"{damping.least[0]:.6g}")
        rows.append((name, f"{damping.a0 + 0.0:.6g}", f"{damping.a1:.6g}", *least))
    echo(columns(rows))
    frequency = np.geomspace(*band, 8)
    values = np.column_stack([frequency, 100 * ratio(scheme, frequency), 100 * leading.ratio(frequency)])
    heads = ("frequency [Hz]", "steady xi [%]", "leading order")
    echo(f"\n{columns([heads, *(tuple(f'{value:.5g}' for value in row) for row in values)])}")


def _draw_ratios(scheme: Stepping, band: tuple[float, float], path: Path) -> None:
    """Draw the damping ratio over frequency, exact, to leading order and matched at the ends of the band."""
    import numpy as np

    from validation.advice.rayleigh import hidden, matched, ratio
    from validation.report.figures.response import ratio_figure, save_as

    f = np.geomspace(*band, 300)
    lines = {
        "as stepped": ratio(scheme, f),
        "Rayleigh, leading order": hidden(scheme).ratio(f),
        "Rayleigh, exact at both ends": matched(scheme, *band).ratio(f),
    }
    echo(f"wrote {save_as(ratio_figure(f, lines), path)}")
