"""The table of a study, and queries of it: what chapters show and say is looked up here, and computed nowhere.

A *line* of the table is a case, one solver of a case, or a derived row. A query is a table of a chapter's description:

    of = ["slope-*"]                names of scenes, or of what owns derived rows, in this order
    scene = "methods-locked-{method}"   or scenes of such names, whose words become expressions; or a list of these
    where = { "time.delta" = 0.5 }  what must stand in an expression, or in one of a list; { data = "x" } is a list
                                    that the study keeps
    row = "dda at {blocks} blocks"  the derived rows of such names, whose words become expressions
    metric = "piece {piece}"        of these the metrics of such names, a line each: "piece" and "value" are its words
    by = "solver"                   a line for each solver of a case, or for each "gate", with its verdict's words
    sort = "time.step"              an expression, or a list of them

An expression looks up in a line:

    "time.step"                     a datum of the scene
    "label", "scene", "title"       of the case within its scene, of its scene; "case": scene, and label if several
    "dda mode1.frequency"           a metric of a solver; of that of the line, "* mode1.frequency"
    "dda work.unknowns"             work, seconds and their sum, "dda seconds"; "dda outcome"
    "dda|fem displacement.l2"       a metric of a pair
    "closed: drag"                  a metric of the derived row `closed` of the case, or of its scene
    "bars/pieces: piece 1"          the same of another owner, which may hold words, "impact-{method}/map: mean"
    ": wave.left"                   a metric of the line's own derived row
    "blocks"                        a word of its name
    "a else b"                      the first of two that says something
"""

from __future__ import annotations

import fnmatch
import itertools
import math
import operator
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from validation.report.chapters.data import CaseGroup, CaseResults, groups_of_studies
from validation.runs.case_name import scene_of
from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Metrics, Value

Query = dict[str, Any]
NO_NUMBERS = ("undefined", "not reported", "alias")  # words in the place of a number
PLACEHOLDER = re.compile(r"\\\{(\w+)\\\}")


@dataclass(frozen=True)
class Line:
    """A line of the table of a study."""

    name: str  # of the case, or of the owner of a derived row
    group: CaseGroup | None = None
    case: CaseResults | None = None
    words: Metrics = field(default_factory=dict)  # what the name of a derived row, or a split, says
    metrics: Metrics = field(default_factory=dict)  # of the derived row


