"""The command ``new``: a scene file of one's own, from a few options or questions."""

from __future__ import annotations

import shlex
import sys
import tomllib
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
            help="block, slope (a block on an incline), column, beam, plate (with a hole), disc; of blocks that move "
            "stack, wall, arch, blocks-on-slope, pile.",
            metavar="KIND",
        ),
    ] = None,
    rock: Annotated[
        str | None, typer.Option("--rock", help="Typical values of a rock: granite, limestone, sandstone, ...")
    ] = None,
    width: Annotated[
        float | None,
        typer.Option("--width", help="Of a block; depth of a beam; span of an arch; diameter of a disc.", metavar="M"),
    ] = None,
    height: Annotated[
        float | None,
        typer.Option("--height", help="Of a block or a column; length of a beam; thickness of an arch.", metavar="M"),
    ] = None,
    hole: Annotated[float | None, typer.Option("--hole", help="Radius of the hole in a plate.", metavar="M")] = None,
    blocks: Annotated[
        int | None,
        typer.Option(
            "--blocks", help="How many move; rows of a wall; cells of a quarter of plate or disc.", metavar="N"
        ),
    ] = None,
    pressure: Annotated[
        float | None,
        typer.Option("--pressure", help="On a block's top, across a beam's end, on a disc; tension.", metavar="PA"),
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
    from validation.advice.draft import GLUED_BODIES, KINDS, MOVING, ROCKS, draft
    from validation.errors import InputError
    from validation.scenes.scene import parse_scene

    if path.suffix != ".toml":
        raise InputError("must end in .toml", source=path)
    if path.exists():
        raise InputError("is there already and is not overwritten", source=path)
    answers = {"kind": kind, "rock": rock, "width": width, "height": height}
    own = {"hole": hole, "blocks": blocks, "pressure": pressure, "slope": slope, "friction": friction}
    own["frequency"] = frequency
    if sys.stdin.isatty():
        answers["kind"] = kind or typer.prompt(f"Kind ({', '.join(KINDS)})", default="block")
        answers["rock"] = rock or typer.prompt(f"Rock ({', '.join(ROCKS)})", default="granite")
    text = draft({name: value for name, value in (answers | own).items() if value is not None}, _ask)
    parse_scene(tomllib.loads(text), str(path))  # numbers that do not go together are refused before a file is written
    try:
        with path.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise InputError("is there already and is not overwritten", source=path) from None
    word = "show" if answers["kind"] in (*MOVING, *GLUED_BODIES) else "advise"
    echo(f"wrote {path}\nnext: dda-validate {word} {shlex.quote(str(path))}")


def _ask(question: str, default: float) -> float:
    """Return the answer to a question on a terminal; elsewhere the default."""
    return float(typer.prompt(question, default=default, type=float)) if sys.stdin.isatty() else default
