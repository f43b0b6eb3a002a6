"""Verdicts as data of a table that a page filters: words once, each row by their numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from validation.gallery.cases import PlainData, readable
from validation.report.chapters.gates import ORDER, band, measured, reason, value_cell
from validation.runs.records import VerdictRecord

COLUMNS = ("verdict", "case", "pair", "metric", "value", "band")


def table(verdicts: Sequence[VerdictRecord]) -> PlainData:
    """Return the table of some verdicts, failures first: rows of six texts and the number of the row's reason."""
    words: dict[str, int] = {}
    reasons: dict[str, int] = {}
    rows = []
    for verdict in sorted(verdicts, key=lambda v: ORDER.get(v["verdict"], 0)):
        texts = (
            verdict["verdict"],
            verdict["scene"],
            " – ".join(verdict["pair"]),
            measured(verdict),
            value_cell(verdict["value"], verdict["metric"]),
            band(verdict),
        )
        numbers = [words.setdefault(readable(text), len(words)) for text in texts]
        rows.append([*numbers, reasons.setdefault(readable(reason(verdict)), len(reasons))])
    return {"words": list(words), "rows": rows, "reasons": list(reasons)}


def counts(verdicts: Sequence[VerdictRecord]) -> dict[str, int]:
    """Return how many verdicts say PASS, FAIL and NOT RUN."""
    count = Counter(v["verdict"] for v in verdicts)
    return {word: count[word] for word in ("PASS", "FAIL", "NOT RUN")}
