"""The error ledger: what part of a difference is code, mesh, model form and time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from validation.report.blocks import Table, columns
from validation.report.chapters.data import Case, Group
from validation.report.chapters.text import DASH, bounded, power, raised
from validation.report.figures.histories import LedgerLine
from validation.runs.run import Outcome
from validation.scenes import features

PARTS = {
    "code": ("dda", "dda-textbook"),
    "mesh": ("fem", "bar"),
    "model form": ("dda", "bar"),
    "time": ("bar", "continuum"),
}
OPENING_PARTS = {  # contact that opens: no recursion is printed for it, and both models are known exact in time
    "code": ("fem", "fenicsx"),
    "mesh": ("fem", "bar"),
    "model form": ("block-events", "bar-events"),
    "time": ("dda", "block-events"),
}
METRICS = ("displacement.l2", "pressure.l2")
NOT_COMPARED = "The results hold no comparison of this pair."


@dataclass(frozen=True)
class Entry:
    """One part for one case: relative L2 of displacement and contact pressure [1], or the reason for none.

    A remark says where the numbers come from another place than the part's own pair.
    """

    values: tuple[float | None, float | None] = (None, None)
    reason: str = ""
    remark: str = ""


def parts_of(case: Case) -> Mapping[str, tuple[str, str]]:
    """Return the parts of the ledger, each the solver and its reference."""
    return PARTS if features.linear(case.scene) else OPENING_PARTS


def entry(group: Group, case: Case, part: str) -> Entry:
    """Return a part of the ledger for one case."""
    solver, reference = parts_of(case)[part]
    if (found := _compared(group, case, solver, reference)) is not None:
        return found
    if parts_of(case) is OPENING_PARTS:
        return Entry(reason=_absence(case, solver) or _absence(case, reference) or NOT_COMPARED)
    if part == "code" and (row := case.rows.get("dda")) is not None and row.estimate is not None:
        return Entry((row.estimate, row.estimate), remark="Code: the solver's own estimate of its rounding.")
    if part == "model form" and (instead := _against_fem(group, case)) is not None:
        return instead
    return Entry(reason=_absence(case, solver) or _absence(case, reference) or NOT_COMPARED)


def _compared(group: Group, case: Case, solver: str, reference: str) -> Entry | None:
    displacement, pressure = (group.number_of_pair(case, solver, reference, name) for name in METRICS)
    return None if displacement is None and pressure is None else Entry((displacement, pressure))


def _against_fem(group: Group, case: Case) -> Entry | None:
    """Return dda against fem where there is no bar; corner point springs have no limit to compare with."""
    if case.scene.fem.foundation == "corner":
        return Entry(reason="fem on corner point springs has no fine-mesh limit.")
    found = _compared(group, case, "dda", "fem")
    return None if found is None else Entry(found.values, remark="Model form: against fem, where the bar does not run.")


def _absence(case: Case, solver: str) -> str:
    """Return why a solver has no history of a case, or nothing where it has one."""
    row = case.rows.get(solver)
    if row is None:
        return f"The scene does not ask for {solver}."
    if row.outcome is Outcome.COMPLETED:
        return ""
    return f"{solver}: {row.outcome}" + (f" ({'; '.join(row.notes)})." if row.notes else ".")


def with_entries(groups: Sequence[Group], parts: Mapping[str, tuple[str, str]] = PARTS) -> list[Group]:
    """Return the groups with the cases of these parts that some of them applies to."""
    kept = []
    for group in groups:
        cases = tuple(case for case in group.cases if parts_of(case) is parts and _has_entry(group, case))
        kept += [replace(group, cases=cases)] if cases else []
    return kept


def _has_entry(group: Group, case: Case) -> bool:
    return any(entry(group, case, part).values != (None, None) for part in PARTS)


def ledger_table(groups: Sequence[Group], parts: Mapping[str, tuple[str, str]] = PARTS) -> Table:
    """Return the ledger of all cases, which have these parts, reasons and remarks numbered below."""
    notes: list[str] = []
    rows = []
    for group in groups:
        name = group.name
        for case in group.cases:
            rows.append((name, *_row(group, case, notes)))
            name = ""  # once above its cases
    titles = columns("text", "Scene", "Case")
    for part, (solver, reference) in parts.items():
        over = f"{part}: {solver} − {reference.removeprefix('dda-')}"
        titles += columns("decimal", "displ.", "pressure", group=over)
    caption = "Relative L2 difference over the whole history, as a fraction; below 10⁻¹² a bound."
    return Table(titles, tuple(rows), caption, tuple(f"{raised(i)} {text}" for i, text in enumerate(notes, 1)))


def _row(group: Group, case: Case, notes: list[str]) -> tuple[str, ...]:
    cells = []
    for part in PARTS:
        found = entry(group, case, part)
        text = found.reason or found.remark
        if text and text not in notes:
            notes.append(text)
        mark = raised(notes.index(text) + 1) if text else ""
        cells += [_cell(value, mark) for value in found.values]
    return case.label, *cells


def _cell(value: float | None, mark: str) -> str:
    if value is None:
        return f"{DASH}{mark}"
    return bounded(value, power(value)) + (f" {mark}" if mark else "")


def ledger_lines(groups: Sequence[Group]) -> list[LedgerLine]:
    """Return the ledger as lines of a figure."""
    lines = []
    for group in groups:
        for case in group.cases:
            label = f"{group.name}: {case.label}" if len(group.cases) > 1 else group.name
            lines.append(LedgerLine(label, {part: entry(group, case, part).values for part in PARTS}))
    return lines


def part_values(groups: Sequence[Group], part: str, column: int) -> list[float]:
    """Return all numbers of a part that come from its own pair, for displacement (0) or pressure (1)."""
    values = []
    for group in groups:
        for case in group.cases:
            found = entry(group, case, part)
            value = None if found.remark else found.values[column]
            values += [] if value is None else [value]
    return values
