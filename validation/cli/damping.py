"""The commands ``damping`` and ``advise``: damping, and settings for a target."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.cli.app import (
    JsonOption,
    SceneArgument,
    SetOption,
    _progress,
    app,
    one_case,
)
from validation.cli.printing.output import broken, columns, echo_answer
from validation.runs.numbers import number_text, share_text

if TYPE_CHECKING:
    from validation.advice.advice import Solution
    from validation.advice.columns import ColumnLimits
    from validation.advice.spectra import Damping
    from validation.scenes.scene import Scene

Answer = tuple[Any, Iterable[str]]  # plain data, and the lines that say it


@app.command()
def damping(scene: SceneArgument, assignments: SetOption = None, as_json: JsonOption = False) -> None:
    """Show the damping that a scene really has, mode by mode: total, algorithmic, kinetic and viscous.

    Example: [bold]dda-validate damping figures-3-4 --set time.step=0.002[/bold]
    """
    from validation.advice.spectra import damping as analyse

    analysis = analyse(one_case(scene, assignments), references=True)
    echo_answer(analysis.as_dict(), _damping_lines(analysis), as_json)


@app.command()
def advise(
    scene: SceneArgument,
    damping: Annotated[
        float | None,
        typer.Option("--damping", help="Target damping ratio of the first axial mode, 0.05 for 5 %.", min=0.0),
    ] = None,
    solve_for: Annotated[
        str | None,
        typer.Option(
            "--solve-for",
            help="What to vary: dt (if absent), gg, or scheme (delta, with alpha = (1/2 + delta)^2 / 4).",
            metavar="NAME",
        ),
    ] = None,
    at: Annotated[
        float | None,
        typer.Option("--at", help="With --damping: frequency at which it is wanted, across all schemes.", metavar="HZ"),
    ] = None,
    across: Annotated[
        bool, typer.Option("--across", help="With --damping: answer across all schemes, each at its own step.")
    ] = False,
    no_gain: Annotated[
        bool | None,
        typer.Option("--no-gain/--gain", help="Across schemes: impacts must gain nothing; so if contact opens."),
    ] = None,
    fmax: Annotated[
        float | None,
        typer.Option(
            "--fmax", help="Instead of --damping: highest frequency of a wave that must arrive.", metavar="HZ"
        ),
    ] = None,
    loss: Annotated[float, typer.Option("--loss", help="Share of the wave's amplitude that may be lost.")] = 0.1,
    wavelengths: Annotated[
        float | None,
        typer.Option("--wavelengths", help="Wavelengths that the wave travels; without it the height of the column."),
    ] = None,
    phase_error: Annotated[
        float, typer.Option("--phase-error", help="Fraction of a period by which the wave may arrive early or late.")
    ] = 0.05,
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the step, discount or scheme for a damping ratio, or the blocks and the step with which a wave arrives.

    Example: [bold]dda-validate advise figures-3-4 --set time.step=0.002 --damping 0.05 --solve-for gg[/bold]

    Example: [bold]dda-validate advise figures-3-4 --set time.step=0.01 --fmax 20 --loss 0.1 --wavelengths 10[/bold]

    Across schemes: [bold]dda-validate advise figures-3-4 --set time.step=0.002 --damping 0.05 --at 5 --no-gain[/bold]

    Of a column whose contacts open or slip it says which solves to allow, and the step: advise columns-weight
    """
    from validation.advice.columns import limits
    from validation.errors import InputError
    from validation.scenes.features import refuse_nonlinear

    case = one_case(scene, assignments)
    is_across = across or at is not None or no_gain is not None
    if is_across and damping is None:
        raise InputError("must be given with --at, --across and --no-gain", field="--damping", value="nothing")
    if solve_for is not None and (is_across or fmax is not None):
        rule = "goes with --damping alone, without --at, --across, --no-gain and --fmax"
        raise InputError(rule, field="--solve-for", value=repr(solve_for))
    if (bounds := limits(case)) is not None:
        if damping is not None or fmax is not None:
            refuse_nonlinear(case, "--damping and --fmax are")
        answer = partial(_of_column, case, bounds)
    elif damping is None and fmax is not None:
        answer = partial(_of_wave, case, fmax, loss, wavelengths, phase_error)
    elif damping is None or fmax is not None:
        number = "neither" if damping is None else "both"
        raise InputError("one of them must be given", field="--damping, --fmax", value=number)
    elif is_across:
        answer = partial(_of_schemes, case, damping, at, no_gain)
    else:
        answer = partial(_of_damping, case, damping, solve_for or "dt")
    with _progress("advise", between_calls=True):
        data, lines = answer()
    echo_answer(data, lines, as_json)


def _of_column(case: Scene, bounds: ColumnLimits) -> Answer:
    """Say which solves a column whose contacts open or slip needs, when it comes to rest, and what to fear."""
    from dataclasses import asdict

    from validation.advice.columns import advised, column_alarms, rest
    from validation.advice.plain import plain

    resting = rest(case)
    alarms = (f"ALARM {alarm.kind}: {alarm.sentence}" for alarm in column_alarms(case))
    data = asdict(bounds) | {"rest": None if resting is None else asdict(resting)}
    return plain(data), map(broken, (*advised(case, bounds, resting), *alarms))


