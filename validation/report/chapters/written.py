"""Chapters as their description writes them, ``chapter.toml`` in the folder of a study: parts in order.

``parts`` is a list; a part has a heading, then as far as it names them a text, a figure, a table and a text after it,
and is left out where a table or figure that it names shows nothing:

    { opening = "lead", remark = "note", gates = true }    title, lead, purpose, remark, what the gates say
    { heading = "Run-out", text = "x", figure = "y", table = "z", after = "w" }
    { heading_of = "locking" }                             headed by the title of a scene
    { figure = "y", file = "y-1.svg", where = { a = 1 } }  a figure or table of the lines that meet this besides
    { level = 3, table = "z", each = "scene" }             once for each scene, headed so
    { section = "figure-7", columns = ["displacement"] }   the section of a scene, `without` the exact solutions
    { ledger = true }                                      where the energy of each scene went
    { history = "long-run", columns = ["displacement"] }   the histories of a scene
    { outcomes = 3 }                                       at most so many callouts on runs that did not complete
    { picture = "cuts" }                                   scenes as they are drawn
    { frames = "push" }                                    a motion at some instants, with contact forces
    { call = "f" }                                         what f(table, directory) of chapter.py returns
    { sketch = "figures-3-4", share = 0.4, beside = [] }   the two-block model of a scene, and parts beside it
    { points = ["a", "b"], heading = "In {count} points" } texts, each after ``NAME-question``; what has no numbers goes

and ``when``, a list of scenes that must be there. `validation.report.chapters.queries` has queries and expressions:

    [text]          paragraphs and captions; ``{name}`` stands for a number or a list
    [number.NAME]   a query, its ``value``, an expression, and how it is written
    [list.NAME]     a query, ``group_by``, the numbers of each line, its ``text``, what joins them
    [table.NAME]    a query, ``group_by``, columns, one of which may be a ``list``; caption, notes, dense, ruled
    [figure.NAME]   panels, file, caption; or ``each``, a figure of the histories of a scene with a panel a case
    [panel.NAME]    of `ChartPanel`, and lines, each a query, x and y
    [looks.NAME]    how lines look by the value of ``each``, for lines whose ``looks`` is this name
    [picture.NAME]  file, caption, height in mm; ``scenes``, the title of each
    [frames.NAME]   file, caption, height in mm; ``scene``, whose last case is drawn, ``solver``, ``times`` in s
    [maps.NAME]     file, caption; ``of`` a list, a line of maps each; rows, columns and maps are ``of`` something
"""

from __future__ import annotations

import itertools
import math
import string
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from validation.report.blocks import Beside, Blocks, Callout, FigureBlock, Heading, Paragraph, Points, Table, table
from validation.report.chapters.described import CaseColumn, Description
from validation.report.chapters.ledger import ledger_blocks
from validation.report.chapters.queries import Line, Query, StudyTable
from validation.report.chapters.scene import gate_count, history_block, opening, outcomes, scene_section
from validation.report.chapters.text import capital
from validation.report.figures.charts import ChartLine
from validation.report.figures.drawing import FigureHooks, scenes_figure
from validation.report.figures.histories import saved
from validation.report.figures.maps import MapScale, NumberMap, map_figure
from validation.report.figures.model import model_figure
from validation.runs.history import Array
from validation.runs.numbers import DASH
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Value
from validation.solvers.contract import Role
from validation.solvers.registry import by_role

NO_QUERY: Query = {}
COLUMN_FIELDS = {one.name for one in fields(CaseColumn)}
COUNTS = ("no", "one", "two", "three", "four", "five")
LINE_FIELDS = {one.name for one in fields(ChartLine)} - {"name", "x", "y", "shaded", "notes"}


