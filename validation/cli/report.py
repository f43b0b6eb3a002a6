"""The command ``report``: the results as PDF, as a site, as figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from validation.runs.results import Results

from validation.cli.app import RESULTS, ResultsOption, _progress, app
from validation.cli.printing.output import echo

PDF = Path("reports/report.pdf")


@app.command()
def report(
    studies: Annotated[
        list[str] | None,
        typer.Argument(help="Studies or scenes with results (default: all).", metavar="[STUDY]..."),
    ] = None,
    out: Annotated[Path | None, typer.Option(help=f"PDF file to write, by default {PDF}.", metavar="FILE.pdf")] = None,
    site: Annotated[
        Path | None,
        typer.Option(help="Write a static site instead: a new directory, or a site to replace.", metavar="DIR"),
    ] = None,
    figures: Annotated[
        Path | None, typer.Option(help="Write the figures instead, as SVG and PNG, into a directory.", metavar="DIR")
    ] = None,
    appendix: Annotated[
        bool,
        typer.Option(
            "--appendix",
            help="In the PDF, print what is verified, and list the gates that passed by the reason of their band.",
        ),
    ] = False,
    docs: Annotated[
        str,
        typer.Option(help="With --site: folder of the documentation's pages, seen from it.", metavar="ADDRESS"),
    ] = "",
    results: ResultsOption = RESULTS,
) -> None:
    """Write the results as PDF, as a site with calculators, or as figures; nothing is computed.

    A site works from its files, without a network; open index.html.

    Example: [bold]dda-validate report --out report.pdf[/bold] or [bold]dda-validate report figures-3-4 --figures
    figures[/bold]
    """
    from validation.errors import InputError
    from validation.runs import extras
    from validation.runs.results import Results

    if docs and site is None:
        raise InputError("goes with --site", field="--docs", value=repr(docs))
    if out is None and site is None and figures is None:
        out = PDF
    if out is not None and out.suffix.lower() != ".pdf":
        raise InputError("must end in .pdf", field="--out", value=repr(str(out)))
    for option, path, libraries in (
        ("--out", out, extras.PDF),
        ("--site", site, extras.SITE),
        ("--figures", figures, extras.PDF),
    ):
        if path is not None:
            extras.require(option, *libraries)
    from validation.report.book import build, write_figures

    store = Results(results)
    names = studies or None
    if out is not None:
        with _progress("report"):
            build(store, out, names, appendix)
        echo(f"wrote {out}")
    if site is not None:
        from validation.report.site import pages

        with _progress("site") as progress:
            first = pages.build(store, site, names, progress, docs.rstrip("/"))
        echo(f"wrote {first} ({pages.size(site) / 1e6:.1f} MB in all)")
    if figures is not None:
        for path in write_figures(store, figures, names):
            echo(f"wrote {path}")
    print_unread(store)


def print_unread(results: Results) -> None:
    """Say which studies this version cannot read, and why."""
    from validation.report.book import ordered_studies, unread_studies

    for study, reason in unread_studies(results, ordered_studies(results)).items():
        echo(f"note: {study} is left out: {reason}", err=True)
