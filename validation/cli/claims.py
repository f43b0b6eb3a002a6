"""The command ``claims``: a register of statements with their verdicts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import RESULTS, JsonOption, ResultsOption, app, writable
from validation.cli.printing.output import echo, echo_json


@app.command()
def claims(
    of: Annotated[str, typer.Option("--of", help="Whose: paper or literature.", metavar="NAME")] = "paper",
    out: Annotated[
        Path | None, typer.Option("--out", help="Write the register as Markdown.", metavar="FILE", callback=writable)
    ] = None,
    as_json: JsonOption = False,
    results: ResultsOption = RESULTS,
) -> None:
    """List statements with their verdicts: the paper's, or those of other publications on schemes and contacts.

    Example: [bold]dda-validate run paper && dda-validate claims[/bold]

    Example: [bold]dda-validate run literature && dda-validate claims --of literature[/bold]
    """
    from validation.advice.limits import check_choice
    from validation.errors import InputError
    from validation.runs.files import write_atomically
    from validation.runs.results import Results
    from validation.suite.claims import REGISTER, entries, page
    from validation.suite.folders import register_of, studies_with_registers

    check_choice("--of", of, studies_with_registers())
    register = register_of(of)
    rows = [row for row in Results(results).manifest(of).get("derived", []) if row["scene"] == REGISTER]
    if not rows:
        raise InputError(f"no results of the study {of}", source=results, advice=f"run it first: dda-validate run {of}")
    listed = entries(register, rows)
    if as_json:
        echo_json(listed)
    else:
        for claim in listed:
            echo(f"{claim['id']:<4} {claim['verdict'] or 'not run':<27} {claim['says']} [{claim['place']}]")
    if out is not None:
        text = page(register, rows)
        write_atomically(out, lambda stream: stream.write(text.encode()))