@dataclass(frozen=True)
class WrittenChapter:
    """A chapter that is written from the table of its study."""

    page: Description
    table: StudyTable
    directory: Path  # of figures
    module: ModuleType | None = None  # with the functions that parts call

    def blocks(self, name: str = "parts") -> Blocks:
        """Return the blocks of all parts, or of those of another list."""
        blocks: Blocks = []
        for part in self.page.entries(name):
            needed = {*part.get("when", ()), *filter(None, [part.get("heading_of"), part.get("section")])}
            if not needed <= set(self.table.groups):
                continue
            if "heading_of" in part:
                part = part | {"heading": self.table.groups[part["heading_of"]].title}
            if part.get("each") == "scene":
                for group in self.table.groups.values():
                    blocks += self._part(part | {"heading": group.title}, {"of": group.name})
            else:
                blocks += self._part(part)
        return blocks

    def _part(self, part: Query, query: Query = NO_QUERY) -> Blocks:
        if "opening" in part:
            return self._opening(part)
        if "call" in part:
            blocks: Blocks = getattr(self.module, part["call"])(self.table, self.directory)
            return blocks
        if "sketch" in part:
            return self._sketch(part)
        if "points" in part:
            return self._pointed(part)
        if "section" in part:
            group = self.table.groups[part["section"]]
            without = tuple(by_role(Role.TRUTH)) if part.get("without") == "truth" else ()
            return scene_section(group, self.directory, part["columns"], without=without)
        if "ledger" in part:
            return ledger_blocks(list(self.table.groups.values()), self.table.manifest["study"], self.directory)
        if "outcomes" in part:
            callouts = itertools.chain.from_iterable(map(outcomes, self.table.groups.values()))
            return list(dict.fromkeys(callouts))[: part["outcomes"]]
        shown: Blocks = []
        if "where" in part:
            query = query | {"where": part["where"]}
        if "figure" in part:
            shown += self._figure(part["figure"], query, part.get("file", ""))
        if "maps" in part:
            shown += self._maps(part["maps"])
        if "table" in part:
            shown += self._table(part["table"], query)
        if "picture" in part:
            shown += self._picture(part["picture"])
        if "frames" in part:
            shown += self._frames(part["frames"])
        if {"figure", "maps", "table", "picture", "frames"} & set(part) and not shown:
            return []
        if "history" in part:
            shown.append(history_block(self.table.groups[part["history"]], part["columns"], self.directory))
        before = self._paragraph(part["text"], part) if "text" in part else []
        after = self._paragraph(part["after"], part) if "after" in part else []
        heading: Blocks = [Heading(part["heading"], part.get("level", 2))] if "heading" in part else []
        return [*heading, *before, *shown, *after]

    def _opening(self, part: Query) -> Blocks:
        lead = self.text(part["opening"]) if part["opening"] else ""
        remark = self.text(part["remark"]) if "remark" in part else ""
        return opening(self.table.manifest, self.table.verdicts if part.get("gates") else (), lead, remark)

    def _sketch(self, part: Query) -> Blocks:
        scene = self.table.groups[part["sketch"]].cases[0].scene
        figure = model_figure(f"a = {scene.block.side or 0:g} m", f"q = {scene.load.pressure / 1e6:g} MPa")
        beside = itertools.chain.from_iterable(map(self._part, part["beside"]))
        return [Beside((saved(figure, self.directory, "model.svg", ""),), tuple(beside), part["share"])]

    def _pointed(self, part: Query) -> Blocks:
        texts = {name: self.text(name) for name in part["points"]}
        items = tuple((self.text(f"{name}-question"), text) for name, text in texts.items() if text)
        return [Heading(part["heading"].format(count=COUNTS[len(items)]), 3), Points(items)]

    def _paragraph(self, name: str, part: Query) -> Blocks:
        text = self.text(name)
        if not text:
            return []
        tone = part.get("tone", "plain")
        return [Callout(text, tone) if tone in ("fail", "warn", "pass", "rule") else Paragraph(text, tone)]

    # ---- sentences ----

    def text(self, name: str) -> str:
        """Return a text with its numbers; where one is missing that of ``NAME-without``, or nothing."""
        text = self.page.text(name)
        values = {word: self._word(word) for _, word, _, _ in string.Formatter().parse(text) if word}
        if None in values.values():
            return self.text(f"{name}-without") if self.page.has("text", f"{name}-without") else ""
        return text.format_map(values)

    def _word(self, name: str) -> str | None:
        """Return what a name in a text stands for, None without a number."""
        if name == "gates":
            return f"{gate_count(self.table.verdicts).capitalize()}."
        if self.page.has("list", name):
            return self._list(self.page.described("list", name))
        number = self.page.described("number", name)
        return self._number(number, self.table.lines(number))

    def _number(self, number: Query, lines: Sequence[Line]) -> str | None:
        column = self._with_words(number | {"of": number["value"]})
        value = self.table.picked(lines, column)
        if value is None or (isinstance(value, str) and value not in column.get("words", {})):
            return value
        text = _written(column, value)
        is_whole = text == number.get("zero_text") or _key(value) in column.get("words", {})
        return text if is_whole else number.get("pattern", "{}").format(text)

    def _with_words(self, column: Query) -> Query:
        """Return a column, with the words that the study keeps under its ``words_of``."""
        return column | {"words": self.table.data.get(column["words_of"], {})} if "words_of" in column else column

    def _list(self, described: Query, lines: Sequence[Line] | None = None) -> str | None:
        """Return the lines of a list, or these, that have all their numbers, as one text."""
        texts = []
        asked = self.table.lines(described) if lines is None else lines
        for group in self.table.grouped(asked, described.get("group_by", ())):
            values = {name: self._number(number, group) for name, number in described["numbers"].items()}
            if None not in values.values():
                texts.append(described["text"].format_map(values))
        text: str = described.get("join", ", ").join(texts)
        return (capital(text) if described.get("capital") else text) or None

    # ---- tables ----

    def _table(self, name: str, query: Query = NO_QUERY) -> list[Table]:
        described = _within(self.page.described("table", name), query)
        if "notes_of" in described:
            described["notes"] = self.table.data.get(described["notes_of"], ())
        columns = [({"title": one} if isinstance(one, str) else one) for one in described["columns"]]
        rows: list[list[str]] = []
        previous: list[str] = []
        for group in self.table.grouped(self.table.lines(described), described.get("group_by", ())):
            cells = [self._cell(column, group) for column in columns]
            numbers = [text for text, column in zip(cells, columns, strict=True) if " " in column.get("of", "")]
            if described.get("measured") and set(numbers) == {DASH}:
                continue
            pairs = zip(cells, columns, previous or [""] * len(cells), strict=True)
            rows.append(["" if column.get("once") and text == above else text for text, column, above in pairs])
            previous = cells
        if not rows:
            return []
        rows = [[self._caption(cell) for cell in row] for row in described.get("first", [])] + rows
        look = {key: described[key] for key in ("notes", "ruled", "dense") if key in described}
        caption = self._caption(described.get("caption", ""))
        return [table([_column(column).head for column in columns], rows, caption, **look)]

    def _cell(self, column: Query, group: Sequence[Line]) -> str:
        if "list" in column:
            return self._list(self.page.described("list", column["list"]), group) or DASH
        column = self._with_words(column)
        value = self.table.picked(group, column)
        text = _written(column, value)
        if value is None:
            return str(column.get("missing", text))
        others = [self._cell(one, group) for one in column.get("also", ())]
        pattern: str = column.get("pattern", "{}")
        return pattern.format(text, *others)

    def _caption(self, text: str) -> str:
        values = {word: self._word(word) or DASH for _, word, _, _ in string.Formatter().parse(text) if word}
        return text.format_map(values) if values else text

    # ---- figures ----

    def _figure(self, name: str, query: Query = NO_QUERY, file: str = "") -> list[FigureBlock]:
        described = self.page.described("figure", name)
        if "each" in described:
            figures = (self._figure_of_cases(name, described | entry) for entry in described["each"])
            return list(itertools.chain.from_iterable(figures))
        panels = []
        for panel_name in described["panels"]:
            panel = self.page.described("panel", panel_name)
            lines: list[ChartLine] = []
            for line in panel["lines"]:
                lines += self._lines(_within(line, query))
            if lines:
                panels.append(self.page.panel(panel_name, lines, marks=self._marks(panel.get("marks", {}))))
        if not panels:
            return []
        caption = self._caption(described["caption"])
        scene = described.get("scene", "")
        return [self.page.figure(name, panels, self.directory, scene, whole_caption=caption, file=file)]

    def _marks(self, marks: Query) -> dict[str, float]:
        """Return marks, at a number or where one of the chapter stands, which their words may hold as well."""
        places: dict[str, float] = {}
        for words, place in marks.items():
            if isinstance(place, str):
                number = self.page.described("number", place)
                value = self.table.picked(self.table.lines(number), number | {"of": number["value"]})
                place = value * number.get("factor", 1.0) if isinstance(value, int | float) else math.nan
            places[self._caption(words)] = place
        return places

    def _figure_of_cases(self, name: str, described: Query) -> list[FigureBlock]:
        """Return a figure of histories over time steps, a panel for each case of a scene."""
        panel_name = described["panel"]
        panel = self.page.described("panel", panel_name)
        panels = []
        for case in self.table.lines({"of": described["of"]}):
            drawn: list[ChartLine] = []
            for line in panel["lines"]:
                where = line.get("where", {}) | {"case": self.table.value(case, "case")}
                own = {"of": described["of"], "where": where, "x_over": "time.step", "x_end": described["last"] + 0.5}
                drawn += self._lines(line | own)
            level = panel["level_factor"] * (self.table.number(case, panel["level_of"]) or 0.0)
            settled = self.table.number(case, panel["mark_of"]) if "mark_of" in panel else None
            parts: dict[str, Any] = {
                "title": self.table.value(case, "label"),
                "x_range": (0.0, float(described["last"])),
                "x_ticks": described["x_ticks"],
                "levels": {"": level},
                "marks": {} if settled is None else {f"{settled:.0f} steps": settled},
            }
            panels.append(self.page.panel(panel_name, drawn, **parts))
        if not any(panel.lines for panel in panels):
            return []
        remarks = [self.page.text("marked")] if any(panel.marks for panel in panels) else []
        if self.table.lines({"of": described["of"], "where": described["without"]}):
            remarks.append(self.page.text("without"))
        values = {key: described[key] for key in ("number", "words")} | {"remarks": "".join(remarks)}
        return [self.page.figure(name, panels, self.directory, **values)]

    def _picture(self, name: str) -> Blocks:
        """Return the first case of each scene as it is drawn."""
        described = self.page.described("picture", name)
        cut = []
        for scene, title in described["scenes"].items():
            for line in self.table.lines({"of": scene})[:1]:
                if line.case is not None:
                    cut.append((title, line.case.scene))
        if not cut:
            return []
        figure = scenes_figure(cut, described["height"])
        return [saved(figure, self.directory, described["file"], described["caption"])]

    def _frames(self, name: str) -> Blocks:
        """Return a motion at some instants, of the last case of a scene."""
        described = self.page.described("frames", name)
        for line in self.table.lines({"of": described["scene"]})[-1:]:
            history = None if line.case is None else line.case.histories.get(described["solver"])
            if line.case is None or history is None:
                continue
            steps = [int(np.argmin(np.abs(history.time - instant))) for instant in described["times"]]
            hooks = FigureHooks.of(line.case.scene)
            figure = hooks.frames(line.case.scene, history, steps, described["solver"], described["height"])
            if figure is not None:
                return [saved(figure, self.directory, described["file"], described["caption"])]
        return []

    def _lines(self, line: Query) -> Iterator[ChartLine]:
        """Yield the lines of an entry of a panel: one, or one for each value of ``each`` or history."""
        if "data" in line:
            yield from self._curves(line)
            return
        lines = self.table.lines(line)
        groups = self.table.grouped(lines, [line["each"]]) if "each" in line else [lines]
        if "history" in line:
            groups = [[one] for one in lines]
        colors = iter(line.get("colors", ()))
        for group in groups:
            if not group:
                continue
            drawn = self._history(line, group[0]) if "history" in line else self._points(line, group)
            if drawn is not None and len(drawn.x):
                key = self.table.value(group[0], line["each"]) if "each" in line else None
                colored = replace(drawn, color=next(colors, "")) if "colors" in line else drawn
                yield self._named(line, colored, group[0], key)

    def _named(self, line: Query, drawn: ChartLine, first: Line, key: Value) -> ChartLine:
        look = {name: line[name] for name in LINE_FIELDS if name in line}
        looks = line.get("looks", {})
        if isinstance(looks, str):
            looks = self.page.described("looks", looks)
        look |= looks.get(_key(key), {})
        look = {name: tuple(value) if isinstance(value, list) else value for name, value in look.items()}
        words = {name: str(value) for name, value in first.words.items()}
        for name, number in line.get("numbers", {}).items():
            words[name] = self._number(number, [first]) or DASH
        for part in ("name", "note"):
            look[part] = str(look.get(part, line.get(part, ""))).format(each=_key(key), **words)
        return replace(drawn, **look)

    def _points(self, line: Query, group: Sequence[Line]) -> ChartLine:
        """Return the points of the lines of the table that have both numbers."""
        if "x_ends" in line:  # a level, from end to end
            level = self.table.number(group[0], line["y"])
            return ChartLine("", np.array(line["x_ends"]), np.full(2, level or np.nan) * line.get("y_factor", 1.0))
        x_values = []
        y_values = []
        notes = []
        for row in group:
            x = self.table.number(row, line["x"])
            y = self.table.number(row, line["y"])
            if "absent" in line and (y is None) is line.get("only_absent", y is None):
                y = line["absent"] if y is None else y
            elif "absent" in line:
                y = None
            if x is not None and y is not None:
                x_values.append(x * line.get("x_factor", 1.0))
                y_values.append(y * line.get("y_factor", 1.0))
                if "note_of" in line:
                    notes.append(_written({"of": ""} | line["note_of"], self.table.value(row, line["note_of"]["of"])))
        return ChartLine("", np.array(x_values), np.array(y_values), notes=tuple(notes))

    def _history(self, line: Query, row: Line) -> ChartLine | None:
        """Return a column of a history over time, or the mean of some; it is only drawn."""
        history = None if row.case is None else row.case.histories.get(line["history"])
        if history is None:
            return None
        names = line["y"] if isinstance(line["y"], list) else [line["y"]]
        column = np.mean([history.columns[name] for name in names], axis=0)
        x, y = (
            values * line.get(f"{axis}_factor", 1.0) / self._unit(line, axis, row)
            for axis, values in (("x", history.time), ("y", column))
        )
        drawn = x < line.get("x_end", np.inf)
        return ChartLine("", x[drawn], y[drawn] + line.get("y_start", 0.0))

    def _unit(self, line: Query, axis: str, row: Line) -> float:
        """Return the number of a case in which a history is drawn."""
        return (self.table.number(row, line[f"{axis}_over"]) or np.nan) if f"{axis}_over" in line else 1.0

    def _curves(self, line: Query) -> Iterator[ChartLine]:
        """Yield the curves that the study keeps as plain data: one, or a list."""
        data: Any = self.table.data
        for key in line["data"].split("."):
            data = data.get(key, {})
        for curve in data if isinstance(data, list) else [data] if data else []:
            if not all(curve.get(key) in _as_list(value) for key, value in line.get("where", {}).items()):
                continue
            x, y = (_array(curve[line[axis]]) * line.get(f"{axis}_factor", 1.0) for axis in ("x", "y"))
            shaded = tuple(_array(curve[part]) for part in line["shaded"]) if "shaded" in line else None
            drawn = ChartLine("", x, y, shaded=shaded)  # type: ignore[arg-type]
            own = {key: value for key, value in curve.items() if isinstance(value, str)}
            yield self._named(line, drawn, Line("", words=own), curve.get(line.get("each", "")))

    # ---- maps ----

    def _maps(self, name: str) -> list[FigureBlock]:
        """Return maps of numbers over two expressions: a line a scene, a map an expression."""
        described = self.page.described("maps", name)
        rows = described["rows"]
        columns = described["columns"]
        lines = self.table.lines(described)
        row_values = sorted({self.table.number(one, rows["of"]) or 0.0 for one in lines})
        column_values = sorted({self.table.number(one, columns["of"]) or 0.0 for one in lines})
        if columns.get("descending"):
            column_values.reverse()
        grid = []
        for patterns in described["of"]:
            own = self.table.lines(described | {"of": patterns})
            if own:
                grid.append([self._map(one, own, described, row_values, column_values) for one in described["maps"]])
        if not any(np.isfinite(one.values).any() for row in grid for one in row):
            return []
        row_texts = [rows.get("pattern", "{}").format(_written(rows, value)) for value in row_values]
        column_texts = [_written(columns, value) for value in column_values]
        labels = columns.get("label", ""), rows.get("label", "")
        figure = map_figure(grid, row_texts, column_texts, labels, MapScale(*described["scale"]))
        caption = self._caption(described["caption"])
        file = described["file"].format(study=self.table.manifest["study"])
        return [saved(figure, self.directory, file, caption)]

    def _map(
        self, one: Query, lines: Sequence[Line], maps: Query, rows: Sequence[float], columns: Sequence[float]
    ) -> NumberMap:
        """Return a map: the number of each cell, shaded from ``from`` to ``to``."""
        values = np.full((len(rows), len(columns)), np.nan)
        texts: list[list[str]] = []
        for i, row in enumerate(rows):
            texts.append([])
            for j, column in enumerate(columns):
                where = {maps["rows"]["of"]: row, maps["columns"]["of"]: column} | one.get("where", {})
                value = self.table.picked(lines, one | {"where": where})
                if isinstance(value, int | float):
                    values[i, j] = _shade(one["shade"], value)
                texts[i].append(_written(one, value) if value is not None else maps.get("missing", DASH))
        return NumberMap(one["title"], values, texts)


