"""Verdicts of two runs side by side, and verdicts as Markdown for a job's page."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from validation.errors import InputError
from validation.runs import strict
from validation.runs.numbers import band_text, measured_text
from validation.runs.records import Baseline, BaselineVerdict, VerdictRecord
from validation.runs.text import printable

Record = BaselineVerdict
Edges = tuple[float, float]
# Of the larger edge: a difference of two predicted histories (`theory.spectra.mesh_error`) has a thousandth
# of their size or less, and their rounding of 1e-12 to 1e-11 after thousands of steps is the processor's.
LAST_DIGITS = 1e-8
WORDS = ("PASS", "FAIL", "NOT RUN")
RANK = {"PASS": 0, "NOT RUN": 1, "FAIL": 2}
ABSENT = "absent"
ADVICE = "name the verdicts.json that a run leaves with its results"


@dataclass(frozen=True)
class Change:
    """One gate in two runs; a verdict is PASS, FAIL, NOT RUN or absent."""

    study: str
    id: str
    before: str
    after: str
    value_before: object
    value_after: object
    band_before: Edges | None = None
    band_after: Edges | None = None

    @property
    def rebanded(self) -> bool:
        """Whether the gate is there in both runs, with another band."""
        return ABSENT not in (self.before, self.after) and not same_band(self.band_before, self.band_after)

    @property
    def widened(self) -> bool:
        """Whether the band lets pass what it did not before."""
        if self.band_before is None or self.band_after is None:
            return False
        (low, high) = self.band_before
        (new_low, new_high) = self.band_after
        last = LAST_DIGITS * max(map(abs, (low, high)))
        return new_low < low - last or new_high > high + last

    @property
    def worse(self) -> bool:
        """Whether the gate fails or is not run and did better before, is new and fails, or has a wider band."""
        if self.widened:
            return True
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
        if self.before != self.after:
            return "better"
        return "band" if self.rebanded else "value"


def read_verdicts(source: Path | str) -> list[BaselineVerdict]:
    """Return the verdicts of a ``verdicts.json`` or of a results directory.

    Raises
    ------
    InputError
        There is no such file, it holds no verdicts, two of one gate, or one that its own value belies.
    """
    path = Path(source)
    path = path / "verdicts.json" if path.is_dir() else path
    try:
        found: list[BaselineVerdict] = strict.read(path, Baseline, ADVICE, "a list of verdicts")
    except FileNotFoundError:
        raise InputError("cannot be read: there is no such file", source=path, advice=ADVICE) from None
    return found


def same_band(before: Edges | None, after: Edges | None) -> bool:
    """Whether two bands are one, their last digits apart."""
    if before is None or after is None:
        return before == after
    last = LAST_DIGITS * max(map(abs, (*before, *after)))
    return all(abs(new - old) <= last for old, new in zip(before, after, strict=True))


def changes(before: Iterable[Record], after: Iterable[Record]) -> list[Change]:
    """Return the gates whose verdict or value differs, the worse ones first."""
    old, new = ({(v["study"], v["id"]): v for v in verdicts} for verdicts in (before, after))
    found = []
    for key in dict.fromkeys([*old, *new]):
        was = old.get(key)
        now = new.get(key)
        bands = _band(was), _band(now)
        differs = was is None or now is None or _said(was) != _said(now) or not same_band(*bands)
        if differs:
            (word, value) = _said(was)
            (new_word, new_value) = _said(now)
            found.append(Change(*key, word, new_word, value, new_value, *bands))
    order = ("worse", "better", "new", "gone", "band", "value")
    return sorted(found, key=lambda c: (order.index(c.kind), c.study, c.id))


def _said(v: Record | None) -> tuple[str, object]:
    """Verdict and value of a gate that may be absent."""
    return (ABSENT, None) if v is None else (v["verdict"], v["value"])


def _band(v: Record | None) -> Edges | None:
    return None if v is None else (v["band"][0], v["band"][1])


def against(
    baseline: Path | str | Iterable[Record], records: Sequence[Record], studies: Iterable[str] | None = None
) -> list[Change]:
    """Return what changed since a baseline in the studies that were run, by default those of the records.

    A study that was run and has no gate left has lost all of the baseline's.
    """
    before = read_verdicts(baseline) if isinstance(baseline, Path | str) else baseline
    names = {v["study"] for v in records} if studies is None else set(studies)
    return changes([v for v in before if v["study"] in names], records)


def counted(records: Iterable[VerdictRecord]) -> str:
    """Return the counts of the three verdicts in words."""
    words = [v["verdict"] for v in records]
    return ", ".join(f"{words.count(word)} {word}" for word in WORDS)


def markdown(records: Sequence[VerdictRecord], since: Sequence[Change] | None = None) -> str:
    """Return counts, what failed, what was not run, and what changed since a baseline."""
    lines = [f"## dda-validation: {counted(records)}", ""]
    lines += _table(("study", *WORDS), _rows_of_studies(records))
    for word in ("FAIL", "NOT RUN"):
        rows = [_row(v) for v in records if v["verdict"] == word]
        lines += [f"### {word}", "", *_table(("gate", "value", "band", "why"), rows)] if rows else []
    if since is not None:
        rows = [_row_of_change(c) for c in since]
        lines += ["### Since the baseline", ""]
        lines += _table(("change", "gate", "verdict", "value"), rows) if rows else ["Nothing changed.", ""]
    return "\n".join(lines)


def _rows_of_studies(records: Sequence[VerdictRecord]) -> list[list[str]]:
    studies = dict.fromkeys(v["study"] for v in records)
    words = {study: [v["verdict"] for v in records if v["study"] == study] for study in studies}
    return [[_cell(study), *(str(words[study].count(word)) for word in WORDS)] for study in studies]


def _row(v: VerdictRecord) -> list[str]:
    band = band_text(v.get("band"))
    return [_code(v["id"]), measured_text(v["value"]), band, _cell(v.get("why") or v.get("reason", ""))]


def _row_of_change(c: Change) -> list[str]:
    value = _step(c.value_before, c.value_after)
    if c.rebanded:
        value += f"; band {band_text(c.band_before)} → {band_text(c.band_after)}"
    return [c.kind, _code(c.id), _step(c.before, c.after), value]


def _step(before: object, after: object) -> str:
    return measured_text(after) if before == after else f"{measured_text(before)} → {measured_text(after)}"


def _cell(text: str) -> str:
    return html.escape(_line(text), quote=False)


def _code(text: str) -> str:
    return f"`{_line(text).replace('`', chr(39))}`"  # in which nothing is markup but its own end


def _line(text: str) -> str:
    return printable(text).replace("|", r"\|")


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *(f"| {' | '.join(row)} |" for row in rows), ""]
