"""Verdicts of two runs side by side, and verdicts as Markdown for a job's page."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from validation.errors import InputError
from validation.gates.gate import said
from validation.runs.records import VerdictRecord

Record = VerdictRecord
WORDS = ("PASS", "FAIL", "NOT RUN")
RANK = {"PASS": 0, "NOT RUN": 1, "FAIL": 2}
ABSENT = "absent"


@dataclass(frozen=True)
class Change:
    """One gate in two runs; a verdict is PASS, FAIL, NOT RUN or absent."""

    study: str
    id: str
    before: str
    after: str
    value_before: object
    value_after: object

    @property
    def worse(self) -> bool:
        """Whether the gate fails or is no longer run, and did better before; a new gate that fails counts."""
        if self.after == ABSENT:
            return self.before == "PASS"
        return RANK[self.after] > RANK.get(self.before, 1 if self.after == "FAIL" else 2)

    @property
    def kind(self) -> str:
        """What became of the gate, in one word or two."""
        if self.worse:
            return "worse"
        if self.before == ABSENT:
            return "new"
        if self.after == ABSENT:
            return "gone"
        return "value" if self.before == self.after else "better"


def read_verdicts(source: Path | str) -> list[VerdictRecord]:
    """Return the verdicts of a ``verdicts.json`` or of a results directory.

    Raises
    ------
    InputError
        There is no such file, or it holds no verdicts.
    """
    path = Path(source)
    path = path / "verdicts.json" if path.is_dir() else path
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}; a run leaves it with its results") from None
    except ValueError as error:
        raise InputError(f"{path}: must be JSON: {error}") from None
    if not isinstance(found, list) or not all(
        isinstance(v, dict) and {"id", "study", "verdict", "value"} <= v.keys() and v["verdict"] in WORDS for v in found
    ):
        raise InputError(f"{path}: must be a list of verdicts with id, study, verdict and value")
    return found


def changes(before: Iterable[Record], after: Iterable[Record]) -> list[Change]:
    """Return the gates whose verdict or value differs, the worse ones first."""
    old, new = ({(v["study"], v["id"]): v for v in verdicts} for verdicts in (before, after))
    found = []
    for key in dict.fromkeys([*old, *new]):
        was, now = _said(old.get(key)), _said(new.get(key))
        if was != now:
            found.append(Change(*key, was[0], now[0], was[1], now[1]))
    order = ("worse", "better", "new", "gone", "value")
    return sorted(found, key=lambda c: (order.index(c.kind), c.study, c.id))


def _said(v: Record | None) -> tuple[str, object]:
    """Verdict and value of a gate, absent and nothing where it is not there."""
    return (ABSENT, None) if v is None else (v["verdict"], v["value"])


def against(baseline: Path | str, records: Sequence[Record]) -> list[Change]:
    """Return what changed since a baseline in the studies that were run."""
    studies = {v["study"] for v in records}
    return changes([v for v in read_verdicts(baseline) if v["study"] in studies], records)


def counted(records: Iterable[Record]) -> str:
    """Return the counts of the three verdicts in words."""
    words = [v["verdict"] for v in records]
    return ", ".join(f"{words.count(word)} {word}" for word in WORDS)


def markdown(records: Sequence[Record], since: Sequence[Change] | None = None) -> str:
    """Return a summary: counts, what failed, what was not run, and what changed since a baseline."""
    lines = [f"## dda-validation: {counted(records)}", ""]
    lines += _table(("study", *WORDS), _rows_of_studies(records))
    for word in ("FAIL", "NOT RUN"):
        rows = [_row(v) for v in records if v["verdict"] == word]
        lines += [f"### {word}", "", *_table(("gate", "value", "band", "why"), rows)] if rows else []
    if since is not None:
        rows = [[c.kind, _code(c.id), _step(c.before, c.after), _step(c.value_before, c.value_after)] for c in since]
        lines += ["### Since the baseline", ""]
        lines += _table(("change", "gate", "verdict", "value"), rows) if rows else ["Nothing changed.", ""]
    return "\n".join(lines)


def _rows_of_studies(records: Sequence[Record]) -> list[list[str]]:
    studies = dict.fromkeys(v["study"] for v in records)
    words = {study: [v["verdict"] for v in records if v["study"] == study] for study in studies}
    return [[study, *(str(words[study].count(word)) for word in WORDS)] for study in studies]


def _row(v: Record) -> list[str]:
    band = " .. ".join(f"{edge:.4g}" for edge in v.get("band", ()))
    return [_code(v["id"]), said(v["value"]), band, _cell(v.get("why") or v.get("reason", ""))]


def _step(before: object, after: object) -> str:
    return said(after) if before == after else f"{said(before)} → {said(after)}"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", r"\|")


def _code(text: str) -> str:
    return f"`{_cell(text)}`"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *(f"| {' | '.join(row)} |" for row in rows), ""]