class StudyTable:
    """The table of a study; of several the scenes and rows of all, the rest of the first."""

    def __init__(self, results: Results, *manifests: Manifest, drawn: bool = True) -> None:
        self.manifest = manifests[0]
        self.groups = groups_of_studies(results, manifests, drawn)
        rows = itertools.chain.from_iterable(manifest.get("derived", []) for manifest in reversed(manifests))
        self.derived: Mapping[tuple[str, str], Mapping[str, Any]] = {
            (row["scene"], row["name"]): row["metrics"] for row in rows
        }
        self.verdicts = results.verdicts(self.manifest["study"])
        self.data: Mapping[str, Any] = self.manifest.get("data") or {}
        self.cases = {case.name: (group, case) for group in self.groups.values() for case in group.cases}

    def lines(self, query: Query) -> list[Line]:
        """Return the lines that a query asks for."""
        every = self._with_rows(query) if "row" in query else self._of_cases(query)
        lines = [line for line in every if self._meets(line, query.get("where", {}))]
        for expression in reversed(_listed(query.get("sort", ()))):
            lines.sort(key=lambda line, by=expression: _order(self.value(line, by)))  # type: ignore[misc]
        return lines

    def _of_cases(self, query: Query) -> Iterator[Line]:
        for group, words in self._groups_of(query):
            for case in group.cases:
                line = Line(case.name, group, case, words)
                if query.get("by") == "solver":
                    for solver in case.rows:
                        yield replace(line, words={**words, "solver": solver})
                elif query.get("by") == "gate":
                    for verdict in (one for one in group.verdicts if one["scene"] == case.name):
                        low, high = verdict["band"]
                        judged = {"metric": verdict["metric"], "value": verdict["value"], "low": low, "high": high}
                        until = verdict["id"].partition("@")[2].removesuffix("s")
                        judged |= {"pair": "|".join(verdict["pair"]), "until": _number(until)}
                        yield replace(line, words={**words, **judged})
                else:
                    yield line

    def _groups_of(self, query: Query) -> Iterator[tuple[CaseGroup, Metrics]]:
        for pattern in _listed(query.get("scene", ())):
            for name, group in self.groups.items():
                if match := _pattern(pattern).fullmatch(name):
                    yield group, _words(match)
        for pattern in () if "scene" in query else _listed(query.get("of", "*")):
            for name in fnmatch.filter(self.groups, pattern):
                yield self.groups[name], {}

    def _with_rows(self, query: Query) -> Iterator[Line]:
        """Yield the derived rows whose names follow a pattern, in their owners' order."""
        pattern = _pattern(query["row"])
        for wanted in _listed(query.get("scene") or query.get("of") or "*"):
            for (owner, name), metrics in self.derived.items():
                match = pattern.fullmatch(name)
                words = _words_of_owner(owner, wanted)
                if match and words is not None:
                    group, case = self.cases.get(owner, (self.groups.get(scene_of(owner)), None))
                    line = Line(owner, group, case, {**words, **_words(match)}, metrics)
                    yield from _by_metric(line, query["metric"]) if "metric" in query else [line]

    def value(self, line: Line, expression: str) -> Value:
        """Return what an expression says of a line, None where there is nothing."""
        if expression in line.words:
            return line.words[expression]
        first, otherwise, second = expression.partition(" else ")
        if otherwise:
            value = self.value(line, first)
            return self.value(line, second) if value is None else value
        row, colon, metric = expression.rpartition(": ")
        if colon:
            return self._of_row(line, row, metric)
        if expression == "scene":
            return scene_of(line.name)
        if expression == "title" and line.group is not None:
            return line.group.title
        if line.case is None or line.group is None:
            return None
        if expression == "case":
            return f"{line.group.name} {line.case.label}" if len(line.group.cases) > 1 else line.group.name
        return value_of_case(line.case, line.group, expression.replace("*", str(line.words.get("solver", ""))))

    def _of_row(self, line: Line, row: str, metric: str) -> Value:
        if not row:
            return line.metrics.get(metric)
        owner, slash, name = row.rpartition("/")
        owner = owner.format_map({word: str(value) for word, value in line.words.items()})
        owners = (owner,) if slash else (line.name, scene_of(line.name))
        for candidate in owners:
            if (candidate, name) in self.derived:
                value = self.derived[candidate, name].get(metric)
                return value
        return None

    def number(self, line: Line, expression: str) -> float | None:
        """Return a value where it is a finite number."""
        value = self.value(line, expression)
        is_number = isinstance(value, int | float) and math.isfinite(value)
        return float(value) if is_number else None  # type: ignore[arg-type]

    def picked(self, lines: Iterable[Line], column: Query) -> Value:
        """Return the value of a column in some lines: of the first that has one, or as ``pick`` says.

        ``pick`` is ``"most"`` or ``"least"``, of the values, or of the expression ``among``; ``"count"`` counts lines,
        ``"tally"`` lines by value. ``where`` says what a line must meet, ``unless`` what it must not.
        """
        expression = column["of"]
        chosen = [line for line in lines if self._meets(line, column.get("where", {}))]
        if "unless" in column:
            chosen = [line for line in chosen if not self._meets(line, column["unless"])]
        pick = column.get("pick")
        if pick == "count":
            return len(chosen) or (None if column.get("positive") else 0)
        if pick == "tally":
            counts = Counter(str(self.value(line, expression)) for line in chosen)
            return ", ".join(f"{value} {count}" for value, count in counts.items()) or None
        if pick is None:
            values = (self.value(line, expression) for line in chosen)
            return next((value for value in values if value is not None), None)
        among = column.get("among") or expression
        numbered = []
        for line in chosen:
            number = self.number(line, among)
            if number is not None and self.value(line, expression) is not None:
                numbered.append((number, line))
        if not numbered:
            return None
        best = (max if pick == "most" else min)(numbered, key=operator.itemgetter(0))
        return self.value(best[1], expression)

    def _meets(self, line: Line, where: Mapping[str, Any]) -> bool:
        for expression, wanted in where.items():
            if isinstance(wanted, dict):
                wanted = self.data.get(wanted["data"], [])
            if not _is_among(self.value(line, expression), wanted if isinstance(wanted, list) else [wanted]):
                return False
        return True

    def grouped(self, lines: Sequence[Line], expressions: Sequence[str]) -> list[list[Line]]:
        """Return lines in groups of one value in each expression, ordered by first lines; else one by one."""
        if not expressions:
            return [[line] for line in lines]
        groups: dict[tuple[Value, ...], list[Line]] = {}
        for line in lines:
            groups.setdefault(tuple(self.value(line, one) for one in expressions), []).append(line)
        return list(groups.values())


