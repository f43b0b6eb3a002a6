"""Units other than those of SI, which the columns of other programs may be in, and how a column's name says so."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

# SI unit to others, and one of each in SI
OTHERS: Mapping[str, Mapping[str, float]] = {
    "s": {"ms": 1e-3, "us": 1e-6},
    "m": {"mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3},
    "Pa": {"kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5},
    "rad": {"deg": math.radians(1), "mrad": 1e-3},
    "m/s": {"mm/s": 1e-3, "cm/s": 1e-2, "km/s": 1e3},
    "N": {"kN": 1e3, "MN": 1e6},
}
WORDS = {"ms": "milliseconds", "us": "microseconds", "um": "micrometres", "deg": "degrees"}
_BRACKETED = re.compile(r"(.*\S)\s*[\[(]\s*(\S+)\s*[\])]")


def in_names(symbol: str) -> str:
    """Return a unit as names carry it, m_per_s of m/s."""
    return symbol.replace("/", "_per_")


def named(column: str, unit: str) -> str:
    """Return a column with its unit in its name, as tables of answers have it."""
    return f"{column}_{in_names(unit)}" if unit else column


def recognised(text: str, units: Mapping[str, str]) -> tuple[str, float] | None:
    """Return which column a header names, and the factor by which its values become SI; None where it names none.

    Parameters
    ----------
    text
        What stands in the header: ``displacement``, ``displacement_mm``, ``displacement [mm]``, in any case but that of
        the unit.
    units
        The columns that are known, and the SI unit of each.
    """
    bracketed = _BRACKETED.fullmatch(text)
    if bracketed:
        text = f"{bracketed[1]}_{in_names(bracketed[2])}"
    for column, unit in units.items():
        if text.casefold() in (column.casefold(), named(column, unit).casefold()):
            return column, 1.0
        if text[: len(column) + 1].casefold() == f"{column}_".casefold():
            for symbol, factor in OTHERS.get(unit, {}).items():
                if text[len(column) + 1 :] == in_names(symbol):
                    return column, factor
    return None


def ratios(unit: str) -> dict[float, str]:
    """Return the other units in words, by what a value in each is over the value in SI."""
    return {1 / factor: WORDS.get(symbol, symbol) for symbol, factor in OTHERS.get(unit, {}).items()}
