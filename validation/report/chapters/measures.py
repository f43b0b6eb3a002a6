"""Columns of tables that hold a metric: its title, its unit as a factor, and how many digits are written."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from validation.report.blocks import TableColumn
from validation.report.chapters.data import CaseResults
from validation.report.chapters.text import DASH, cell
from validation.runs.row import Value


@dataclass(frozen=True)
class MetricColumn:
    """A column of a table: a metric in the unit that its title names."""

    metric: str
    factor: float  # from the metric's unit to that of the title
    title: str
    group: str = ""  # title that it shares with its neighbours
    digits: int = 4
    decimals: int | None = None  # instead of significant digits
    solver: str = "dda"

    @property
    def head(self) -> TableColumn:
        """Its head in the table."""
        return TableColumn(self.title, "decimal", self.group)

    def text(self, value: Value) -> str:
        """Return a value of the metric as a cell: a number, its word, or a dash where there is none."""
        if self.decimals is None or not isinstance(value, int | float):
            return cell(value, self.factor, self.digits)
        # Adding zero takes the sign off a negative zero.
        return f"{round(value * self.factor, self.decimals) + 0.0:.{self.decimals}f}".replace("-", "−")

    def of(self, case: CaseResults | None) -> str:
        """Return the cell of a case; a dash where its solver has no number."""
        return DASH if case is None else self.text(case.number(self.solver, self.metric))


def heads(measures: Iterable[MetricColumn]) -> tuple[TableColumn, ...]:
    """Return the heads of some columns."""
    return tuple(measure.head for measure in measures)


def cells(measures: Iterable[MetricColumn], case: CaseResults | None) -> tuple[str, ...]:
    """Return the cells of a case."""
    return tuple(measure.of(case) for measure in measures)
