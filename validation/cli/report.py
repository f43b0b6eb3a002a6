"""Commands that render: ``report`` and ``figures``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import RESULTS, ResultsOption, app
from validation.cli.printing.output import echo


@app.command()
def report(
    out: Annotated[Path, typer.Option(help="PDF file to write.", metavar="FILE.pdf")] = Path("reports/report.pdf"),
    results: ResultsOption = RESULTS,
) -> None:
    """Write the PDF report: a chapter for each study in the results directory; nothing is computed.

    Example: [bold]dda-validate report --out report.pdf[/bold]
    """
    from validation.errors import InputError
    from validation.report.book import build
    from validation.runs.results import Results

    if out.suffix.lower() != ".pdf":
        raise InputError(f"--out: must end in .pdf, got {str(out)!r}")
    echo(f"wrote {build(Results(results), out)}")


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
