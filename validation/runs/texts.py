"""Texts in tables: TOML files in which ``{name}`` stands for a value and ``{name:percent}`` for a number in a form."""

from __future__ import annotations

import string
from pathlib import Path
from typing import Any

from validation.runs.beside import table_beside
from validation.runs.numbers import FORMS


class NumberFormatter(string.Formatter):
    """Texts in which a number may stand in one of `FORMS`, ``{name:short 3}`` with its digits."""

    def format_field(self, value: Any, format_spec: str) -> Any:
        """Return a value as its form says, or as Python's format code does."""
        form, _, digits = format_spec.rpartition(" ") if format_spec[-1:].isdigit() else (format_spec, "", "4")
        return FORMS[form](value, int(digits)) if form in FORMS else super().format_field(value, format_spec)


FILLED = NumberFormatter()


class Texts:
    """The texts of the TOML file beside a module, ``[text]`` in it."""

    def __init__(self, module: str | Path) -> None:
        self._data = table_beside(module)

    def text(self, name: str, /, *places: Any, **values: Any) -> str:
        """Return a text with its values, ``{0}`` and ``{name}``."""
        text = self._data["text"][name]
        return FILLED.vformat(text, places, values) if places or values else text
