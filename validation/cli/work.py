"""The command ``rows``: a study's rows as a table."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import RESULTS, ResultsOption, app, writable
from validation.cli.printing.output import echo

StudyArgument = Annotated[str, typer.Argument(help="A study or scene with results in the results directory.")]


@app.command()
def rows(
    study: StudyArgument,
    out: Annotated[
        Path, typer.Option("--csv", help="CSV file to write.", metavar="FILE.csv", callback=writable)
    ] = Path("rows.csv"),
    results: ResultsOption = RESULTS,
) -> None:
    """Write every number of a study as one tidy CSV table: metrics, work, seconds, differences, what is derived.

    A line has study, scene, case, the values that are swept, solver (or the name of a derived row), reference and
    window of a comparison, metric, value and unit.

    Example: [bold]dda-validate run figures-3-4 && dda-validate rows figures-3-4 --csv rows.csv[/bold]
    """
    from validation.engine.table import lines, tidy
    from validation.errors import InputError
    from validation.runs.files import csv_text, write_text
    from validation.runs.results import Results

    store = Results(results)
    if study not in store.studies():
        raise InputError(f"no results in {results}", source=study, advice=f"run it first: dda-validate run {study}")
    table = lines(list(tidy(store, store.whole(study))))
    columns = list(dict.fromkeys(itertools.chain.from_iterable(table)))
    write_text(out, csv_text([columns, *([line.get(column, "") for column in columns] for line in table)]))
    echo(f"wrote {out}: {len(table)} rows, {len(columns)} columns")
