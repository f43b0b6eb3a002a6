"""The command ``translate``: soft constraints of physics engines as spring and dashpot, and back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import typer

from validation.cli.app import JsonOption, app
from validation.cli.printing.output import broken, columns, echo_answer, settings_text, spread

if TYPE_CHECKING:
    from validation.advice.engines import Translation

PREFIXES = {"box2d": "Box2D", "bullet": "Bullet", "pybullet": "PyBullet", "mujoco": "MuJoCo"}


@app.command()
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
    hertz: Annotated[float | None, typer.Option("--hertz", help="Box2D: frequency.", metavar="HZ")] = None,
    damping_ratio: Annotated[float | None, typer.Option("--damping-ratio", help="Box2D: damping ratio.")] = None,
    erp: Annotated[float | None, typer.Option("--erp", help="Bullet: error reduction.")] = None,
    cfm: Annotated[float | None, typer.Option("--cfm", help="Bullet: constraint force mixing.")] = None,
    timeconst: Annotated[float | None, typer.Option("--timeconst", help="MuJoCo: solref[0].", metavar="S")] = None,
    dampratio: Annotated[float | None, typer.Option("--dampratio", help="MuJoCo: solref[1].")] = None,
    dmax: Annotated[float | None, typer.Option("--dmax", help="MuJoCo: constant impedance; 0.95.")] = None,
    solimp: Annotated[
        str | None, typer.Option("--solimp", help="MuJoCo: dmin,dmax,width,midpoint,power.", metavar="NUMBERS")
    ] = None,
    contact_stiffness: Annotated[
        float | None, typer.Option("--contact-stiffness", help="PyBullet: of a point.", metavar="N/M")
    ] = None,
    contact_damping: Annotated[
        float | None, typer.Option("--contact-damping", help="PyBullet: of a point.", metavar="NS/M")
    ] = None,
    normal_stiffness: Annotated[
        float | None, typer.Option("--normal-stiffness", help="Yade: kn.", metavar="N/M")
    ] = None,
    local_damping: Annotated[
        float | None, typer.Option("--local-damping", help="Yade: NewtonIntegrator.damping.")
    ] = None,
    penalty: Annotated[float | None, typer.Option("--penalty", help="OpenSees: k_n of a point.", metavar="N/M")] = None,
    stiffness: Annotated[float | None, typer.Option("--stiffness", help="Spring: k.", metavar="N/M")] = None,
    damping: Annotated[float | None, typer.Option("--damping", help="Spring: c.", metavar="NS/M")] = None,
    restitution: Annotated[
        float | None, typer.Option("--restitution", help="Spring: e, in place of --damping.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Translate a contact of another program to spring, dashpot and restitution, and into the others' words.

    Without a parameter the program is taken as it comes: [bold]dda-validate translate mujoco --mass 2700[/bold]

    Example: [bold]dda-validate translate box2d --hertz 30 --damping-ratio 10 --step 0.0041666667 --mass 2700[/bold]

    Example: [bold]dda-validate translate mujoco --timeconst 0.02 --dampratio 1 --mass 2700[/bold]

    Back: [bold]dda-validate translate spring --stiffness 1e8 --restitution 0.5 --mass 2700 --step 0.001[/bold]
    """
    from validation.advice import engines

    stated = {
        "hertz": hertz,
        "damping_ratio": damping_ratio,
        "erp": erp,
        "cfm": cfm,
        "timeconst": timeconst,
        "dampratio": dampratio,
        "dmax": dmax,
        "solimp": _numbers("--solimp", solimp),
        "contact_stiffness": contact_stiffness,
        "contact_damping": contact_damping,
        "normal_stiffness": normal_stiffness,
        "local_damping": local_damping,
        "penalty": penalty,
        "stiffness": stiffness,
        "damping": damping,
        "restitution": restitution,
    }
    translation = engines.translate(
        engine,
        mass=mass,
        block_mass=block_mass,
        step=step,
        gravity=gravity,
        points=points,
        box=_numbers("--box", box),
        static=static,
        **{name: value for name, value in stated.items() if value is not None},
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
