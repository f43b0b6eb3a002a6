"""Tables of gates: value, band and reason of each."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence

from validation.report.blocks import Column, Table, columns
from validation.report.chapters.text import bounded, cell, short
from validation.runs.records import VerdictRecord
from validation.runs.row import Value

ORDER = {"FAIL": 0, "NOT RUN": 1, "PASS": 2}
NARROW = 7  # digits; a narrower band is written as middle and half width


def gate_table(verdicts: Sequence[VerdictRecord], labels: Mapping[str, str]) -> Table:
    """Return gates with value and band under the reason that they share, failures first."""
    titles = (
        Column("Verdict", "verdict"),
        *columns("text", "Case", "Pair"),
        Column("Metric", "code"),
        Column("Value", "decimal"),
        Column("Band"),
    )
    places = [*labels, *(v["scene"] for v in verdicts)]
    ordered = sorted(verdicts, key=lambda v: (ORDER.get(v["verdict"], 0), places.index(v["scene"])))
    return Table(titles, under_headings(ordered, reason, lambda v: _gate_row(v, labels)), ruled=False)


def under_headings(
    verdicts: Sequence[VerdictRecord],
    heading: Callable[[VerdictRecord], str],
    row: Callable[[VerdictRecord], tuple[str, ...]],
) -> tuple[tuple[str, ...], ...]:
    """Return a row for each verdict, those of one heading together below it; an empty heading takes no line."""
    together: dict[str, list[tuple[str, ...]]] = {}
    for verdict in verdicts:
        said = heading(verdict)
        together.setdefault(said, [(said,)] if said else []).append(row(verdict))
    return tuple(itertools.chain(*together.values()))


def _gate_row(v: VerdictRecord, labels: Mapping[str, str]) -> tuple[str, ...]:
    window = f"@{v['id'].rpartition('@')[2]}" if "@" in v["id"] else ""
    case, pair = labels.get(v["scene"], v["scene"]), " – ".join(v["pair"])
    return (v["verdict"], case, pair, v["metric"] + window, value_cell(v["value"]), band(v))


def value_cell(value: Value) -> str:
    """Return the value of a verdict without needless zeros."""
    return bounded(value, short(value)) if isinstance(value, int | float) else cell(value)


def band(v: VerdictRecord) -> str:
    """Return the band of a verdict's gate, with as many digits as tell its edges apart."""
    low, high = v["band"]
    middle, half, size = (low + high) / 2, (high - low) / 2, max(abs(low), abs(high))
    digits = next((d for d in range(4, 16) if high - low > 3 * 10.0**-d * size), 16)
    if low != high and digits > NARROW:
        return f"{short(middle, digits)} ± {short(half, 2)}"
    return f"{short(low, digits)} … {short(high, digits)}"


def reason(v: VerdictRecord) -> str:
    """Return why the band is what it is, the kind of reference, and what went wrong if anything did."""
    uncertainty = v.get("reference_uncertainty") or 0.0
    kind = f" [{v['reference_kind']}" + (f" ± {short(uncertainty, 2)}" if uncertainty else "") + "]"
    why = f" {v['why'][:1].upper()}{v['why'][1:]}." if v.get("why") else ""
    return f"{v['reason']}{kind}{why}"
