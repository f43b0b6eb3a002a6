"""What a chapter says and shows, as the TOML file beside its module describes it; rows, lines and values come in.

    [text]          paragraphs, captions; ``{name}`` stands for a value, ``{name:percent}`` for a number in one of
                    `FORMS`, ``{name:short 3}`` with its digits
    [table.NAME]    columns, caption, notes, dense, ruled
    [panel.NAME]    of `ChartPanel`
    [figure.NAME]   file, caption, height, margins, shared
    [[NAME]]        the entries of a list

A column has a title, and where needed a group, a kind and what it is `of`: an expression of a case as
`validation.report.chapters.queries` has them, or a word for a value of the module's own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.metrics.catalogue import in_words
from validation.report.blocks import FigureBlock, Head, Kind, Table, TableColumn, table
from validation.report.chapters.data import CaseResults
from validation.report.chapters.queries import value_of_case
from validation.report.chapters.text import cell
from validation.report.figures import histories
from validation.report.figures.charts import ChartLine, ChartPanel, chart_figure
from validation.runs.numbers import FORMS, decimal
from validation.runs.row import Metrics, Value
from validation.runs.texts import FILLED, Texts


@dataclass(frozen=True)
class CaseColumn:
    """A table column: a number in the unit that its title names."""

    title: str
    of: str = ""
    group: str = ""  # title that it shares with its neighbours
    factor: float = 1.0  # from the number's unit to that of the title
    digits: int = 4
    decimals: int | None = None  # instead of significant digits
    form: str = "plain"
    kind: Kind | None = None  # of its cells; as they show where there is none

    @property
    def head(self) -> Head:
        """Its head."""
        if self.kind is not None:
            return TableColumn(self.title, self.kind, self.group)
        return (self.group, self.title) if self.group else self.title

    def text(self, value: Value) -> str:
        """Return a value as a cell: a number, its word, or a dash."""
        if value is None or isinstance(value, str):
            return cell(in_words(self.of.rpartition(" ")[2], value))
        number = value if self.factor == 1 else value * self.factor  # a count stays one: its zero is no rounding
        if self.decimals is None:
            return FORMS[self.form](number, self.digits)
        return decimal(number, self.decimals)

    def of_case(self, case: CaseResults, own: Metrics) -> str:
        """Return the cell of a case; `own` are values by name in place of an expression."""
        return self.text(own[self.of] if self.of in own else value_of_case(case, None, self.of))


class Description(Texts):
    """The description of a chapter."""

    def has(self, kind: str, name: str) -> bool:
        """Whether something of a kind (``text``, ``number``, ``table``) has this name."""
        return name in self._data.get(kind, {})

    def described(self, kind: str, name: str) -> dict[str, Any]:
        """Return what is said of a thing of a kind."""
        described: dict[str, Any] = self._data[kind][name]
        return described

    def entries(self, name: str) -> list[dict[str, Any]]:
        """Return the entries of a list."""
        entries: list[dict[str, Any]] = self._data[name]
        return entries

    def columns(self, name: str) -> list[CaseColumn]:
        """Return the columns of a table."""
        columns = self._data["table"][name]["columns"]
        return [CaseColumn(column) if isinstance(column, str) else CaseColumn(**column) for column in columns]

    def table(self, name: str, rows: Iterable[Sequence[str]], heads: Sequence[Head] = (), **values: Any) -> Table:
        """Return a table of these rows; `heads` replace the described ones."""
        described = dict(self._data["table"][name])
        described.pop("columns", None)
        if values:
            described["caption"] = FILLED.vformat(described["caption"], (), values)
        return table(heads or [column.head for column in self.columns(name)], rows, **described)

    def panel(self, name: str, lines: Sequence[ChartLine], **parts: Any) -> ChartPanel:
        """Return a panel with these lines; `parts` stand beside or replace the described ones."""
        described = {"title": "", "x_label": "", "y_label": ""} | self._data["panel"][name] | parts
        for query in ("lines", "level_of", "level_factor", "mark_of"):
            described.pop(query, None)
        for axis in ("x_ticks", "y_ticks"):
            if isinstance(described.get(axis), list):
                described[axis] = dict(described[axis])
        return ChartPanel(lines=lines, **described)

    def figure(
        self, name: str, panels: Sequence[ChartPanel], directory: Path, scene: str = "", **values: Any
    ) -> FigureBlock:
        """Draw panels as a figure, of one scene or of none; return its block."""
        described = self._data["figure"][name]
        margins = histories.Margins(*described["margins"]) if "margins" in described else None
        figure = chart_figure(panels, described.get("height", 48.0), margins, described.get("shared", False))
        file = described["file"].format_map(values)
        caption = values.get("whole_caption") or FILLED.vformat(described["caption"], (), values)
        return histories.saved(figure, directory, file, caption, scene)
