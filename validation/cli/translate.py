"""The command ``translate``: soft constraints of physics engines as spring and dashpot, and back."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.advice.engine_table import TRANSLATED
from validation.cli.app import JsonOption, app
from validation.cli.printing.output import broken, columns, echo_answer, settings_text, spread

if TYPE_CHECKING:
    from validation.advice.engines import Translation

PREFIXES = {"box2d": "Box2D", "bullet": "Bullet", "pybullet": "PyBullet", "mujoco": "MuJoCo"}


def with_parameters(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command an option for each parameter of the programs, in place of its further keywords."""
    signature = inspect.signature(command, eval_str=True)
    *stated, as_json, _ = signature.parameters.values()
    options = []
    for program in TRANSLATED.values():
        for one in program.parameters:
            kind = str if len(one.default) > 1 else float
            option = typer.Option(f"--{one.name.replace('_', '-')}", **one.option)
            annotation = Annotated[kind | None, option]  # type: ignore[valid-type]
            options.append(as_json.replace(name=one.name, default=None, annotation=annotation))
    command.__signature__ = signature.replace(parameters=[*stated, *options, as_json])  # type: ignore[attr-defined]
    return command


@app.command()
@with_parameters
def translate(
    engine: Annotated[str, typer.Argument(help="box2d, bullet, pybullet, mujoco, yade, opensees; spring.")],
    mass: Annotated[
        float | None, typer.Option("--mass", help="Effective mass m: of a body, or m1 m2/(m1 + m2).", metavar="KG")
    ] = None,
    block_mass: Annotated[
        float | None,
        typer.Option("--block-mass", help="Instead: of a DDA block; the contact feels a quarter.", metavar="KG"),
    ] = None,
    step: Annotated[float | None, typer.Option("--step", help="Step (substep) of the engine.", metavar="S")] = None,
    gravity: Annotated[float, typer.Option("--gravity", help="Of the weight at rest.", metavar="M/S2")] = 9.81,
    points: Annotated[int, typer.Option("--points", help="Contact points that share the body.", min=1)] = 1,
    box: Annotated[
        str | None, typer.Option("--box", help="Box2D: sides of a flat box on two points.", metavar="WIDTH,HEIGHT")
    ] = None,
    static: Annotated[bool, typer.Option("--static", help="Box2D: on a static body.")] = False,
    as_json: JsonOption = False,
    **parameters: Any,
) -> None:
    """Translate a contact of another program to spring, dashpot and restitution, and into the others' words.

    Without a parameter the program is taken as it comes: [bold]dda-validate translate mujoco --mass 2700[/bold]

    Example: [bold]dda-validate translate box2d --hertz 30 --damping-ratio 10 --step 0.0041666667 --mass 2700[/bold]

    Example: [bold]dda-validate translate mujoco --timeconst 0.02 --dampratio 1 --mass 2700[/bold]

    Back: [bold]dda-validate translate spring --stiffness 1e8 --restitution 0.5 --mass 2700 --step 0.001[/bold]
    """
    from validation.advice import engines

    stated = {name: value for name, value in parameters.items() if value is not None}
    if "solimp" in stated:
        stated["solimp"] = _numbers("--solimp", stated["solimp"])
    translation = engines.translate(
        engine,
        mass=mass,
        block_mass=block_mass,
        step=step,
        gravity=gravity,
        points=points,
        box=_numbers("--box", box),
        static=static,
        **stated,
    )
    echo_answer(translation.as_dict(), _lines(translation), as_json)


def _numbers(option: str, text: str | None) -> tuple[float, ...] | None:
    """Return the numbers of a list with commas."""
    from validation.errors import InputError

    try:
        return None if text is None else tuple(map(float, text.split(",")))
    except ValueError:
        raise InputError("must be numbers with commas between", field=option, value=repr(text)) from None


def _lines(t: Translation) -> Iterator[str]:
    """Yield a translation: the spring, what it does, and the other engines' parameters."""
    facts = [
        ("effective mass", f"{t.mass:.6g} kg"),
        ("stiffness", f"k = {t.stiffness:.6g} N/m, w = {t.frequency:.6g} rad/s"),
        ("dashpot", f"c = {t.damping:.6g} N s/m, damping ratio zeta = {t.damping_ratio:.6g}"),
        ("restitution", f"e = {t.restitution:.6g} (exact in time, unloaded, no tension)"),
        ("penetration at rest", f"{1e3 * t.rest_penetration:.6g} mm under {t.weight:.6g} N"),
    ]
    if t.determinant is not None:
        facts.append(("a closed step", f"w h = {t.omega_step:.6g}, determinant {t.determinant:.7g}"))
    if t.rebound is not None:
        facts.append(("rebound of the steps", spread(t.rebound)))
    if t.numerical_ratio is not None:
        facts.append(("damping of the steps", f"{100 * t.numerical_ratio:.4g} % of critical"))
    for name, form in t.forms.items():
        facts.append((PREFIXES[name], settings_text(form)))
    facts.append(("scene, two corners", settings_text(t.scene)))
    yield columns(facts)
    for note in t.notes:
        yield broken(f"note: {note}")
