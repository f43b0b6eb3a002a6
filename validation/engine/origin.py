"""Which versions and which commit made a row, and what a study says of all its rows."""

from __future__ import annotations

import functools
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
    found = _here()
    packages = {name: said for name, said in found["packages"].items() if name not in PRINTERS}
    return {**found, "packages": {**packages, **library_versions(), **solver.versions()}}


def of_rows(rows: Iterable[Row]) -> dict[str, Any]:
    """Return where the rows of a study come from, an item a line; what differs between rows with their number."""
    made = [row.provenance for row in rows]
    items = dict.fromkeys(name for some in made for name in some if name != "packages")
    found: dict[str, Any] = {name: _counted([some.get(name, UNKNOWN) for some in made]) for name in items}
    packages = [_mapping(some.get("packages")) for some in made]
    names = dict.fromkeys(name for some in packages for name in some)
    # A package that rows do not name is not used by their solver.
    return found | {"packages": {n: _counted([some[n] for some in packages if n in some]) for n in names}}


def _mapping(found: object) -> Mapping[str, Any]:
    return found if isinstance(found, Mapping) else {}


def _counted(values: list[Any]) -> Any:
    """Return the one value, or each with the number of its rows."""
    met: dict[str, int] = {}
    for value in values:
        met[str(value)] = met.get(str(value), 0) + 1
    if len(met) == 1:
        return values[0]
    return "; ".join(f"{said} ({count} row{'s' * (count > 1)})" for said, count in met.items())