def _within(described: Query, query: Query) -> Query:
    """Return a described query that meets a further one too."""
    return described | query | {"where": described.get("where", {}) | query.get("where", {})}


def _as_list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _shade(shade: Query, value: float) -> float:
    """Return how dark a value is, from 0 to 1: between two values, or as far from the first on either side."""
    low, high = shade["from"], shade["to"]
    if shade.get("logarithmic"):
        value, low, high = (math.log(max(one, 1e-300)) for one in (value, low, high))
    share: float = (value - low) / (high - low)
    return min(1.0, abs(share) if shade.get("either_side") else max(0.0, share))


def _column(column: Query) -> CaseColumn:
    return CaseColumn(**{"title": ""} | {key: value for key, value in column.items() if key in COLUMN_FIELDS})


def _key(value: Value) -> str:
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def _written(column: Query, value: Value) -> str:
    """Return a value as a column writes it: by its words, or as a number."""
    if _key(value) in column.get("words", {}):
        return str(column["words"][_key(value)])
    if isinstance(value, float | int) and abs(value) <= column.get("zero", -1.0):
        return str(column.get("zero_text", "0"))
    if isinstance(value, str) and ("without" in column or column.get("raw")):
        return value.removeprefix(column.get("without", ""))
    return _column(column).text(value)


def _array(values: Sequence[float | None]) -> Array:
    return np.array([np.nan if value is None else value for value in values])


def written_chapter(
    results: Results, manifest: Manifest, directory: Path, description: Path, module: ModuleType | None
) -> Blocks:
    """Return the chapter that a description writes."""
    return WrittenChapter(Description(description), StudyTable(results, manifest), directory, module).blocks()
