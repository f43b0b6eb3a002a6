"""What `run` prints: verdicts, alarms, and cases that did not complete."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from validation.advice.alarms import DISCOUNT
from validation.cli.output import console
from validation.gates.gate import Verdict, said
from validation.runs.records import ComparisonRecord, Judged, VerdictRecord
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.runs.text import printable

if TYPE_CHECKING:
    from validation.gates.changes import Change

DIFFERENCES = ("displacement.l2", "displacement.max", "pressure.l2", "pressure.max")  # shown where nothing is judged
MOST = 20  # pairs that are shown


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
        spent = seconds.get(g.cases[0])
        table.add_row(
            escape(printable(g.scene)),
            " | ".join(g.pair),
            g.id.rpartition(":")[2],
            said(v.value),
            f"{g.low:.4g} .. {g.high:.4g}",
            f"[{colours[word]}]{word}[/]",
            "" if spent is None else f"{spent:.2f}",
        )
    printer = console()
    printer.print(table)
    for v in verdicts:
        if v.status != "PASS":
            printer.print(printable(f"{v.status}: {v.gate.id}: {v.why or v.gate.reason}"), markup=False)
    words = [str(v.status) for v in verdicts]
    printer.print(", ".join(f"{words.count(w)} {w}" for w in colours))


def print_differences(results: Results, study: str, writable: bool) -> None:
    """Print what the solvers of a scene without gates differ by, and what to write so that it is judged."""
    compared = results.manifest(study)["comparisons"]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("scene", "solver", "differs from"):
        table.add_column(name, overflow="fold")
    for metric in DIFFERENCES:
        table.add_column(f"{metric} [%]", justify="right")
    for c in compared[:MOST]:
        values = [c["metrics"].get(metric) for metric in DIFFERENCES]
        shown = [f"{100 * v:.3g}" if isinstance(v, float | int) else str(v) for v in values]
        table.add_row(*map(escape, map(printable, (c["scene"], c["solver"], c["reference"]))), *shown)
    printer = console()
    if compared:
        printer.print(table)
    if len(compared) > MOST:
        printer.print(f"and {len(compared) - MOST} more pairs; dda-validate report shows all", markup=False)
    for line in _next(compared, writable):
        typer.echo(line)


def _next(compared: Sequence[ComparisonRecord], writable: bool) -> Iterator[str]:
    """Yield what to do with a scene that nothing has judged: the lines of a gate, or why there can be none yet."""
    if not compared:
        yield 'next: name two solvers or more in the scene, such as solvers = ["dda", "bar"] under [run]'
        return
    first, metric = compared[0], DIFFERENCES[0]
    value = first["metrics"].get(metric)
    place = "at the end of the scene file" if writable else "in a scene file of your own with these values"
    yield f"next: write {place} what you tolerate, with your reason, and run it again:"
    yield "  [[gate]]"
    yield f'  pair = ["{first["solver"]}", "{first["reference"]}"]'
    yield f'  metric = "{metric}"'
    if isinstance(value, float) and value > 0:
        size = 10.0 ** math.floor(math.log10(value))
        yield f"  band = [0.0, {math.ceil(value / size) * size:.1g}]  # {value:.3g} here"
    else:
        yield "  band = [0.0, 0.1]"
    yield '  reason = "..."'
    yield "dda-validate list metrics names what can be bounded, dda-validate report draws the histories"


def outcomes(results: Results, study: str) -> dict[tuple[str, str], Outcome]:
    """Return how the cases of a study ended, by (scene, solver)."""
    rows = results.rows()
    return {(c["scene"], c["solver"]): rows[c["key"]].outcome for c in results.whole(study)["cases"]}


def print_failures(results: Results, studies: list[str]) -> bool:
    """Name the cases that did not complete; return whether one was refused."""
    rows, refused = results.rows(), False
    for study in studies:
        for case in results.manifest(study)["cases"]:
            row = rows[case["key"]]
            refused = refused or row.outcome is Outcome.REFUSED
            if row.outcome is not Outcome.COMPLETED:
                said = f"{row.outcome}: {row.outcome.sentence} {'; '.join(row.notes)}"
                typer.echo(printable(f"{case['scene']} {case['solver']}: {said}"))
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


def after_run(
    records: list[VerdictRecord], studies: Sequence[str], summary: Path | None, baseline: Sequence[Judged] | None
) -> list[Change] | None:
    """Write the summary; return what changed since the baseline in the studies, None without a baseline."""
    from validation.gates.changes import against, markdown
    from validation.runs.files import write_atomically

    since = None if baseline is None else against(baseline, records, studies)
    if summary is not None:
        text = printable_lines(markdown(records, since))
        write_atomically(summary, lambda stream: stream.write(text.encode()))
    return since


def printable_lines(text: str) -> str:
    """Return lines without lone surrogates, which no encoding takes."""
    return text.encode("utf-8", "backslashreplace").decode()


def print_changes(found: list[Change]) -> None:
    """Print one table: change, study, gate, verdict and value before and after."""
    from validation.gates.changes import band_said

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("change", "study", "gate", "before", "after"):
        table.add_column(name, overflow="fold")
    colours = {"worse": "bold red", "better": "green"}
    for c in found:
        values = [f"{word} {said(value)}" for word, value in ((c.before, c.value_before), (c.after, c.value_after))]
        if c.rebanded:
            bands = (band_said(band) for band in (c.band_before, c.band_after))
            values = [f"{value} in {band}" for value, band in zip(values, bands, strict=True)]
        kind = f"[{colours.get(c.kind, 'default')}]{c.kind}[/]"
        table.add_row(kind, *map(escape, (c.study, c.id, *values)))
    printer = console()
    if found:
        printer.print(table)
    kinds = [c.kind for c in found]
    words = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    printer.print(f"{len(found)} gates differ: {words}" if found else "no gate differs", markup=False)
