"""Names and titles of users in characters that figures and pages can show."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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
        manifest: Manifest = _mapped(super().manifest(self._files.get(study, study)))
        return manifest

    def verdicts(self, study: str | None = None) -> list[VerdictRecord]:
        """Return the verdicts, of one study or of all."""
        verdicts: list[VerdictRecord] = _mapped(super().readable_verdicts())
        return [v for v in verdicts if study is None or v["study"] == study]


def _mapped(data: Any) -> Any:
    """Return plain data with every text escaped, but those under the keys that are not shown."""
    if isinstance(data, str):
        return escaped(data)
    if isinstance(data, Mapping):
        return {key: value if key in NOT_SHOWN else _mapped(value) for key, value in data.items()}
    return [_mapped(value) for value in data] if isinstance(data, Iterable) else data
