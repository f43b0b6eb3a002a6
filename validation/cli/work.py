"""The commands ``rows`` and ``record``: a study's rows as a table, and the record of errors and work."""

from __future__ import annotations

import csv
import io
import itertools
from pathlib import Path
from typing import Annotated, Any

import typer

from validation.cli.app import GATE_FAILED, RESULTS, ResultsOption, _progress, app, writable
from validation.cli.printing.output import echo
from validation.cli.signals import promise_rows

StudyArgument = Annotated[str, typer.Argument(help="A study or scene with results in the results directory.")]


def _table(study: str, results: Path) -> list[dict[str, Any]]:
    from validation.errors import InputError
    from validation.runs.results import Results
    from validation.studies.work.points import table

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


@app.command()
def record(
    update: Annotated[bool, typer.Option("--update-record", help="Replace the committed record by this run.")] = False,
    reason: Annotated[
        str, typer.Option(help="Why the record changes; required with --update-record.", metavar="TEXT")
    ] = "",
    results: ResultsOption = RESULTS,
) -> None:
    """Run the study work-precision and compare its errors and work counts with the committed record.

    Example: [bold]dda-validate record[/bold] or, by intent, [bold]dda-validate record --update-record --reason
    "fewer Krylov vectors"[/bold]
    """
    from validation.engine.run import finish
    from validation.errors import InputError
    from validation.runs.results import Results
    from validation.studies.work import record as work_record
    from validation.studies.work.study import WORK_PRECISION, study_cases

    if update and not reason.strip():
        raise InputError(
            "must say why the record changes", field="--reason", value="nothing", advice='add --reason "..."'
        )
    recorded = {} if update else work_record.load()["cases"]  # before the runs: without a record they are for nothing
    promise_rows()
    with _progress(WORK_PRECISION.name, between_calls=True) as progress:
        finished = finish(WORK_PRECISION.cases(), WORK_PRECISION, Results(results), progress=progress)
    if update:
        work_record.update(finished, study_cases(), reason)
        echo(f"wrote {work_record.PATH}")
        return
    try:
        ratios = work_record.compare(finished, study_cases(), recorded)
    except ValueError as error:
        raise InputError(str(error), source=work_record.PATH) from None
    listed_ratios = ", ".join(f"{part} {value:.3f}" for part, value in ratios.items())
    echo(f"worst ratio to the record: {listed_ratios}")
    if not all(value <= 1 + work_record.SLACK[part] for part, value in ratios.items()):
        raise typer.Exit(GATE_FAILED)
