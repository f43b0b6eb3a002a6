"""The command ``rows``: a study's rows as a table."""

from __future__ import annotations

import csv
import io
import itertools
from pathlib import Path
from typing import Annotated, Any

import typer

from validation.cli.app import RESULTS, ResultsOption, app, writable
from validation.cli.printing.output import echo

StudyArgument = Annotated[str, typer.Argument(help="A study or scene with results in the results directory.")]


def _table(study: str, results: Path) -> list[dict[str, Any]]:
    from validation.errors import InputError
    from validation.runs.results import Results
    from validation.runs.table import table

    store = Results(results)
    if study not in store.studies():
        raise InputError(f"no results in {results}", source=study, advice=f"run it first: dda-validate run {study}")
    return table(store, store.whole(study))


@app.command()
def rows(
    study: StudyArgument,
    out: Annotated[
        Path, typer.Option("--csv", help="CSV file to write.", metavar="FILE.csv", callback=writable)
    ] = Path("rows.csv"),
    results: ResultsOption = RESULTS,
) -> None:
    """Write every row of a study as CSV: what was run, metrics, work, seconds and differences from references.

    Example: [bold]dda-validate run figures-3-4 && dda-validate rows figures-3-4 --csv rows.csv[/bold]
    """
    from validation.runs.files import write_atomically

    lines = _table(study, results)
    names = list(dict.fromkeys(itertools.chain.from_iterable(lines)))
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)
    write_atomically(out, lambda stream: stream.write(text.getvalue().encode()))
    echo(f"wrote {out}: {len(lines)} rows, {len(names)} columns")
