"""Commands for other people's CI and codes: differences of verdicts, the reference pack."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import GATE_FAILED, PASSED, _progress, app
from validation.cli.printing.output import echo


@app.command()
def diff(
    before: Annotated[Path, typer.Argument(help="verdicts.json or a results directory.", metavar="A")],
    after: Annotated[Path, typer.Argument(help="verdicts.json or a results directory.", metavar="B")],
) -> None:
    """Compare the verdicts of two runs, one row for each gate that differs; exit 1 if one got worse.

    Example: [bold]dda-validate diff main/verdicts.json reports/results[/bold]
    """
    from validation.cli.printing.output import print_blocks, tolerate_closed_pipe
    from validation.cli.printing.tables import change_blocks
    from validation.gates.changes import changes, read_verdicts

    differences = changes(read_verdicts(before), read_verdicts(after))
    with tolerate_closed_pipe():
        print_blocks(change_blocks(differences))
    status = GATE_FAILED if any(change.worse for change in differences) else PASSED
    raise typer.Exit(status)


@app.command("export-pack")
def export_pack(
    directory: Annotated[
        Path, typer.Argument(help="Directory to write, or an earlier pack to replace.", metavar="DIR")
    ],
) -> None:
    """Write the reference pack for codes in any language: problems, exact motions as CSV, bands, folders to fill in.

    Example: [bold]dda-validate export-pack pack[/bold]
    """
    from validation.problems.pack import MARK, write_pack
    from validation.runs.files import atomic_directory, check_place

    check_place(directory, MARK, "pack")
    with atomic_directory(directory) as place, _progress("export-pack") as progress:
        problems = write_pack(place, progress)
    echo(f"wrote {directory}: {problems} problems for any program")
