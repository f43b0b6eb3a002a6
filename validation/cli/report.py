"""Commands that render: ``report`` and ``figures``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from validation.runs.results import Results

from validation.cli.app import RESULTS, ResultsOption, _progress, app
from validation.cli.printing.output import echo


@app.command()
def report(
    out: Annotated[Path, typer.Option(help="PDF file to write.", metavar="FILE.pdf")] = Path("reports/report.pdf"),
    appendix: Annotated[
        bool, typer.Option("--appendix", help="List the gates that passed, by the reason of their band.")
    ] = False,
    results: ResultsOption = RESULTS,
) -> None:
    """Write the PDF report: a chapter for each study in the results directory; nothing is computed.

    Example: [bold]dda-validate report --out report.pdf[/bold]
    """
    from validation.errors import InputError
    from validation.report.book import build
    from validation.runs.results import Results

    if out.suffix.lower() != ".pdf":
        raise InputError("must end in .pdf", field="--out", value=repr(str(out)))
    store = Results(results)
    with _progress("report", between_calls=True):
        page = build(store, out, appendix)
    print_unread(store)
    echo(f"wrote {page}")


def print_unread(results: Results) -> None:
    """Say which studies this version cannot read, and why."""
    from validation.report.book import ordered_studies, unread_studies

    for study, reason in unread_studies(results, ordered_studies(results)).items():
        echo(f"note: {study} is left out: {reason}", err=True)


@app.command()
def figures(
    study: Annotated[str, typer.Argument(help="A study or scene with results in the results directory.")],
    out: Annotated[Path, typer.Option(help="Directory for the SVG and PNG files.", metavar="DIR")] = Path("figures"),
    results: ResultsOption = RESULTS,
) -> None:
    """Write a study's figures as SVG and PNG.

    Example: [bold]dda-validate run figures-3-4 && dda-validate figures figures-3-4 --out figures[/bold]
    """
    from validation.report.book import figures as write_figures
    from validation.runs.results import Results

    for path in write_figures(study, Results(results), out):
        echo(f"wrote {path}")
