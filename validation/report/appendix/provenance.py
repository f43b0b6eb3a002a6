"""Parameters of the scenes, versions of the programs, and what the answers cost."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from validation.report.blocks import Blocks, Heading, Table, TableColumn, table
from validation.report.chapters.data import CaseGroup, Groups, varied_fields
from validation.report.chapters.text import parameter_items, some
from validation.runs.numbers import plain
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Row

MOST_NAMES = 2  # of scenes with the same data, before how many more there are


def parameter_table(groups: Groups) -> Blocks:
    """Return the data of the scenes: the first in full, of the others what differs, equal ones in a line."""
    groups_by_data: dict[str, list[CaseGroup]] = {}
    first_items: set[str] = set()
    for group in groups.values():
        items = parameter_items(group.cases[0].scene, varied_fields(group))
        differing = [item for item in items if item not in first_items]
        groups_by_data.setdefault(", ".join(differing), []).append(group)
        first_items = first_items or set(items)
    rows = []
    for data, alike in groups_by_data.items():
        cases = sum(len(group.cases) for group in alike)
        count = f"{cases} cases" if cases > 1 else "one case"
        names = some([group.name for group in alike], MOST_NAMES)
        rows.append((names, f"{data}, {count}" if data else count))
    caption = "Data of the scenes: the first in full, the others where they differ from it."
    return [Heading("Parameters", 2), table(("Scene", TableColumn("Data", "fill")), rows, caption, dense=True)]


def provenance(results: Results, studies: Sequence[str]) -> Blocks:
    """Return where the numbers come from and what they cost; what studies share is said once."""
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
    """Return runs, work and seconds of each solver in all studies; a run that they share counts once."""
    rows = results.rows()
    rows_by_solver: dict[str, dict[str, Row]] = {}
    for manifest in manifests:
        for entry in manifest.get("cases", []):
            if entry["key"] in rows:
                rows_by_solver.setdefault(entry["solver"], {})[entry["key"]] = rows[entry["key"]]
    lines = []
    for solver, rows_by_key in rows_by_solver.items():
        work: Counter[str] = Counter()
        for row in rows_by_key.values():
            work.update(row.work)
        unknowns = max(row.work.get("unknowns", 0) for row in rows_by_key.values())
        seconds = sum(sum(row.seconds.values()) for row in rows_by_key.values())
        counts = (len(rows_by_key), unknowns, work["factorisations"], work["solves"], work["steps"])
        lines.append((solver, *map(str, counts), plain(seconds, 3)))
    titles = ("Runs", "Unknowns, most", "Factorisations", "Solves", "Steps", "Seconds")
    caption = "Cost of the results; cached runs count with their original run time."
    return table(("Solver", *titles), lines, caption)
