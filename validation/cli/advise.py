"""The command ``advise``: all about a scene at once, and its parts ``damping``, ``step``, ``schemes`` and ``wave``."""

from __future__ import annotations

import itertools
import math
import shlex
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli.app import JsonOption, SceneArgument, SetOption, _progress, one_case, parts
from validation.cli.printing.output import columns, echo_answer
from validation.runs.numbers import number_text, share_text

if TYPE_CHECKING:
    from validation.advice.advice import Solution
    from validation.advice.spectra import Damping

ERROR = 0.05  # of displacement and contact force, that is allowed where nothing else is said
TargetOption = Annotated[float, typer.Option("--damping", help="Target damping ratio, 0.05 for 5 %.", min=0.0)]


@parts.command()
def everything(
    scene: SceneArgument,
    goal: Annotated[
        str | None,
        typer.Option("--goal", help="Only static, wave, impact or quake, and its settings as --set.", metavar="GOAL"),
    ] = None,
    error: Annotated[
        float, typer.Option("--error", help="Allowed error of displacement and contact force, 0.05 for 5 %.")
    ] = ERROR,
    frequency: Annotated[
        float | None,
        typer.Option(
            "--frequency",
            help="Of the wave or the quake. (a wave of twenty blocks and 5 Hz if absent)",
            metavar="HZ",
        ),
    ] = None,
    keep_springs: Annotated[
        bool, typer.Option("--keep-springs", help="Of a block: they are those of a real joint, and stay.")
    ] = False,
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Say what step, springs and discount of a scene really do, and which to take for what, each as run by dda.

    Example: [bold]dda-validate advise figures-3-4 --set time.step=0.002[/bold]

    Example: [bold]dda-validate advise figures-3-4 --set time.step=0.002 --goal wave --frequency 20 --error 0.1[/bold]

    Of a column whose contacts open or slip it says which solves to allow, and the step: advise columns-weight; of
    blocks that move in the plane springs and step of their contacts: advise rigid-impact
    """
    from validation.advice.goals import GOALS, Question
    from validation.advice.pages import PageHooks

    goals = GOALS if goal is None else (goal,)
    question = Question(_words(scene, assignments), error, goals, frequency, keep_springs)
    case = one_case(scene, assignments)
    with _progress("advise") as progress:
        data, text = PageHooks.of(case).page(case, replace(question, progress=progress))
    echo_answer(data, text, as_json)


def _words(scene: str, assignments: list[str] | None) -> str:
    """Return a scene with values set as a command line has it."""
    return shlex.join([scene, *itertools.chain.from_iterable(("--set", value) for value in assignments or [])])


@parts.command()
def damping(scene: SceneArgument, assignments: SetOption = None, as_json: JsonOption = False) -> None:
    """Show the damping that a scene really has, mode by mode: total, algorithmic, kinetic and viscous.

    Example: [bold]dda-validate advise damping figures-3-4 --set time.step=0.002[/bold]
    """
    from validation.advice.spectra import damping as analyse

    analysis = analyse(one_case(scene, assignments), references=True)
    echo_answer(analysis, _damping_lines(analysis), as_json)


@parts.command()
def step(
    scene: SceneArgument,
    target: TargetOption,
    solve_for: Annotated[
        str,
        typer.Option(
            "--solve-for",
            help="What to vary: dt, gg, or scheme (delta, with alpha = (1/2 + delta)^2 / 4).",
            metavar="NAME",
        ),
    ] = "dt",
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the step, the discount or the scheme that damps the first axial mode as you want.

    Example: [bold]dda-validate advise step figures-3-4 --set time.step=0.002 --damping 0.05 --solve-for gg[/bold]
    """
    from validation.advice.advice import advise as solve_for_damping

    case = one_case(scene, assignments)
    with _progress("advise"):
        advice = solve_for_damping(case, target, solve_for)
    lines = [advice.sentence]
    for solution in advice.solutions:
        lines.append("\n" + ", ".join(f"{key} = {value:.9g}" for key, value in solution.settings.items()))
        lines.append(columns([(f"  {key}", value) for key, value in _facts(solution)]))
    if not advice.solutions:
        lines.append(f"more: dda-validate advise schemes {_words(scene, assignments)} --damping {target:g}")
    echo_answer(advice, lines, as_json)


@parts.command()
def schemes(
    scene: SceneArgument,
    target: TargetOption,
    at: Annotated[
        float | None, typer.Option("--at", help="Frequency of that damping; the first mode's if absent.", metavar="HZ")
    ] = None,
    no_gain: Annotated[
        bool | None, typer.Option("--no-gain/--gain", help="Impacts must gain nothing; so if the contact opens.")
    ] = None,
    assignments: SetOption = None,
    as_json: JsonOption = False,
) -> None:
    """Show each time scheme at the step that has a damping ratio at a frequency, the recommended first.

    Example: [bold]dda-validate advise schemes figures-3-4 --set time.step=0.002 --damping 0.05 --at 5 --no-gain[/bold]
    """
    from validation.advice.across import advise_across

    with _progress("advise"):
        advice = advise_across(one_case(scene, assignments), target, at, no_gain)
    offers = advice.offers
    heads = [f"xi at {float(hertz):.4g} Hz" for hertz in (offers[0].hidden if offers else ())]
    rows = [("", "dt [s]", *heads, "first mode", "contact", "solves", "rebound", "at any step")]
    for offer in offers:
        ratios = map(_percent, (*offer.hidden.values(), offer.first_mode, offer.contact_mode))
        numbers = (number_text(number, 3) for number in (offer.cost, offer.rebound["most"], offer.greatest_rebound))
        rows.append((offer.name, f"{offer.step:.5g}", *ratios, *numbers))
    notes = [f"{offer.name}: {'; '.join(offer.fears)}" for offer in offers if offer.fears]
    notes += [f"{name}: has {_percent(most)} there at most, at any step" for name, most in advice.unreachable.items()]
    legend = "\nsolves: a second, over those of the scene; rebound: the greatest, 1 returns the speed"
    lines = [f"{advice.sentence}\n", columns(rows), legend, *notes]
    echo_answer(advice, lines, as_json)


@parts.command()
def wave(
    scene: SceneArgument,
    fmax: Annotated[float, typer.Option("--fmax", help="Highest frequency of a wave that must arrive.", metavar="HZ")],
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
    """Find the blocks and the step with which a wave arrives.

    Example: [bold]dda-validate advise wave figures-3-4 --set time.step=0.01 --fmax 20 --wavelengths 10[/bold]
    """
    from validation.advice.wave_advice import advise_wave

    with _progress("advise"):
        advice = advise_wave(one_case(scene, assignments), fmax, loss, wavelengths, phase_error)
    rows = [("", "blocks [m]", "dt [s]", "lost", "late [periods]", "steady ratio")]
    for name, passage in (("present", advice.present), ("advised", advice.advised)):
        if passage is not None:
            heights = ", ".join(f"{height:.5g}" for height in passage.heights)
            shares = share_text(passage.loss, 4), f"{passage.delay:+.4g}", _percent(passage.damping)
            rows.append((name, heights, f"{passage.step:.6g}", *shares))
    lines = [f"{advice.sentence}\n{advice.advice}\n", columns(rows)]
    echo_answer(advice, lines, as_json)


def _damping_lines(analysis: Damping) -> Iterator[str]:
    """Yield the damping of every mode, and the first modes of the references."""
    from validation.advice.words import say

    yield f"{analysis.sentence}\n\ngg = {analysis.gg:.6g} per step{_rate(analysis.gg_rate)}"
    has_tables = any(mode.viscous for mode in analysis.modes)
    shares = ("algorithmic", "kinetic", "viscous") if has_tables else ("algorithmic", "kinetic")
    rows = [("mode", "w [rad/s]", "w dt", "xi [%]", *shares, "|lambda|", "w/w' - 1")]
    for mode in analysis.modes:
        ratios = [number_text(getattr(mode, part), factor=100) for part in ("damping", *shares)]
        numbers = (f"{mode.frequency:.6g}", f"{mode.omega_dt:.4g}", *ratios, f"{mode.spectral_radius:.6g}")
        rows.append((mode.name, *numbers, number_text(mode.period_elongation, 3)))
    for name, values in analysis.references.items():
        ratio = number_text(values["damping"], factor=100)
        rows.append((f"{name}, first", f"{values['frequency']:.6g}", "", ratio, *[""] * (len(shares) + 2)))
    yield columns(rows)
    exact = analysis.references.get("bar")
    if analysis.alias is not None and exact:
        yield say("alias", analysis, first=exact["frequency"], limit=math.pi / analysis.step)


def _facts(solution: Solution) -> Iterator[tuple[str, str]]:
    from validation.advice.advice import NO_STATIC
    from validation.advice.spectra import runs
    from validation.advice.words import say

    settles = f"never (from the {solution.settling_from})"
    if solution.settling_from == NO_STATIC:
        settles = f"nowhere: the loads have {NO_STATIC}"
    elif solution.settling_steps is not None:
        settles = say("settles from", solution)
    yield "damping ratio", share_text(solution.damping, 6)
    yield "discount", f"gg = {solution.gg:.6g} per step{_rate(solution.gg_rate)}"
    yield "displacement settles", settles
    if solution.contact is not None:
        yield "contact mode", runs(solution.contact)


def _rate(gg_rate: float | None) -> str:
    return "" if gg_rate is None else f", c = {gg_rate:.4g} 1/s"


def _percent(value: float | None, none: str = "real roots") -> str:
    return none if value is None else number_text(value, factor=100, unit=" %")
