"""Units other than those of SI, which the columns of other programs may be in, and how a column's name says so."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping
from typing import TypeVar

from validation.errors import InputError

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
Value = TypeVar("Value")
_BRACKETED = re.compile(r"(.*\S)\s*[\[(]\s*(\S+)\s*[\])]")


def in_names(symbol: str) -> str:
    """Return a unit as names carry it, m_per_s of m/s."""
    return symbol.replace("/", "_per_")


def named(column: str, unit: str) -> str:
    """Return a column or a key with its unit in its name, as tables of answers and data of problems have it."""
    return f"{column}_{in_names(unit)}" if unit else column


def recognised(text: str, units: Mapping[str, str]) -> tuple[str, float] | None:
    """Return which column a header names, and the factor by which its values become SI; None where it names none.

    It is ``displacement``, ``displacement_mm`` or ``displacement [mm]``, in any case but that of the unit; `units`
    are the SI units of the known columns.
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


def theirs_of(text: str | None, ours: Collection[str]) -> dict[str, str]:
    """Return what a file calls columns, of ``time=t,displacement=uy``: our column to theirs.

    Raises
    ------
    InputError
        A part is not ours=theirs, or names no column of ours.
    """
    return _pairs(text, "--columns", "THEIRS", ours, str)


def factors_of(text: str | None, ours: Collection[str]) -> dict[str, float]:
    """Return the factors by which a file's numbers become SI, of ``displacement=-1e-3``.

    Raises
    ------
    InputError
        A part is not ours=factor, or a factor is no finite number other than zero.
    """

    def factor(number: str) -> float:
        value = float(number)
        if not math.isfinite(value) or value == 0:
            raise ValueError
        return value

    return _pairs(text, "--scale", "FACTOR", ours, factor)


def _pairs(
    text: str | None, option: str, theirs: str, ours: Collection[str], parsed: Callable[[str], Value]
) -> dict[str, Value]:
    """Return what stands behind each of our columns in ``OURS=THEIRS,OURS=THEIRS``, as a function parses it."""
    pairs = {}
    try:
        for part in filter(str.strip, (text or "").split(",")):
            name, _, value = map(str.strip, part.partition("="))
            if not value or name not in ours:
                raise ValueError
            pairs[name] = parsed(value)
    except ValueError:
        rule = f"must be OURS={theirs} with ours among {', '.join(ours)}"
        raise InputError(rule, field=option, value=repr(text)) from None
    return pairs
