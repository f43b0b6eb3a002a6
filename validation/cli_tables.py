"""What `run` prints: verdicts, alarms, and cases that did not complete."""

from __future__ import annotations

import sys

import typer
from rich import box
from rich.console import Console
from rich.table import Table

from validation.alarms import DISCOUNT
from validation.gates import Verdict, said
from validation.history import Outcome
from validation.results import Results


def print_verdicts(verdicts: list[Verdict], results: Results, studies: list[str]) -> None:
    """Print one table: scene, pair, metric, value, band, verdict, seconds."""
    rows = results.rows()
    cases = [case for study in studies for case in results.manifest(study)["cases"]]
    seconds = {(case["scene"], case["solver"]): sum(rows[case["key"]].seconds.values()) for case in cases}
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("scene", "pair", "metric"):
        table.add_column(name, overflow="fold")
    for name in ("value", "band"):
        table.add_column(name, justify="right")
    table.add_column("verdict")
    table.add_column("seconds", justify="right")
    colours = {"PASS": "green", "FAIL": "bold red", "NOT RUN": "yellow"}
    for v in verdicts:
        g, word = v.gate, str(v.status)
        spent = seconds.get((g.scene, g.pair[0]))
        table.add_row(
            g.scene.replace("[", r"\["),
            " | ".join(g.pair),
            g.id.rpartition(":")[2],
            said(v.value),
            f"{g.low:.4g} .. {g.high:.4g}",
            f"[{colours[word]}]{word}[/]",
            "" if spent is None else f"{spent:.2f}",
        )
    console = Console(width=None if sys.stdout.isatty() else 150)
    console.print(table)
    for v in verdicts:
        if v.status != "PASS":
            console.print(f"{v.status}: {v.gate.id}: {v.why or v.gate.reason}", markup=False)
    words = [str(v.status) for v in verdicts]
    console.print(", ".join(f"{words.count(w)} {w}" for w in colours))


def print_failures(results: Results, studies: list[str]) -> bool:
    """Name the cases that did not complete; return whether one was refused."""
    rows, refused = results.rows(), False
    for study in studies:
        for case in results.manifest(study)["cases"]:
            row = rows[case["key"]]
            refused = refused or row.outcome is Outcome.REFUSED
            if row.outcome is not Outcome.COMPLETED:
                typer.echo(
                    f"{case['scene']} {row.solver}: {row.outcome}: {row.outcome.sentence} {'; '.join(row.notes)}"
                )
    return refused


def print_alarms(results: Results, studies: list[str]) -> None:
    """Print how many cases each kind of alarm was raised on, and in full what concerns a whole scene."""
    cases: dict[str, set[str]] = {}
    for alarm in [alarm for study in studies for alarm in results.manifest(study).get("alarms", [])]:
        if alarm["kind"] == DISCOUNT:
            typer.echo(f"warning: {alarm['scene']}: {alarm['sentence']}", err=True)
        else:
            cases.setdefault(alarm["kind"], set()).add(alarm["scene"])
    if cases:
        said = ", ".join(f"{kind} in {len(some)} case{'s' * (len(some) > 1)}" for kind, some in cases.items())
        typer.echo(f"alarms: {said} (see the report)")
