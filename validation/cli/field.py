"""The command ``field``: the site of all submitted answers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import _progress, app
from validation.cli.judging import all_defects, judged_sets
from validation.cli.printing.output import echo


@app.command()
def field(
    source: Annotated[
        Path,
        typer.Option("--from", help="Directory of submissions, PROGRAM/VERSION/SETTINGS below it.", metavar="DIR"),
    ] = Path("submissions"),
    out: Annotated[Path, typer.Option(help="Directory to write, or an earlier site to replace.", metavar="DIR")] = Path(
        "reports/submissions"
    ),
) -> None:
    """Judge all submitted answers and write them as a static site: a table, a page a program, badges, verdicts.json.

    Answers come into such a directory by dda-validate judge FOLDER --keep DIR. What is wrong with a file is listed with
    file, line and character, and nothing is written. A failing answer takes some seconds, in which its cause is looked
    for. Verdicts leave the exit status alone: 0 written, 2 bad input.

    Example: [bold]dda-validate field --from submissions --out site[/bold]
    """
    from validation.gallery.answers import write_site
    from validation.problems.answers import read_sets

    with all_defects(), _progress("field", between_calls=True) as progress:
        sets = read_sets(source, in_layout=True, progress=progress)
        page = write_site(judged_sets(sets, progress), out, progress)
    echo(f"wrote {page}: {len(sets)} folder{'s' if len(sets) > 1 else ''} of answers")
