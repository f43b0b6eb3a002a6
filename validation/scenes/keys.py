"""The keys of a scene: each is described once, beside its type, and read from there by all who name it.

A key of a table is `name: Annotated[type, Key(unit, text)] = default`. Its type holds the range; the schema, what a key
goes with, the table of `list keys`, the page of `show`, and labels and data of the report follow from this one line.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, ConfigDict
from pydantic.fields import FieldInfo

from validation.runs.numbers import stated_text

_REQUIREMENT = re.compile(r'([a-z_.]+)(?: = ("[\w -]+"(?: or "[\w -]+")*))?$')


@dataclass(frozen=True)
class Key:
    """What a key of a scene is, besides its type and its default."""

    unit: str  # "" of numbers without one, and of words
    text: str  # what it is, in words
    symbol: str | None = None  # that of the text and the figures; "" where the value says enough, None: its name
    needs: tuple[str, ...] = ()  # what it goes with: `key` not at its default, or `key = "word"`; `table.key` elsewhere
    feature: str = ""  # of a key of the loads: what a scene has where it is not at its default


class Section(BaseModel):
    """A table of a scene file: immutable, unknown keys refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", str_max_length=10_000)

    @property
    def present(self) -> bool:
        """Whether the table says something; by itself every table does."""
        return True


@functools.cache  # asked for every table of every case of a sweep
def keys_of(table: type[Section]) -> tuple[tuple[str, FieldInfo, Key], ...]:
    """Return name, field and description of the keys of a table, without the tables in it."""
    keys = []
    for name, field in table.model_fields.items():
        keys += [(field.alias or name, field, key) for key in field.metadata if isinstance(key, Key)]
    return tuple(keys)


def key_of_any_entry(field: str, tables: Mapping[str, type[Section]]) -> str:
    """Return a dotted key without the number or the name of an entry: ``plane.block.at`` of ``plane.block.1.at``."""
    entry, _, key = field.rpartition(".")
    place = entry.rpartition(".")[0]
    return f"{place}.{key}" if place and place in tables and entry not in tables else field


def stated(table: Section) -> Iterator[tuple[str, Any, Key]]:
    """Yield name, value and description of the keys whose values are not the defaults."""
    for name, field, key in keys_of(type(table)):
        value = stated_value(table, name)
        if value != field.default:
            yield name, value, key


def stated_value(table: Section, key_name: str) -> Any:
    """Return the value of a key by the name that a file gives it."""
    return getattr(table, _attribute(type(table), key_name))


@functools.cache
def _attribute(table: type[Section], key_name: str) -> str:
    """Return the attribute that holds a key as it is stated."""
    alias = f"stated_{key_name}"
    return alias if alias in table.model_fields else key_name


def check_needs(tables: Mapping[str, Section]) -> None:
    """Raise ValueError, with table, rule and value, for the first key without what it goes with."""
    for place, table in tables.items():
        for inside, entry in [("", table), *_entries(table)]:
            stated_fields = entry.model_fields_set
            for name, field, key in _keys_with_needs(type(entry)):
                if _attribute(type(entry), name) not in stated_fields:
                    continue
                value = stated_value(entry, name)
                if value == field.default:
                    continue
                for requirement in key.needs:
                    if not is_fulfilled(requirement, place, tables):
                        rule = f"{place}: {inside}{name} goes with {requirement} only"
                        raise ValueError(f"{rule}, got {stated_text(value)} without it")


@functools.cache
def _keys_with_needs(table: type[Section]) -> list[tuple[str, FieldInfo, Key]]:
    return [entry for entry in keys_of(table) if entry[2].needs]


def _entries(table: Section) -> Iterator[tuple[str, Section]]:
    """Yield the tables of the lists in a table, each with the name of its list and a dot."""
    stated_fields = table.model_fields_set
    for name in type(table).model_fields:
        if name in stated_fields and isinstance(value := getattr(table, name), tuple):
            yield from ((f"{name}.", entry) for entry in value if isinstance(entry, Section))


def is_fulfilled(requirement: str, place: str, tables: Mapping[str, Section]) -> bool:
    """Whether tables say what a requirement asks for, of keys in a table unless it names another one.

    What a requirement without words names may be a property of the table, too: then it is fulfilled where that is true.
    """
    section, name, words = _parsed(requirement)
    table = tables.get(section or place)
    if table is None:
        return False
    value = stated_value(table, name)
    if words:
        return value in words
    field = type(table).model_fields.get(name)
    return bool(value) if field is None else value != field.default


@functools.cache
def _parsed(requirement: str) -> tuple[str, str, tuple[str, ...]]:
    """Return table, key and words of a requirement."""
    parts = _REQUIREMENT.match(requirement)
    if parts is None:
        raise ValueError(f"needs: must be a key, or key = word, got {requirement!r}")
    section, _, name = parts[1].rpartition(".")
    return section, name, tuple(re.findall(r'"(.*?)"', parts[2] or ""))


def described(name: str, value: object, key: Key) -> str:
    """Return a key with its value in words, ``band = 0, 0.001 m``."""
    unit = f" {key.unit}" if key.unit else ""
    return f"{name.replace('_', ' ')} = {stated_text(value)}{unit}"


def range_of(field: FieldInfo) -> str:
    """Return the words that a key takes, or the type of its number and the bounds of it."""
    words = []
    for part in (field.annotation, *get_args(field.annotation)):
        if get_origin(part) is Literal:
            words += [f'"{word}"' for word in get_args(part)]
    bounds = []
    for limit in _limits(field):
        for sign, name in ((">", "gt"), (">=", "ge"), ("<", "lt"), ("<=", "le")):
            if (bound := getattr(limit, name, None)) is not None:
                bounds.append(f"{sign} {bound:g}")
    return " or ".join(words) or " and ".join(bounds)


def _limits(field: FieldInfo) -> Iterator[Any]:
    """Yield what bounds a key, of a key that may be absent what bounds its value."""
    yield from field.metadata
    for part in get_args(field.annotation):
        for limit in getattr(part, "__metadata__", ()):
            yield from limit.metadata if isinstance(limit, FieldInfo) else (limit,)


def default_of(field: FieldInfo) -> str:
    """Return the default of a key in words."""
    if field.is_required():
        return "required"
    return "-" if field.default is None else stated_text(field.default)