def _of_wave(case: Scene, fmax: float, loss: float, wavelengths: float | None, phase_error: float) -> Answer:
    """Say what the present blocks and step do to a wave, and which would do."""
    from validation.advice.wave_advice import advise_wave

    advice = advise_wave(case, fmax, loss, wavelengths, phase_error)
    rows: list[tuple[str, ...]] = [("", "blocks [m]", "dt [s]", "lost", "late [periods]", "steady ratio")]
    for name, passage in (("present", advice.present), ("advised", advice.advised)):
        if passage is not None:
            heights = ", ".join(f"{height:.5g}" for height in passage.heights)
            shares = share_text(passage.loss, 4), f"{passage.delay:+.4g}", _percent(passage.damping)
            rows.append((name, heights, f"{passage.step:.6g}", *shares))
    return advice.as_dict(), [f"{broken(advice.sentence)}\n{broken(advice.advice)}\n", columns(rows)]


def _of_schemes(case: Scene, damping: float, at: float | None, no_gain: bool | None) -> Answer:
    """Say which schemes have a damping ratio at a frequency, and what else they do."""
    from validation.advice.across import advise_across

    advice = advise_across(case, damping, at, no_gain)
    offers = advice.offers
    heads = [f"xi at {float(hertz):.4g} Hz" for hertz in (offers[0].hidden if offers else ())]
    rows: list[tuple[str, ...]] = [("", "dt [s]", *heads, "first mode", "contact", "solves", "rebound", "at any step")]
    for offer in offers:
        ratios = map(_percent, (*offer.hidden.values(), offer.first_mode, offer.contact_mode))
        numbers = (number_text(number, 3) for number in (offer.cost, offer.rebound["most"], offer.greatest_rebound))
        rows.append((offer.name, f"{offer.step:.5g}", *ratios, *numbers))
    notes = [f"{offer.name}: {'; '.join(offer.fears)}" for offer in offers if offer.fears]
    notes += [f"{name}: has {_percent(most)} there at most, at any step" for name, most in advice.unreachable.items()]
    legend = "\nsolves: a second, over those of the scene; rebound: the greatest, 1 returns the speed"
    return advice.as_dict(), [f"{broken(advice.sentence)}\n", columns(rows), legend, *map(broken, notes)]


def _of_damping(case: Scene, damping: float, solve_for: str) -> Answer:
    """Say which time step, discount or scheme gives a damping ratio of the first mode, and what follows from it."""
    from validation.advice.advice import advise as solve_for_damping
    from validation.advice.advice import expected_errors

    advice = solve_for_damping(case, damping, solve_for)
    data = advice.as_dict()
    lines = [broken(advice.sentence)]
    for solution, plain_solution in zip(advice.solutions, data["solutions"], strict=True):
        plain_solution["errors"] = expected_errors(case, solution)
        lines.append("\n" + ", ".join(f"{key} = {value:.9g}" for key, value in solution.settings.items()))
        lines.append(columns([(f"  {key}", value) for key, value in _facts(solution, plain_solution["errors"])]))
    return data, lines


def _damping_lines(analysis: Damping) -> Iterator[str]:
    """Yield the damping of every mode, and the first modes of the references."""
    yield f"{broken(analysis.sentence)}\n\ngg = {analysis.gg:.6g} per step{_rate(analysis.gg_rate)}"
    has_tables = any(mode.viscous for mode in analysis.modes)
    parts = ("algorithmic", "kinetic", "viscous") if has_tables else ("algorithmic", "kinetic")
    rows: list[tuple[str, ...]] = [("mode", "w [rad/s]", "w dt", "xi [%]", *parts, "|lambda|", "w/w' - 1")]
    for mode in analysis.modes:
        ratios = [number_text(getattr(mode, part), factor=100) for part in ("damping", *parts)]
        elongation = number_text(mode.period_elongation, 3)
        radius = f"{mode.spectral_radius:.6g}"
        rows.append((mode.name, f"{mode.frequency:.6g}", f"{mode.omega_dt:.4g}", *ratios, radius, elongation))
    for name, values in analysis.references.items():
        ratio = number_text(values["damping"], factor=100)
        rows.append((f"{name}, first", f"{values['frequency']:.6g}", "", ratio, *[""] * (len(parts) + 2)))
    yield columns(rows)
    if analysis.alias is not None:
        first = analysis.references["bar"]["frequency"] or 0.0
        alias_note = (
            f"alias: the continuum's first mode, {first:.6g} rad/s, lies beyond pi / dt = "
            f"{math.pi / analysis.step:.6g} rad/s; samples every dt show {analysis.alias:.6g} rad/s instead"
        )
        yield f"\n{broken(alias_note)}"


def _facts(solution: Solution, error: dict[str, Any]) -> Iterator[tuple[str, str]]:
    from validation.advice.advice import NO_STATIC
    from validation.advice.spectra import runs

    settles = f"never (from the {solution.settling_from})"
    if solution.settling_from == NO_STATIC:
        settles = f"nowhere: the loads have {NO_STATIC}"
    elif solution.settling_steps is not None:
        steps = f"{solution.settling_steps} steps = {solution.settling_seconds:.4g} s"
        settles = f"{steps} (from the {solution.settling_from})"
    yield "damping ratio", share_text(solution.damping, 6)
    yield "discount", f"gg = {solution.gg:.6g} per step{_rate(solution.gg_rate)}"
    yield "displacement settles", settles
    if solution.contact is not None:
        yield "contact mode", runs(solution.contact)
    for name in ("fem", "continuum"):
        values = error.get(name, {})
        differences = [f"{key} {share_text(value)}" for key, value in values.items() if isinstance(value, float)]
        text = "; ".join(map(str, values.values()))
        if differences:
            text = f"{', '.join(differences)} over {error['window']:.4g} s (relative L2)"
        yield f"differs from {name} by", text


def _rate(gg_rate: float | None) -> str:
    return "" if gg_rate is None else f", c = {gg_rate:.4g} 1/s"


def _percent(value: float | None, none: str = "real roots") -> str:
    return none if value is None else number_text(value, factor=100, unit=" %")
