"""Commands for other people's CI and codes: differences of verdicts, the reference pack."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from validation.cli.app import GATE_FAILED, PASSED, _progress, app
from validation.cli.printing.output import echo

PARTS = 5  # of a pack


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
    """Write a reference pack for codes in any language: scenes, exact histories as CSV, bands, problems to answer.

    Example: [bold]dda-validate export-pack pack[/bold]
    """
    from validation.problems.pack import write_problems
    from validation.runs.files import atomic_directory
    from validation.studies.contact.pack import write_contact_pack
    from validation.studies.contact.slipping_pack import write_slipping_pack
    from validation.studies.pack import check_place, write_pack
    from validation.studies.waves.pack import write_waves_pack

    check_place(directory)
    with atomic_directory(directory) as place, _progress("export-pack", between_calls=True) as progress:
        progress(0, PARTS, "scenes, histories and bands")
        written = write_pack(place)
        progress(1, PARTS, "contact that opens")
        numbers = write_contact_pack(place)
        progress(2, PARTS, "waves")
        waves = write_waves_pack(place)
        progress(3, PARTS, "contact that slips")
        slipping = write_slipping_pack(place)
        progress(4, PARTS, "problems")
        problems = write_problems(
            place, lambda number, of, name: progress(4, PARTS, f"problem {name}, {number} of {of}")
        )
    counts = f"{written.scenes} scenes, {written.histories} histories, {written.bands} bands"
    exact = f"of contact that opens {numbers} exact numbers, of contact that slips {slipping}, of waves {waves}"
    echo(f"wrote {directory}: {counts}; {exact}; {problems} problems for any program")
