"""The command ``claims``: the register of the paper's statements with their verdicts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import RESULTS, JsonOption, ResultsOption, app, writable
from validation.cli.printing.output import echo, echo_json


@app.command()
def claims(
    out: Annotated[
        Path | None, typer.Option("--out", help="Write the register as Markdown.", metavar="FILE", callback=writable)
    ] = None,
    as_json: JsonOption = False,
    results: ResultsOption = RESULTS,
) -> None:
    """List the paper's statements with their verdicts.

    Example: [bold]dda-validate run paper && dda-validate claims[/bold]
    """
    from validation.errors import InputError
    from validation.runs.files import write_text
    from validation.runs.results import Results
    from validation.suite.claims import REGISTER, entries, page
    from validation.suite.folders import register_of

    register = register_of("paper")
    rows = [row for row in Results(results).manifest("paper").get("derived", []) if row["scene"] == REGISTER]
    if not rows:
        advice = "run it first: dda-validate run paper"
        raise InputError("no results of the study paper", source=results, advice=advice)
    listed = entries(register, rows)
    if as_json:
        echo_json(listed)
    else:
        for claim in listed:
            echo(f"{claim['id']:<4} {claim['verdict'] or 'not run':<27} {claim['says']} [{claim['place']}]")
    if out is not None:
        write_text(out, page(register, rows))
