"""The command ``gallery``: the results as a static site with calculators."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import RESULTS, ResultsOption, _progress, app
from validation.cli.printing.output import echo


@app.command()
def gallery(
    out: Annotated[
        Path, typer.Option(help="Directory to write, or an earlier gallery to replace.", metavar="DIR")
    ] = Path("reports/gallery"),
    results: ResultsOption = RESULTS,
    docs: Annotated[
        str,
        typer.Option(help="Folder of the documentation's pages, seen from the gallery; linked to.", metavar="ADDRESS"),
    ] = "",
) -> None:
    """Write the results as a static site: figures, histories to zoom, verdicts to filter, calculators.

    Example: [bold]dda-validate run core && dda-validate gallery --out gallery[/bold]

    It works from its files, without a network; open index.html. Nothing is computed.
    """
    from validation.cli.report import print_unread
    from validation.gallery.site import build, size
    from validation.runs.results import Results

    store = Results(results)
    with _progress("gallery") as progress:
        page = build(store, out, progress, docs.rstrip("/"))
    print_unread(store)
    echo(f"wrote {page} ({size(page.parent) / 1e6:.1f} MB in all)")
