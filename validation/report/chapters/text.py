"""Values, swept values and data of scenes as the report writes them."""

from __future__ import annotations

import functools
import math
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path
from typing import Any

from validation.report.scene.hooks import ShowingHooks
from validation.runs.case_name import CaseName
from validation.runs.numbers import DASH, percent, plain, short
from validation.runs.row import Value
from validation.runs.text import shown
from validation.scenes.keys import key_of_any_entry, keys_of, stated_value
from validation.scenes.scene import Scene, tables_of_scenes

AS_STATED = "as stated"  # label of a case without swept values
_MEANINGS = (
    ("alias", "alias", "the frequency lies beyond π/Δt, and samples every Δt show another."),
    ("not reported", "n. r.", "not reported, the solver does not give what the metric needs."),
)
_WORDS = {word: short_word for word, short_word, _ in _MEANINGS}
UNITS = str.maketrans("23", "²³")

ALWAYS = {  # data that are written at their defaults too
    "block.poisson", "block.hypothesis", "time.alpha", "time.delta", "time.start", "fem.degree", "fem.foundation",
}  # fmt: skip
NEWMARK_DATA = {"time.alpha", "time.delta"}  # which no other scheme has
NO_DATA = {  # edges of a polygon, the cut of which the blocks are counted, and what is run
    "block.base", "block.top", "plane.subdivide", "run.solvers", "run.columns",
}  # fmt: skip


def capital(text: str) -> str:
    """Return a sentence with a capital letter."""
    return text[:1].upper() + text[1:]


def some(names: Iterable[str], most: int) -> str:
    """Return the first few of some names, each once, and how many more there are."""
    distinct = list(dict.fromkeys(names))
    more = len(distinct) - most
    first = ", ".join(distinct[:most])
    return f"{first}, {more} more" if more > 0 else first


def span(values: Sequence[float]) -> str:
    """Return the range of fractions, ``0.26 % to 9.0 %``; one value where they read alike."""
    low = percent(min(values))
    high = percent(max(values))
    return low if low == high else f"{low} to {high}"


def range_of(values: Iterable[float]) -> str:
    """Return the range of some numbers, ``0.1 to 0.5``."""
    ordered = sorted(values)
    return " to ".join(dict.fromkeys(short(value, 3) for value in (ordered[0], ordered[-1])))


def cell(value: Value) -> str:
    """Return a metric as a table cell: a number, its word, or a dash."""
    if value is None:
        return DASH
    return _WORDS.get(value, value) if isinstance(value, str) else plain(value)


def word_notes(values: Iterable[Value]) -> tuple[str, ...]:
    """Return what the short words in cells stand for."""
    words = set(values)
    return tuple(f"{short_word}: {meaning}" for word, short_word, meaning in _MEANINGS if word in words)


def case_labels(names: Sequence[str], scenes: Sequence[Scene]) -> list[str]:
    """Return a short label per case of one scene: the swept values in the symbols of the text."""
    full = list(map(case_label, names, scenes))
    short = [case_label(name, scene, {"time.steps"}) for name, scene in zip(names, scenes, strict=True)]
    return short if len(set(short)) == len(short) else full


def case_label(name: str, scene: Scene, without: Collection[str] = ()) -> str:
    """Return the swept values of a case in the symbols of the text, without some fields."""
    parts = []
    for field, value in CaseName.parse(name).values.items():
        if field in without:
            continue
        symbol, unit = _symbol(field)
        if field == "contact.stiffness":
            unit = ""
            value = f"{scene.contact.stiffness / scene.block.young:.4g}E"
        elif unit == " Pa":
            value, unit = _pressure(value)
        parts.append((f"{symbol} = {value}{unit}" if symbol else value).replace("-", "−"))
    return ", ".join(parts) or AS_STATED


@functools.cache
def _symbol(field: str) -> tuple[str, str]:
    """Return the symbol of a key and its unit."""
    tables = tables_of_scenes()
    place, _, name = key_of_any_entry(field, tables).rpartition(".")
    table = tables.get(place)
    for key_name, _, key in keys_of(table) if table is not None else ():
        if key_name == name:
            unit = "°" if key.unit == "deg" else f" {key.unit.translate(UNITS)}".rstrip()
            unit = "E" if field == "block.glue_ratio" else unit
            return name.replace("_", " ") if key.symbol is None else key.symbol, unit
    return name.replace("_", " "), ""


def _pressure(text: str) -> tuple[str, str]:
    """Return a pressure, or the components of a stress, in MPa where they are large; a zero needs no unit."""
    values = [float(part) for part in text.split("x")]
    largest = max(map(abs, values))
    if largest == 0:
        return "0", ""
    factor, unit = (1e-6, " MPa") if largest >= 1e4 else (1.0, " Pa")
    return ", ".join(f"{factor * value:g}" for value in values), unit


def parameters(scene: Scene, varied: set[str]) -> str:
    """Return the data of a scene in one line, without the varied fields."""
    return f"{', '.join(parameter_items(scene, varied))}."


def parameter_items(scene: Scene, varied: set[str]) -> list[str]:
    """Return the data of a scene by symbol or key, without the varied fields."""
    hooks = ShowingHooks.of(scene)
    items = list(hooks.bodies(scene, varied))
    for place, table in scene.tables().items():
        for name, field, _ in keys_of(type(table)):
            path = f"{place}.{name}"
            value = stated_value(table, name)
            is_default = value is None or (value == field.default and path not in ALWAYS)
            is_newmarks = path in NEWMARK_DATA and scene.time.scheme != "newmark"
            if path in varied | NO_DATA | hooks.no_data or is_default or is_newmarks:
                continue
            symbol, unit = _symbol(path)
            items.append(f"{symbol} = {written(value)}{unit}" if symbol else f"{written(value)}{unit}")
    return items


def written(value: Any) -> str:
    """Return a value in words: of a file its name, of a list of more than numbers its length."""
    if isinstance(value, tuple):
        is_plain = all(isinstance(part, int | float) for part in value)
        return ", ".join(map(written, value)) if is_plain else str(len(value))
    if isinstance(value, str):
        return shown(Path(value).name)
    return str(value) if isinstance(value, bool) else short(value)


def load_size(scene: Scene) -> float:
    """Return the size of the pressure on a block [Pa], beside which smaller ones are rounding; else there is none."""
    load = scene.stated_load
    return math.inf if load is None else abs(load.pressure)
