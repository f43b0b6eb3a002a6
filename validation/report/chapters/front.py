"""The first page (conclusion, verdicts, error ledger) and the last (provenance)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from validation.report.blocks import Block, Callout, Column, Heading, Paragraph, Table, columns
from validation.report.chapters.data import Group, groups
from validation.report.chapters.gates import ORDER, band, under_headings, value_cell
from validation.report.chapters.ledger import OPENING_PARTS, ledger_lines, ledger_table, part_values, with_entries
from validation.report.chapters.registry import CHAPTERS
from validation.report.chapters.scene import gate_count
from validation.report.chapters.text import percent, plain, span
from validation.report.figures import histories
from validation.runs.case_name import scene_of
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.row import Row

LEDGER_FIGURE = "error-ledger.svg"


def front_matter(results: Results, studies: Sequence[str], directory: Path) -> list[Block]:
    """Return conclusion, failures, verdict counts and the error ledger of the studies of scenes."""
    named: list[Group] = []
    verdicts: list[VerdictRecord] = []
    for study in studies:
        verdicts += results.verdicts(study)
        named += [] if study in CHAPTERS else groups(results, results.manifest(study))
    found, opening = with_entries(named), with_entries(named, OPENING_PARTS)
    blocks: list[Block] = [
        Paragraph(headline(found, verdicts), "lead"),
        *_failures(verdicts),
        Heading("Verdicts", 3),
        verdict_counts(results, studies),
    ]
    if found:
        blocks += [Heading("Error ledger", 3), ledger_table(found)]
        caption = "The error ledger: displacement filled, contact pressure open."
        blocks.append(histories.saved(histories.ledger_figure(ledger_lines(found)), directory, LEDGER_FIGURE, caption))
    if opening:
        blocks += [Heading("Error ledger of contact that opens", 3), ledger_table(opening, OPENING_PARTS)]
    return blocks


def headline(found: Sequence[Group], verdicts: Sequence[VerdictRecord]) -> str:
    """Return the report's conclusion in one plain sentence."""
    said = gate_count(verdicts) if verdicts else "no gate was judged"
    gates = said[:1].upper() + said[1:]
    form = [part_values(found, "model form", column) for column in (0, 1)]
    if not all(form):
        return f"{gates}; DDA was not compared with the exact bar."
    return (
        f"{gates}: under the same Newmark scheme DDA differs from the exact elastic bar by {span(form[0])} in "
        f"displacement and {span(form[1])} in contact pressure (relative L2){_shares(found, min(form[0]))}."
    )


def _shares(found: Sequence[Group], form: float) -> str:
    """Say what code and mesh contribute, and call the rest model form where both are below the least difference."""
    parts = {
        "code and rounding are": part_values(found, "code", 0),
        "the finite-element mesh is": part_values(found, "mesh", 0),
    }
    said = [f"{name} at most {percent(max(values))}" for name, values in parts.items() if values]
    if not said:
        return ""
    small = all(max(values) < form for values in parts.values() if values)
    rest = "; the rest is model form, one strain in the block against a wave" if small else ""
    return f"; of the displacement's difference {' and '.join(said)}{rest}"


def _failures(verdicts: Sequence[VerdictRecord]) -> list[Block]:
    bad = [v for v in verdicts if v["verdict"] != "PASS"]
    failed = sum(v["verdict"] == "FAIL" for v in bad)
    blocks: list[Block] = []
    if failed:
        blocks.append(Callout(f"{failed} gates fail." if failed > 1 else "One gate fails.", "fail"))
    return [*blocks, failure_table(bad)] if bad else blocks


def failure_table(verdicts: Sequence[VerdictRecord]) -> Table:
    """Return the gates that did not pass by their ids, failures first."""
    titles = (Column("Verdict", "verdict"), Column("Gate", "id"), Column("Value", "decimal"), Column("Band"))
    ordered = sorted(verdicts, key=lambda v: ORDER.get(v["verdict"], 0))
    rows = under_headings(
        ordered, lambda v: v.get("why") or "", lambda v: (v["verdict"], v["id"], value_cell(v["value"]), band(v))
    )
    return Table(titles, rows, ruled=False)


def verdict_counts(results: Results, studies: Sequence[str]) -> Table:
    """Return PASS, FAIL and NOT RUN per study; per scene of a single study, and of scenes that do not pass."""
    rows = []
    for study in studies:
        per_scene: dict[str, Counter[str]] = {}
        for v in results.verdicts(study):
            per_scene.setdefault(scene_of(v["scene"]), Counter())[v["verdict"]] += 1
        rows.append((study, "all scenes", *_counts(sum(per_scene.values(), Counter()))))
        for name, count in per_scene.items():
            if len(studies) == 1 or set(count) - {"PASS"}:
                rows.append(("", name, *_counts(count)))
    return Table((*columns("text", "Study", "Scene"), *columns("decimal", *reversed(ORDER))), tuple(rows))


def _counts(count: Mapping[str, int]) -> list[str]:
    return [str(count.get(word, 0)) for word in reversed(ORDER)]


def provenance(results: Results, studies: Sequence[str]) -> list[Block]:
    """Return where the numbers come from and what they cost."""
    blocks: list[Block] = [Heading("Provenance")]
    for study in studies:
        manifest = results.manifest(study)
        rows = [(name.capitalize(), _said(value)) for name, value in manifest.get("provenance", {}).items()]
        blocks += [
            Heading(manifest.get("title") or study, 3),
            Table((Column("Item"), Column("Value", "fill")), tuple(rows)),
            cost_table(results, manifest),
        ]
    return blocks


def _said(value: object) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {version}" for name, version in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value)) or "none"
    return "none" if value is None else str(value)


def cost_table(results: Results, manifest: Manifest) -> Table:
    """Return runs, work and seconds of each solver of a study."""
    rows = results.rows()
    used: dict[str, dict[str, Row]] = {}
    for entry in manifest.get("cases", []):
        if entry["key"] in rows:
            used.setdefault(entry["solver"], {})[entry["key"]] = rows[entry["key"]]
    lines = []
    for solver, own in used.items():
        work: Counter[str] = Counter()
        most, seconds = 0, 0.0
        for row in own.values():
            work.update(row.work)
            most, seconds = max(most, row.work.get("unknowns", 0)), seconds + sum(row.seconds.values())
        counts = (len(own), most, work["factorisations"], work["solves"], work["steps"])
        lines.append((solver, *map(str, counts), plain(seconds, 3)))
    titles = columns("decimal", "Runs", "Unknowns, most", "Factorisations", "Solves", "Steps", "Seconds")
    caption = "Cost of the results; cached runs count with their original run time."
    return Table((Column("Solver"), *titles), tuple(lines), caption)