def value_of_case(case: CaseResults, group: CaseGroup | None, expression: str) -> Value:
    """Return its label, a datum of its scene, a metric of a solver, or one of a compared pair."""
    if expression == "label":
        return case.label
    source, _, metric = expression.partition(" ")
    if not metric:
        try:
            value = operator.attrgetter(source)(case.scene)
        except AttributeError:  # of a table that the scene has not
            return None
        if isinstance(value, bool) or not isinstance(value, int | float | str | None):
            return str(value)
        return value
    solver, _, reference = source.partition("|")
    if reference:
        return group.number_of_pair(case, solver, reference, metric) if group else None
    return _of_solver(case, solver, metric)


def _pattern(text: str) -> re.Pattern[str]:
    """Return what names follow in which words stand in braces."""
    return re.compile(PLACEHOLDER.sub(r"(?P<\1>.+)", re.escape(text)))


def _words(match: re.Match[str]) -> dict[str, Value]:
    return {word: _number(text) for word, text in match.groupdict().items()}


def _words_of_owner(owner: str, wanted: str) -> dict[str, Value] | None:
    """Return the words of the owner of a row, or of its scene, None where it is another."""
    for name in (owner, scene_of(owner)):
        if match := _pattern(wanted).fullmatch(name):
            return _words(match)
        if fnmatch.fnmatchcase(name, wanted):
            return {}
    return None


def _by_metric(line: Line, text: str) -> Iterator[Line]:
    pattern = _pattern(text)
    for name, value in line.metrics.items():
        if match := pattern.fullmatch(name):
            yield replace(line, words={**line.words, **_words(match), "value": value})


def _listed(value: str | Sequence[str]) -> Sequence[str]:
    return [value] if isinstance(value, str) else value


def _number(text: str) -> Value:
    """Return a word, as a number where it is one."""
    try:
        return float(text)
    except ValueError:
        return text


def _order(value: Value) -> tuple[bool, float, str]:
    """Return a key that sorts numbers before words."""
    is_number = isinstance(value, int | float)
    return (not is_number, float(value) if is_number else 0.0, "" if is_number else str(value))  # type: ignore[arg-type]


def _is_among(value: Value, wanted: Sequence[Value]) -> bool:
    for one in wanted:
        if isinstance(value, int | float) and isinstance(one, int | float):
            if math.isclose(value, one):
                return True
        elif value == one:
            return True
    return False


def _of_solver(case: CaseResults, solver: str, metric: str) -> Value:
    row = case.rows.get(solver)
    if row is None:
        return None
    part, _, name = metric.partition(".")
    if part == "seconds":
        return row.seconds.get(name) if name else sum(row.seconds.values())
    if part == "work":
        return row.work.get(name)
    if metric == "outcome":
        return str(row.outcome)
    value = row.metrics.get(metric)
    return value if isinstance(value, str) and value not in NO_NUMBERS else case.number(solver, metric)
