"""The commands ``damping`` and ``advise``: damping, and settings for a target."""

from __future__ import annotations

import math
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
from validation.cli.printing.listing import in_columns
from validation.cli.printing.output import broken, echo, echo_json, terminal_width

if TYPE_CHECKING:
    from validation.advice.advice import Advice, Solution
    from validation.advice.columns import ColumnLimits
    from validation.advice.engine_settings import EngineAdvice
    from validation.advice.spectra import Damping
    from validation.scenes.scene import Scene


@app.command()
def damping(scene: SceneArgument, assignments: SetOption = None, as_json: JsonOption = False) -> None:
    """Show the damping that a scene really has, mode by mode: total, algorithmic, kinetic and viscous.

    Example: [bold]dda-validate damping figures-3-4 --set time.step=0.002[/bold]
    """
    from validation.advice.spectra import damping as analyse

    analysis = analyse(one_case(scene, assignments), references=True)
    if as_json:
        echo_json(analysis.as_dict())
    else:
        _print_damping(analysis)


@app.command()
def advise(
    scene: SceneArgument,
    damping: Annotated[
        float | None,
        typer.Option("--damping", help="Target damping ratio of the first axial mode, 0.05 for 5 %.", min=0.0),
    ] = None,
    solve_for: Annotated[
        str,
        typer.Option(
            "--solve-for",
            help="What to vary: dt, gg, or scheme (delta, with alpha = (1/2 + delta)^2 / 4).",
            metavar="NAME",
        ),
    ] = "dt",
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
    program: Annotated[
        str | None,
        typer.Option(
            "--for",
            help="What to set in another program instead: box2d, mujoco, opensees, pybullet, yade; with --penetration, "
            "--restitution or --hidden-damping.",
            metavar="PROGRAM",
        ),
    ] = None,
    penetration: Annotated[
        float | None, typer.Option("--penetration", help="With --for: wanted at rest.", metavar="M")
    ] = None,
    restitution: Annotated[
        float | None, typer.Option("--restitution", help="With --for: rebound over approach speed.")
    ] = None,
    hidden: Annotated[
        float | None,
        typer.Option("--hidden-damping", help="With --for: damping ratio that the program's steps may add, 0.01."),
    ] = None,
    speed: Annotated[
        float | None, typer.Option("--speed", help="With --for: of the landing, if not the scene's.", metavar="M/S")
    ] = None,
    step: Annotated[
        float | None,
        typer.Option("--step", help="With --for: of the program, if not the scene's or its own.", metavar="S"),
    ] = None,
    points: Annotated[
        int | None,
        typer.Option("--points", help="With --for: contact points that share the body, if not those of a box."),
    ] = None,
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the step, discount or scheme for a damping ratio, or the blocks and the step with which a wave arrives.

    Example: [bold]dda-validate advise figures-3-4 --set time.step=0.002 --damping 0.05 --solve-for gg[/bold]

    Example: [bold]dda-validate advise figures-3-4 --set time.step=0.01 --fmax 20 --loss 0.1 --wavelengths 10[/bold]

    Across schemes: [bold]dda-validate advise figures-3-4 --set time.step=0.002 --damping 0.05 --at 5 --no-gain[/bold]

    Of a column whose contacts open or slip it says which solves to allow, and the step: advise columns-weight

    Another program: [bold]dda-validate advise field-rebound --for mujoco --penetration 1e-4 --restitution 0.5[/bold]
    """
    from validation.advice.columns import limits
    from validation.errors import InputError
    from validation.scenes.features import refuse_nonlinear

    case = one_case(scene, assignments)
    for_program = {
        "--penetration": penetration,
        "--restitution": restitution,
        "--hidden-damping": hidden,
        "--speed": speed,
        "--step": step,
        "--points": points,
    }
    of_schemes = {
        "--damping": damping,
        "--at": at,
        "--across": across or None,
        "--no-gain": no_gain,
        "--fmax": fmax,
    }
    for name, value in (for_program if program is None else of_schemes).items():
        if value is not None:
            rule = "goes with --for PROGRAM only" if program is None else "cannot be given with --for"
            raise InputError(rule, field=name, value=value)
    if program is not None:
        from validation.advice.engine_settings import advise_engine

        advice = advise_engine(
            case,
            program,
            penetration=penetration,
            restitution=restitution,
            hidden=hidden,
            speed=speed,
            step=step,
            points=points,
        )
        _print_settings(advice, as_json)
        return
    is_across = across or at is not None or no_gain is not None
    if is_across and damping is None:
        raise InputError("must be given with --at, --across and --no-gain", field="--damping", value="nothing")
    if (bounds := limits(case)) is not None:
        if damping is not None or fmax is not None:
            refuse_nonlinear(case, "--damping and --fmax are")
        _advise_contacts(case, bounds, as_json)
    elif (damping is None) == (fmax is None):
        number = "neither" if damping is None else "both"
        raise InputError("one of them must be given", field="--damping, --fmax", value=number)
    elif is_across:
        _advise_across(case, float(damping or 0), at, no_gain, as_json)
    elif damping is None:
        _advise_wave(case, float(fmax or 0), (loss, wavelengths, phase_error), as_json)
    else:
        _advise_damping(case, damping, solve_for, as_json)


def _print_settings(advice: EngineAdvice, as_json: bool) -> None:
    """Print what to set in another program, what that does, and what the program does as it comes."""
    if as_json:
        echo_json(advice.as_dict())
        return
    from validation.advice.engine_table import PROGRAMS

    program = PROGRAMS[advice.program]
    meanings = {one.name: one.meaning for one in program.parameters}
    settings = []
    for name, value in advice.settings.items():
        numbers = value if isinstance(value, tuple) else (value,)
        settings.append((f"  {meanings.get(name, name)}", " ".join(f"{number:.6g}" for number in numbers)))
    echo(f"{program.title}: set")
    echo(in_columns(settings, terminal_width()))
    body = f"{advice.mass:.6g} kg on {advice.points} contact point{'' if advice.points == 1 else 's'}"
    at_step = "" if advice.step is None else f", step {advice.step:.6g} s"
    facts = [("  body", body + at_step)]
    if advice.penetration is not None:
        facts.append(("  penetration at rest", f"{1e3 * advice.penetration:.6g} mm"))
    if advice.rebound is not None:
        rebound = advice.rebound
        facts.append(
            ("  restitution", f"mean {rebound['mean']:.4g}, from {rebound['low']:.4g} to {rebound['high']:.4g}")
        )
    if advice.hidden is not None:
        facts.append(("  hidden damping", _in_percent(advice.hidden)))
    if advice.omega_step is not None:
        facts.append(("  w h, zeta", f"{advice.omega_step:.4g}, {advice.damping_ratio:.4g}"))
    if advice.stiffness_ratio is not None:
        facts.append(("  contact over block", f"k h / (E a) = {advice.stiffness_ratio:.4g}"))
    comes = advice.defaults
    depth = "-" if comes["penetration"] is None else f"{1e3 * comes['penetration']:.4g} mm"
    e = "-" if comes["restitution"] is None else f"{comes['restitution']:.4g}"
    hidden = "-" if comes["hidden"] is None else _in_percent(comes["hidden"])
    facts.append(("  as it comes", f"penetration {depth}, restitution {e}, hidden damping {hidden}"))
    echo("which gives")
    echo(in_columns(facts, terminal_width()))
    for note in advice.notes:
        echo(broken(f"note: {note}"))
    echo(broken(f"source: {program.source}; checked with {program.title} {program.version}"))


def _advise_contacts(case: Scene, bounds: ColumnLimits, as_json: bool) -> None:
    """Say what a column whose contacts open or slip needs of its steps."""
    from dataclasses import asdict

    from validation.advice.columns import advised, column_alarms
    from validation.advice.contact_page import plain

    if as_json:
        echo_json(plain(asdict(bounds)))
        return
    for sentence in advised(case, bounds):
        echo(broken(sentence))
    for alarm in column_alarms(case):
        echo(broken(f"ALARM {alarm.kind}: {alarm.sentence}"))


def _advise_wave(case: Scene, fmax: float, limits: tuple[float, float | None, float], as_json: bool) -> None:
    """Say what the present blocks and step do to a wave, and which would do."""
    from validation.advice.wave_advice import advise_wave

    wave_advice = advise_wave(case, fmax, *limits)
    if as_json:
        echo_json(wave_advice.as_dict())
        return
    echo(f"{broken(wave_advice.sentence)}\n{broken(wave_advice.advice)}\n")
    rows: list[tuple[str, ...]] = [("", "blocks [m]", "dt [s]", "lost", "late [periods]", "steady ratio")]
    for name, passage in (("present", wave_advice.present), ("advised", wave_advice.advised)):
        if passage is None:
            continue
        row = (
            name,
            ", ".join(f"{height:.5g}" for height in passage.heights),
            f"{passage.step:.6g}",
            f"{100 * passage.loss:.4g} %",
            f"{passage.delay:+.4g}",
            f"{100 * passage.damping + 0.0:.4g} %",
        )
        rows.append(row)
    print_table(rows)


def _advise_across(case: Scene, damping: float, at: float | None, no_gain: bool | None, as_json: bool) -> None:
    """Say which schemes have a damping ratio at a frequency, and what else they do."""
    from validation.advice.across import advise_across

    with _progress("advise", between_calls=True):
        advice = advise_across(case, damping, at, no_gain)
    if as_json:
        echo_json(advice.as_dict())
        return
    echo(f"{broken(advice.sentence)}\n")
    frequencies = [f"xi at {float(hertz):.4g} Hz" for hertz in (advice.offers[0].hidden if advice.offers else ())]
    rows: list[tuple[str, ...]] = [
        ("", "dt [s]", *frequencies, "first mode", "contact", "solves", "rebound", "at any step")
    ]
    for offer in advice.offers:
        row = (
            offer.name,
            f"{offer.step:.5g}",
            *(_in_percent(xi) for xi in (*offer.hidden.values(), offer.first_mode, offer.contact_mode)),
            "-" if offer.cost is None else f"{offer.cost:.3g}",
            f"{offer.rebound['most']:.3g}",
            f"{offer.greatest_rebound:.3g}",
        )
        rows.append(row)
    print_table(rows)
    echo("\nsolves: a second, over those of the scene; rebound: the greatest, 1 returns the speed")
    for offer in advice.offers:
        if offer.fears:
            echo(broken(f"{offer.name}: {'; '.join(offer.fears)}"))
    for name, largest in advice.unreachable.items():
        echo(broken(f"{name}: has {_in_percent(largest)} there at most, at any step"))


def _in_percent(value: float | None) -> str:
    return "real roots" if value is None else f"{100 * value + 0.0:.4g} %"


def _advise_damping(case: Scene, damping: float, solve_for: str, as_json: bool) -> None:
    """Find the time step, discount or scheme that gives a target damping ratio."""
    from validation.advice.advice import advise as solve_for_damping
    from validation.advice.advice import expected_errors

    with _progress("advise", between_calls=True):
        advice = solve_for_damping(case, damping, solve_for)
        errors = [expected_errors(case, solution) for solution in advice.solutions]
    if as_json:
        data = advice.as_dict()
        for solution, error in zip(data["solutions"], errors, strict=True):
            solution["errors"] = error
        echo_json(data)
    else:
        _print_advice(advice, errors)


def _print_damping(analysis: Damping) -> None:
    rate = "" if analysis.gg_rate is None else f", c = {analysis.gg_rate:.4g} 1/s"
    echo(f"{broken(analysis.sentence)}\n\ngg = {analysis.gg:.6g} per step{rate}")
    tables = any(mode.viscous for mode in analysis.modes)
    parts = ("algorithmic", "kinetic", "viscous") if tables else ("algorithmic", "kinetic")
    heads = ("mode", "w [rad/s]", "w dt", "xi [%]", *parts, "|lambda|", "w/w' - 1")
    rows = [
        (
            mode.name,
            f"{mode.frequency:.6g}",
            f"{mode.omega_dt:.4g}",
            *(_percent(v) for v in (mode.damping, *(getattr(mode, part) for part in parts))),
            f"{mode.spectral_radius:.6g}",
            "-" if mode.period_elongation is None else f"{mode.period_elongation:.3g}",
        )
        for mode in analysis.modes
    ]
    rows += [
        (f"{name}, first", f"{values['frequency']:.6g}", "", _percent(values["damping"]), *[""] * (len(parts) + 2))
        for name, values in analysis.references.items()
    ]
    print_table([heads, *rows])
    if analysis.alias is not None:
        first = analysis.references["bar"]["frequency"] or 0.0
        alias_note = (
            f"alias: the continuum's first mode, {first:.6g} rad/s, lies beyond pi / dt = "
            f"{math.pi / analysis.step:.6g} rad/s; samples every dt show {analysis.alias:.6g} rad/s instead"
        )
        echo(f"\n{broken(alias_note)}")


def _print_advice(advice: Advice, errors: list[dict[str, Any]]) -> None:
    echo(broken(advice.sentence))
    for solution, error in zip(advice.solutions, errors, strict=True):
        echo(f"\n{', '.join(f'{key} = {value:.9g}' for key, value in solution.settings.items())}")
        echo(in_columns(_facts(solution, error), terminal_width()))


def _facts(solution: Solution, error: dict[str, Any]) -> list[tuple[str, ...]]:
    from validation.advice.spectra import runs

    steps = "never" if solution.settling_steps is None else f"{solution.settling_steps} steps"
    seconds = "" if solution.settling_seconds is None else f" = {solution.settling_seconds:.4g} s"
    rate = "" if solution.gg_rate is None else f", c = {solution.gg_rate:.4g} 1/s"
    facts = [
        ("damping ratio", f"{100 * solution.damping:.6g} %"),
        ("discount", f"gg = {solution.gg:.6g} per step{rate}"),
        ("displacement settles", f"{steps}{seconds} (from the {solution.settling_from})"),
    ]
    if solution.contact is not None:
        facts.append(("contact mode", runs(solution.contact)))
    for name in ("fem", "continuum"):
        values = error.get(name, {})
        differences = [f"{key} {100 * value:.3g} %" for key, value in values.items() if isinstance(value, float)]
        text = "; ".join(map(str, values.values()))
        if differences:
            text = f"{', '.join(differences)} over {error['window']:.4g} s (relative L2)"
        facts.append((f"differs from {name} by", text))
    return [(f"  {key}", value) for key, value in facts]


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{100 * value + 0.0:.4g}"


def print_table(rows: list[tuple[str, ...]]) -> None:
    """Print rows in aligned columns."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        echo("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
