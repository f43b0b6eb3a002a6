"""The command ``new``: a scene file of one's own, from a few options or questions."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import app
from validation.cli.printing.output import echo


@app.command()
def new(
    path: Annotated[Path, typer.Argument(help="File to write; one that is there is left alone.", metavar="FILE.toml")],
    kind: Annotated[
        str | None,
        typer.Option(
            "--kind",
            help="block, slope (a block on an incline), column, beam; of blocks that move stack, wall, arch, "
            "blocks-on-slope, pile.",
            metavar="KIND",
        ),
    ] = None,
    rock: Annotated[
        str | None, typer.Option("--rock", help="Typical values of a rock: granite, limestone, sandstone, ...")
    ] = None,
    width: Annotated[
        float | None, typer.Option("--width", help="Of a block; depth of a beam; span of an arch.", metavar="M")
    ] = None,
    height: Annotated[
        float | None,
        typer.Option("--height", help="Of a block or a column; length of a beam; thickness of an arch.", metavar="M"),
    ] = None,
    blocks: Annotated[int | None, typer.Option("--blocks", help="How many move; rows of a wall.", metavar="N")] = None,
    pressure: Annotated[
        float | None, typer.Option("--pressure", help="On the top of a block, across a beam's end.", metavar="PA")
    ] = None,
    slope: Annotated[float | None, typer.Option("--slope", help="Of an incline.", metavar="DEG")] = None,
    friction: Annotated[float | None, typer.Option("--friction", help="Of an incline.", metavar="DEG")] = None,
    frequency: Annotated[
        float | None, typer.Option("--frequency", help="Of the wave that comes up a column.", metavar="HZ")
    ] = None,
) -> None:
    """Write a scene of your own, with units and comments; on a terminal it asks for what no option says.

    Example: [bold]dda-validate new my-block.toml --kind block --rock granite --width 1.2 --height 1.2[/bold] or
    [bold]dda-validate new arch.toml --kind arch --rock limestone --width 8 --blocks 15[/bold]
    """
    from validation.advice.draft import KINDS, MOVING, ROCKS, draft
    from validation.errors import InputError

    if path.suffix != ".toml":
        raise InputError("must end in .toml", source=path)
    if path.exists():
        raise InputError("is there already and is not overwritten", source=path)
    answers = {"kind": kind, "rock": rock, "width": width, "height": height}
    own = {"blocks": blocks, "pressure": pressure, "slope": slope, "friction": friction, "frequency": frequency}
    if sys.stdin.isatty():
        answers["kind"] = kind or typer.prompt(f"Kind ({', '.join(KINDS)})", default="block")
        answers["rock"] = rock or typer.prompt(f"Rock ({', '.join(ROCKS)})", default="granite")
    text = draft({name: value for name, value in (answers | own).items() if value is not None}, _ask)
    try:
        with path.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise InputError("is there already and is not overwritten", source=path) from None
    word = "show" if answers["kind"] in MOVING else "advise"
    echo(f"wrote {path}\nnext: dda-validate {word} {shlex.quote(str(path))}")


def _ask(question: str, default: float) -> float:
    """Return the answer to a question on a terminal; elsewhere the default."""
    return float(typer.prompt(question, default=default, type=float)) if sys.stdin.isatty() else default
