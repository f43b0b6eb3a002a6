"""Tables: a row a gate, what solvers differ by where nothing is judged, what changed between two runs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from validation.cli.printing.answer import finished_cases, how_it_ended
from validation.cli.printing.output import broken, echo
from validation.gates.gate import Verdict
from validation.report.blocks import Blocks, Listing, Paragraph, Table, TableColumn, table
from validation.report.scene.differences import DIFFERENCES, difference_table
from validation.runs.case_name import CaseName
from validation.runs.numbers import band_text, measured_text
from validation.runs.records import AlarmRecord, BaselineVerdict, ComparisonRecord, VerdictRecord
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.runs.text import printable

if TYPE_CHECKING:
    from validation.gates.changes import Change

LARGEST_AGREEMENT = 0.5  # relative difference (L2) from which two histories share less than half of the motion
PAIRS_SHOWN = 20


def verdict_table(verdicts: Sequence[Verdict], results: Results, studies: Sequence[str]) -> Table:
    """Return a row a gate: verdict, scene, pair, metric, value, band, seconds of its first case."""
    cases = finished_cases(results, studies)
    seconds = {(scene, solver): sum(row.seconds.values()) for scene, solver, row in cases}
    name = _namer([v.gate.scene for v in verdicts])
    lines = []
    for v in verdicts:
        case_seconds = seconds.get(v.gate.cases[0])
        lines.append(
            (
                printable(name(v.gate.scene)),
                " | ".join(v.gate.pair),
                v.gate.id.rpartition(":")[2],
                measured_text(v.value),
                band_text((v.gate.low, v.gate.high)),
                str(v.status),
                "" if case_seconds is None else f"{case_seconds:.2f}",
            )
        )
    seconds_column = TableColumn("seconds", "decimal")
    return table(("scene", "pair", "metric", _numbers("value"), _numbers("band"), "verdict", seconds_column), lines)


def _numbers(title: str) -> TableColumn:
    return TableColumn(title, "decimal")


def _namer(cases: Iterable[str]) -> Callable[[str], str]:
    """Return the function that names cases: by what is varied alone, where all are of one scene."""
    parsed = {case: CaseName.parse(case) for case in cases}
    alone = len({name.scene for name in parsed.values()}) == 1

    def name(case: str) -> str:
        values = parsed[case].values
        return ",".join(f"{key}={value}" for key, value in values.items()) if alone and values else case

    return name


def difference_blocks(results: Results, study: str, writable: bool) -> Blocks:
    """Return what the solvers of a scene without gates differ by, and what to write so that it is judged."""
    compared = results.manifest(study)["comparisons"]
    if not compared:
        return [Paragraph(_without_comparison(outcomes(results, study)))]
    differences = difference_table(compared[:PAIRS_SHOWN], _namer(c["scene"] for c in compared))
    if not differences.rows:
        text = "next: no metric is of the columns of this scene; dda-validate report draws the histories"
        return [Paragraph(text)]
    more = len(compared) - PAIRS_SHOWN
    note = (f"and {more} more pairs; dda-validate report shows all",) if more > 0 else ()
    proposal = "\n".join(_next(compared, results.manifest(study)["alarms"], writable))
    return [replace(differences, notes=note), Listing(proposal)]


def _without_comparison(ended: Mapping[tuple[str, str], Outcome]) -> str:
    """Return what to do with a scene whose solvers cannot be compared."""
    if len({solver for _, solver in ended}) < 2:
        return 'next: name two solvers or more that apply to the scene, such as solvers = ["dda", "bar"] under [run]'
    completed = sum(outcome is Outcome.COMPLETED for outcome in ended.values())
    return (
        f"next: only runs that complete are compared, and {completed} of {len(ended)} did: --verbose shows how each "
        "one ended"
    )


def _next(compared: Sequence[ComparisonRecord], alarms: Sequence[AlarmRecord], writable: bool) -> Iterator[str]:
    """Yield the lines of a gate for a scene that nothing has judged; of none where the step makes the agreement."""
    from validation.advice.coarse import KINDS

    metric = next(iter(DIFFERENCES))
    agreeing = [c for c in compared if _agrees(c["metrics"].get(metric))]
    if not agreeing:
        limit = f"{100 * LARGEST_AGREEMENT:g} % ({metric})"
        yield f"next: no pair agrees within {limit}, which is a finding and no tolerance:"
        yield "  look at the histories (dda-validate report), refine time.step and fem.elements, then write a gate"
        return
    coarse = {record["scene"]: record for record in reversed(alarms) if record["kind"] in KINDS}
    resolved = [c for c in agreeing if c["scene"] not in coarse]
    if not resolved:
        alarm = coarse[agreeing[0]["scene"]]
        yield broken(f"next: a smaller time.step before a gate, which would pass by the step ({alarm['kind']}):")
        yield broken(f"  {printable(alarm['scene'])}: {alarm['sentence']}")
        return
    first = resolved[0]
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


def _agrees(value: object) -> bool:
    """Whether a difference may be what a user tolerates; one that is not measured says nothing against it."""
    return not isinstance(value, float | int) or value < LARGEST_AGREEMENT


def outcomes(results: Results, study: str) -> dict[tuple[str, str], Outcome]:
    """Return how the cases of a study ended, by (scene, solver)."""
    rows = results.rows()
    return {(c["scene"], c["solver"]): rows[c["key"]].outcome for c in results.whole(study)["cases"]}


def print_ends(results: Results, studies: list[str]) -> None:
    """Name the cases that did not complete, and how they ended; what a solver says of several ones it says once."""
    scenes: dict[tuple[str, Outcome, tuple[str, ...]], list[str]] = {}
    for scene, solver, row in finished_cases(results, studies):
        if row.outcome is not Outcome.COMPLETED:
            scenes.setdefault((solver, row.outcome, row.notes), []).append(scene)
    for (solver, outcome, notes), names in scenes.items():
        echo(how_it_ended(names[0] if len(names) == 1 else f"{len(names)} cases", solver, outcome, notes))


def after_run(
    records: list[VerdictRecord],
    studies: Sequence[str],
    summary: Path | None,
    baseline: Sequence[BaselineVerdict] | None,
) -> list[Change] | None:
    """Write the summary; return what changed since the baseline in the studies, None without a baseline."""
    from validation.gates.changes import against, markdown
    from validation.runs.files import write_text

    since = None if baseline is None else against(baseline, records, studies)
    if summary is not None:
        # without lone surrogates, which no encoding takes
        write_text(summary, markdown(records, since).encode("utf-8", "backslashreplace").decode())
    return since


def change_blocks(changes: Sequence[Change]) -> Blocks:
    """Return what changed: change, study, gate, verdict and value before and after."""
    if not changes:
        return [Paragraph("no gate differs")]
    rows = []
    for c in changes:
        sides = ((c.before, c.value_before), (c.after, c.value_after))
        values = [f"{word} {measured_text(value)}" for word, value in sides]
        if c.rebanded:
            bands = (band_text(band) for band in (c.band_before, c.band_after))
            values = [f"{value} in {band}" for value, band in zip(values, bands, strict=True)]
        rows.append((c.kind, c.study, c.id, *values))
    counts = ", ".join(f"{count} {kind}" for kind, count in Counter(c.kind for c in changes).items())
    many = "1 gate differs" if len(changes) == 1 else f"{len(changes)} gates differ"
    return [table(("change", "study", "gate", "before", "after"), rows), Paragraph(f"{many}: {counts}")]
