"""Parameters of the scenes, versions of the programs, and what the answers cost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from validation.report.blocks import Blocks, Heading, Table, TableColumn, table
from validation.report.chapters.data import Groups, varied_fields
from validation.report.chapters.text import parameter_items
from validation.runs.numbers import plain
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Row


def parameter_table(groups: Groups) -> Blocks:
    """Return the data of the scenes: of the first in full, of the others what differs from it."""
    rows: list[tuple[str, str]] = []
    first_items: set[str] = set()
    for group in groups.values():
        varied = varied_fields(group)
        items = parameter_items(group.cases[0].scene, varied)
        differing = [item for item in items if item not in first_items]
        count = f"{len(group.cases)} cases" if len(group.cases) > 1 else "one case"
        rows.append((group.name, ", ".join([*differing, count])))
        first_items = first_items or set(items)
    caption = "Data of the scenes: the first in full, the others where they differ from it."
    return [Heading("Parameters", 2), table(("Scene", TableColumn("Data", "fill")), rows, caption, dense=True)]


def provenance(results: Results, studies: Sequence[str]) -> Blocks:
    """Return where the numbers come from and what they cost; what all studies share is said once."""
    manifests = [results.manifest(study) for study in studies]
    studies_by_item: dict[tuple[str, str], list[str]] = {}
    for manifest in manifests:
        for name, value in manifest.get("provenance", {}).items():
            studies_by_item.setdefault((name, _item_text(value)), []).append(manifest["study"])
    rows = []
    for (name, text), names in studies_by_item.items():
        where = "" if len(names) == len(manifests) else f" ({', '.join(names)})"
        rows.append((name.capitalize(), f"{text}{where}"))
    items = table(("Item", TableColumn("Value", "fill")), rows)
    return [Heading("Provenance", 2), items, cost_table(results, manifests)]


def _item_text(value: object) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {version}" for name, version in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value)) or "none"
    return "none" if value is None else str(value)


def cost_table(results: Results, manifests: Sequence[Manifest]) -> Table:
    """Return runs, work and seconds of each solver over all studies; a run that studies share counts once."""
    rows = results.rows()
    rows_by_solver: dict[str, dict[str, Row]] = {}
    for manifest in manifests:
        for entry in manifest.get("cases", []):
            if entry["key"] in rows:
                rows_by_solver.setdefault(entry["solver"], {})[entry["key"]] = rows[entry["key"]]
    lines = []
    for solver, rows_by_key in rows_by_solver.items():
        work: Counter[str] = Counter()
        unknowns = 0
        seconds = 0.0
        for row in rows_by_key.values():
            work.update(row.work)
            unknowns = max(unknowns, row.work.get("unknowns", 0))
            seconds += sum(row.seconds.values())
        counts = (len(rows_by_key), unknowns, work["factorisations"], work["solves"], work["steps"])
        lines.append((solver, *map(str, counts), plain(seconds, 3)))
    titles = ("Runs", "Unknowns, most", "Factorisations", "Solves", "Steps", "Seconds")
    caption = "Cost of the results; cached runs count with their original run time."
    return table(("Solver", *titles), lines, caption)
