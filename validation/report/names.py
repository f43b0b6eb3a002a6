"""Names and titles of users in characters that figures and pages can show."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import Any

from validation.runs.records import Manifest, VerdictRecord
from validation.runs.results import Results
from validation.runs.text import shown, visible

DOLLAR = "$"  # between two bare ones a figure sets mathematics
ESCAPED = r"\$"
NOT_SHOWN = ("definition", "key", "data")  # parts of a manifest that are read, not shown


def escaped(text: str) -> str:
    """Return a text for figures: control characters and lone surrogates as escapes, dollars with a backslash."""
    return shown(text).replace(DOLLAR, ESCAPED)


def unescaped(text: str) -> str:
    """Return a text for pages, which know no escaped dollar."""
    return visible(text).replace(ESCAPED, DOLLAR)


class Readable(Results):
    """A results directory whose names and titles can be shown."""

    def __init__(self, results: Results) -> None:
        super().__init__(results.directory)
        self._files = {escaped(name): name for name in results.studies()}

    def studies(self) -> list[str]:
        """Return the names of the studies."""
        return list(self._files)

    def manifest(self, study: str) -> Manifest:
        """Return a study's manifest."""
        manifest: Manifest = with_texts(super().manifest(self._files.get(study, study)), escaped, NOT_SHOWN)
        return manifest

    def verdicts(self, study: str | None = None) -> list[VerdictRecord]:
        """Return the verdicts, of one study or of all."""
        verdicts: list[VerdictRecord] = with_texts(super().readable_verdicts(), escaped, NOT_SHOWN)
        return [v for v in verdicts if study is None or v["study"] == study]


def with_texts(data: Any, change: Callable[[str], str], skipped: Collection[str] = ()) -> Any:
    """Return plain data with every text changed, but those under the keys that are skipped."""
    if isinstance(data, str):
        return change(data)
    if isinstance(data, Mapping):
        return {key: data[key] if key in skipped else with_texts(data[key], change, skipped) for key in data}
    return [with_texts(value, change, skipped) for value in data] if isinstance(data, Iterable) else data
