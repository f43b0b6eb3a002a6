"""Which versions and which commit made a row, and what a study says of all its rows."""

from __future__ import annotations

import functools
import itertools
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from validation.engine.case import library_versions
from validation.runs.provenance import provenance
from validation.runs.row import Row
from validation.solvers.contract import Solver

PRINTERS = ("matplotlib", "typst")  # of the report: no row comes from them
UNKNOWN = "unknown"

_here = functools.cache(provenance)  # it asks git, once a process


def of_row(solver: Solver) -> dict[str, Any]:
    """Return where a row of a solver comes from that is made here and now."""
    here = _here()
    packages = {name: release for name, release in here["packages"].items() if name not in PRINTERS}
    return {**here, "packages": {**packages, **library_versions(), **solver.versions()}}


def of_rows(rows: Iterable[Row]) -> dict[str, Any]:
    """Return where the rows of a study come from, an item a line; what differs between rows with their number."""
    origins = [row.provenance for row in rows]
    items = dict.fromkeys(itertools.chain.from_iterable(origins))
    summary = {
        item: _counted([row_origin.get(item, UNKNOWN) for row_origin in origins])
        for item in items
        if item != "packages"
    }
    releases: dict[str, list[Any]] = {}  # by package; one that rows do not name is not used by their solver
    for row_origin in origins:
        for package, release in _mapping(row_origin.get("packages")).items():
            releases.setdefault(package, []).append(release)
    return summary | {"packages": {package: _counted(values) for package, values in releases.items()}}


def _mapping(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def _counted(values: list[Any]) -> Any:
    """Return the one value, or each with the number of its rows."""
    counts = Counter(map(str, values))
    if len(counts) == 1:
        return values[0]
    return "; ".join(f"{text} ({count} row{'s' * (count > 1)})" for text, count in counts.items())
