"""Names and titles of users in characters that figures and pages can show."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import cached_property
from typing import Any

from validation.runs.history import History
from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.text import shown, visible
from validation.suite.folders import study_names

DOLLAR = "$"  # between two bare ones a figure sets mathematics
KEY = re.compile(r"@(?=[a-z]+[0-9]{4}\b)")  # what would cite a source
NOT_SHOWN = ("definition", "key", "data")  # parts of a manifest that are read, not shown


def escaped(text: str) -> str:
    """Return a text for figures: control characters and lone surrogates as escapes, dollars with a backslash."""
    return shown(text).replace(DOLLAR, rf"\{DOLLAR}")


def quoted(text: str) -> str:
    """Return a user's text for figures and pages, in which nothing is a citation."""
    return KEY.sub(r"\\@", escaped(text))


def page_name(study: str) -> str:
    """Return the name of a study in figures and pages: only those of the suite cite sources."""
    return _change(study)(study)


def unescaped(text: str, cited: Callable[[str], str] = str) -> str:
    """Return a text for pages, which know no escapes; `cited` marks the citations in it before."""
    return cited(visible(text)).replace(rf"\{DOLLAR}", DOLLAR).replace(r"\@", "@")


class Readable(Results):
    """A results directory whose names and titles can be shown."""

    def __init__(self, results: Results) -> None:
        super().__init__(results.directory)
        self._files = {page_name(name): name for name in results.studies()}

    def studies(self) -> list[str]:
        """Return the names of the studies."""
        return list(self._files)

    def manifest(self, study: str) -> Manifest:
        """Return a study's manifest."""
        name = self._files.get(study, study)
        manifest: Manifest = with_texts(super().manifest(name), _change(name), NOT_SHOWN)
        return manifest

    def verdicts(self, study: str | None = None) -> list[VerdictRecord]:
        """Return the verdicts, of one study or of all."""
        names = {v["study"] for v in self._readable_verdicts}
        asked = {name: _change(name) for name in names if study is None or page_name(name) == study}
        return [with_texts(v, asked[v["study"]], NOT_SHOWN) for v in self._readable_verdicts if v["study"] in asked]

    @cached_property
    def _readable_verdicts(self) -> list[VerdictRecord]:
        """The verdicts as kept, read once: every chapter asks for its own."""
        return super().readable_verdicts()

    def history(self, key: str) -> History | None:
        """Return a history, whose columns may have a user's names."""
        history = super().history(key)
        if history is None:
            return None
        columns = {escaped(name): values for name, values in history.columns.items()}
        return History(history.time, columns, history.between)  # an exact motion has no columns of a user's


def _change(study: str) -> Callable[[str], str]:
    """Return what makes the texts of a study showable."""
    return escaped if study in study_names() else quoted


def with_texts(data: Any, change: Callable[[str], str], skipped: Collection[str] = ()) -> Any:
    """Return plain data with every text changed but those under skipped keys."""
    if isinstance(data, str):
        return change(data)
    if isinstance(data, Mapping):
        return {key: data[key] if key in skipped else with_texts(data[key], change, skipped) for key in data}
    return [with_texts(value, change, skipped) for value in data] if isinstance(data, Iterable) else data
