"""What the solvers of a scene differ by, pair by pair."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from validation.metrics.values import NOT_REPORTED
from validation.report.blocks import Head, Table, TableColumn, table
from validation.runs.records import ComparisonRecord

DIFFERENCES = {
    "displacement.l2": "v, L2",
    "displacement.max": "v, max",
    "pressure.l2": "pressure, L2",
    "pressure.max": "pressure, max",
}  # metric and title of its column


def difference_table(compared: Iterable[ComparisonRecord], name: Callable[[str], str]) -> Table:
    """Return a row for each pair of a case that has a difference, in per cent."""
    rows = []
    for c in compared:
        values = [c["metrics"].get(metric, NOT_REPORTED) for metric in DIFFERENCES]
        if set(values) != {NOT_REPORTED}:
            cells = [f"{100 * v:.3g}" if isinstance(v, float | int) else str(v) for v in values]
            rows.append((name(c["scene"]), f"{c['solver']} | {c['reference']}", *cells))
    heads: list[Head] = ["case", "pair", *(TableColumn(title, "decimal") for title in DIFFERENCES.values())]
    return table(heads, rows, "Differences of displacement v and contact pressure, relative, in per cent:")
