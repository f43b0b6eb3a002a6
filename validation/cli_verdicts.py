"""Commands for other people's CI and codes: differences of verdicts, the reference pack."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from validation import cli

if TYPE_CHECKING:
    from validation.verdicts import Change


def after_run(records: list[dict[str, object]], summary: Path | None, baseline: Path | None) -> bool | None:
    """Write the summary and compare with the baseline; return whether something got worse, None without a baseline."""
    from validation.history import write_atomically
    from validation.verdicts import against, markdown

    since = None if baseline is None else against(baseline, records)
    if summary is not None:
        text = markdown(records, since)
        write_atomically(summary, lambda stream: stream.write(text.encode()))
    if since is None:
        return None
    _print_changes(since)
    return any(change.worse for change in since)


@cli.app.command()
def diff(
    before: Annotated[Path, typer.Argument(help="verdicts.json or a results directory.", metavar="A")],
    after: Annotated[Path, typer.Argument(help="verdicts.json or a results directory.", metavar="B")],
) -> None:
    """Compare the verdicts of two runs, one row for each gate that differs; exit 1 if one got worse.

    Example: [bold]dda-validate diff main/verdicts.json reports/results[/bold]
    """
    from validation.verdicts import changes, read_verdicts

    found = changes(read_verdicts(before), read_verdicts(after))
    _print_changes(found)
    raise typer.Exit(cli.GATE_FAILED if any(change.worse for change in found) else cli.PASSED)


def _print_changes(found: list[Change]) -> None:
    """Print one table: change, study, gate, verdict and value before and after."""
    from rich import box
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from validation.gates import said

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("change", "study", "gate", "before", "after"):
        table.add_column(name, overflow="fold")
    colours = {"worse": "bold red", "better": "green"}
    for c in found:
        values = (f"{word} {said(value)}" for word, value in ((c.before, c.value_before), (c.after, c.value_after)))
        table.add_row(f"[{colours.get(c.kind, 'default')}]{c.kind}[/]", c.study, escape(c.id), *values)
    console = Console(width=None if sys.stdout.isatty() else 150)
    if found:
        console.print(table)
    kinds = [c.kind for c in found]
    words = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    console.print(f"{len(found)} gates differ: {words}" if found else "no gate differs", markup=False)


@cli.app.command("export-pack")
def export_pack(
    directory: Annotated[Path, typer.Argument(help="Directory to make.", metavar="DIR")],
) -> None:
    """Write a reference pack: scenes, exact histories as CSV, bands and a README, for codes in any language.

    Example: [bold]dda-validate export-pack pack[/bold]
    """
    from validation.pack import write_pack

    written = write_pack(directory)
    typer.echo(f"wrote {directory}: {written.scenes} scenes, {written.histories} histories, {written.bands} bands")
