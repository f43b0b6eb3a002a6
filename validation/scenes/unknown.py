"""Unknown keys of a scene: all of them, each with the key that was probably meant."""

from __future__ import annotations

import difflib
import functools
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from validation.errors import InputError
from validation.runs.beside import table_beside
from validation.scenes.keys import Section, key_of_any_entry, keys_of
from validation.scenes.kinds import kinds

OTHER_NAMES: dict[str, list[str]] = table_beside(__file__, "other_names.toml")
SHORTEST = 3  # letters of a name that another may be spelt like
CLOSE = 0.6  # similarity of two names from which on one may be meant for the other
NAMED = 30  # unknown keys that are named in full


def refuse_unknown_keys(data: Mapping[str, Any], tables: Mapping[str, type[Section]], source: str) -> None:
    """Raise one InputError for all keys that are none, with those that were probably meant as its advice.

    `tables` are those that a scene may have, the scene itself under the empty name; `source` is the file or the scene.
    """
    unknown = list(_unknown_keys(data, "", "", tables))
    if not unknown:
        return
    every = list(kinds().values())
    kind = next((kind for kind in reversed(every) if kind.name in data), every[0])
    absent = [*kind.refuses]
    for other in every:
        if other is not kind:
            absent += other.tables
    known_keys = []
    for place, _table in tables.items():
        if place and place.partition(".")[0] not in absent:
            known_keys += [f"{place}.{key}" for key in _names(place, tables)]
    suggestions = {}
    for place, stated_at, name, value in unknown:
        # What stands in a table of an unknown name is not looked up: the table's name comes first.
        candidates = [] if isinstance(value, dict) else known_keys
        if suggestion := _meant(place, name, tables, candidates):
            suggestions[f"{stated_at}{name}"] = suggestion
    fields = [f"{stated_at}{name}" for _, stated_at, name, _ in unknown]
    more = f" and {len(fields) - NAMED} more" if len(fields) > NAMED else ""
    if len(fields) == 1:
        suggestion = suggestions.get(fields[0])
        advice = "dda-validate list keys names all" if suggestion is None else f"did you mean {suggestion}?"
        raise InputError("unknown key", source=source, field=fields[0], value=clip(unknown[0][3]), advice=advice)
    questions = [f"{suggestions[field]} for {field}" for field in fields[:NAMED] if field in suggestions]
    advice = f"did you mean {', '.join(questions)}? " if questions else ""
    raise InputError(
        "unknown keys",
        source=source,
        field=", ".join(fields[:NAMED]) + more,
        advice=f"{advice}dda-validate list keys names all",
    )


def _names(place: str, tables: Mapping[str, type[Section]]) -> tuple[str, ...]:
    """Return the names of a table's keys as a file states them; the name of a scene is that of its file."""
    return _names_of(tables[place], not place)


@functools.cache  # asked for every table of every case of a sweep
def _names_of(table: type[Section], is_scene: bool) -> tuple[str, ...]:
    names = [field.alias or name for name, field in table.model_fields.items()]
    return tuple(name for name in names if not (is_scene and name == "name"))


def _unknown_keys(
    data: Mapping[str, Any], place: str, stated_at: str, tables: Mapping[str, type[Section]]
) -> Iterator[tuple[str, str, str, Any]]:
    """Yield table, its place in the file, name and value of the unknown keys of a table and of those in it."""
    names = _names(place, tables)
    for name, value in data.items():
        inside = f"{place}.{name}" if place else name
        if name not in names:
            yield place, stated_at, name, value
        elif inside == "sweep" and isinstance(value, dict) and value:  # that of a single case is empty
            keys = {"mode", "name", *tables, *_names("", tables)}  # what is no key of a table is refused elsewhere
            keys |= {f"{table}.{key}" for table in tables for key in _names(table, tables)}
            unknown = (field for field in value if key_of_any_entry(field, tables) not in keys)
            yield from (("sweep", "sweep.", field, value[field]) for field in unknown)
        elif inside in tables and isinstance(value, dict):
            yield from _unknown_keys(value, inside, f"{stated_at}{name}.", tables)
        elif inside in tables and isinstance(value, list):
            for number, entry in enumerate(value):
                if isinstance(entry, dict):
                    yield from _unknown_keys(entry, inside, f"{stated_at}{name}.{number}.", tables)


def _meant(place: str, name: str, tables: Mapping[str, type[Section]], elsewhere: list[str]) -> str | None:
    """Return the key that a name in a table was probably meant for.

    In this order: a key of this table, a key elsewhere, of which it is the name or another one; a name in this table
    that is spelt alike, and one elsewhere.
    """
    if place == "sweep":
        place, _, name = key_of_any_entry(name, tables).rpartition(".")
        if place not in tables:
            return None
    prefix = f"{place}." if place else ""
    here = [f"{prefix}{key}" for key in _names(place, tables)]
    named_here = _fields_by_name(here, tables)
    named_elsewhere = _fields_by_name(elsewhere, tables)
    plain = _plain(name)
    for fields in (named_here, named_elsewhere):
        if plain in fields:
            return fields[plain]
    for fields in (named_here, named_elsewhere):
        words = [word for word in fields if len(word) >= SHORTEST]
        if near := difflib.get_close_matches(plain, words, n=1, cutoff=CLOSE):
            return fields[near[0]]
    return None


def _fields_by_name(fields: list[str], tables: Mapping[str, type[Section]]) -> dict[str, str]:
    """Return fields by all that they are called, plainly: their names, symbols, and other programs' names."""
    by_name = {_plain(field.rpartition(".")[2]): field for field in reversed(fields)}
    for field in reversed(fields):
        place, _, name = field.rpartition(".")
        symbols = [key.symbol for key_name, _, key in keys_of(tables[place]) if key_name == name]
        block_field = field.replace("column.layer.", "block.")  # a layer's material is called as a block's
        for other in (*OTHER_NAMES.get(block_field, ()), *filter(None, symbols)):
            by_name.setdefault(_plain(other), field)
    return by_name


def _plain(name: str) -> str:
    """Return a name in lower case without separators."""
    return "".join(character for character in name.casefold() if character.isalnum())


def did_you_mean(name: str, known: Iterable[str], ending: str = "") -> str | None:
    """Return the question whether a known name was meant, with what is written behind it; None where none is near."""
    near = difflib.get_close_matches(name, list(known), n=1)
    return f"did you mean {near[0]}{ending}?" if near else None


def clip(value: object, width: int = 60) -> str:
    """Return a value as it is shown in an error."""
    try:
        text = repr(value)
    except (RecursionError, ValueError):  # too many levels, or an integer of too many digits
        text = f"a {type(value).__name__} too large to print"
    return text if len(text) <= width else f"{text[: width - 3]}..."
