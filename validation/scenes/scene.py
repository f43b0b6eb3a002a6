"""Scenes: what is simulated, as TOML in SI units, checked with pydantic; unknown keys are refused.

Every defect of a scene file is reported as one :class:`InputError` line that names the file, the field, the rule and
the value.
"""

from __future__ import annotations

import difflib
import functools
import itertools
import json
import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Set
from pathlib import Path
from typing import Any, Self, get_args

from pydantic import Field, ValidationError, model_validator

from validation.errors import InputError as InputError
from validation.runs.regular import regular
from validation.scenes.keys import Section, check_needs, key_of_any_entry
from validation.scenes.kinds import kinds
from validation.scenes.places import scene_files
from validation.scenes.tabled import SceneTables
from validation.scenes.tables import GateSection, RunSection, TimeSection
from validation.scenes.unknown import clip, refuse_unknown_keys

LARGEST_FILE, MOST_CASES = 1_000_000, 100_000  # bytes; cases of one sweep
DID_YOU_MEAN = "; did you mean "  # between a value and what was probably meant, in a rule of a table
NEARLY_A_NUMBER = re.compile(r"[-+]?\d+([.,]\d+)?([eE][-+]?\d+)? ?%|[-+]?\d+,\d+([eE][-+]?\d+)?")
DECIMAL_COMMA = re.compile(r"^[^#\n\"'\[]*=\s*([-+]?\d+,\d+)", re.MULTILINE)
LONGEST_VALUE = 4000  # characters that --set takes


class Scene(SceneTables):
    """A scene as its file states it; `expand` resolves the sweep into single cases."""

    time: TimeSection
    run: RunSection = RunSection()
    sweep: dict[str, Any] = Field(default_factory=dict)
    gate: tuple[GateSection, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        lists = self._swept()
        definition = self.definition() if lists else {}
        for field, values in lists.items():
            if not (isinstance(values, list) and values):
                raise ValueError(f"sweep: {field} must be a list of values that is not empty, got {values!r}")
            table, _, _ = field.partition(".")
            _, key = _table_of(definition, field)
            if table in ("run", "gate", field) or "." in key:
                raise ValueError(f'sweep: must name a key of a table, such as "time.step", got {field!r}')
        mode = self.sweep.get("mode", "product")
        lengths = [len(values) for values in lists.values()]
        if mode not in ("product", "zip"):
            raise ValueError(f"sweep: mode must be 'product' or 'zip', got {mode!r}")
        if mode == "zip" and len(set(lengths)) > 1:
            raise ValueError(f"sweep: lists of a zip must have one length, got {lengths}")
        count = max(lengths, default=1) if mode == "zip" else math.prod(lengths)
        if count > MOST_CASES:
            raise ValueError(f"sweep: must make at most {MOST_CASES} cases, got {count}")
        tables = self.tables()
        check_needs(tables)
        self.kind.check(self)
        if self.damping.kinetic == "adaptive" and self.time.discount != 1:
            raise ValueError(f'time: gg must be 1 with damping.kinetic = "adaptive", got {self.time.discount:g}')
        _check_files(tables)
        return self

    def __hash__(self) -> int:
        return hash(self.name)  # equal scenes have it in common

    def tables(self) -> dict[str, Section]:
        """Return the tables that the scene has, by the names that its file gives them."""
        values = {field.alias or name: getattr(self, name) for name, field in type(self).model_fields.items()}
        return {name: table for name, table in values.items() if isinstance(table, Section)}

    def _swept(self) -> dict[str, list[Any]]:
        return {field: values for field, values in self.sweep.items() if field != "mode"}

    def expand(self) -> tuple[Scene, ...]:
        """Return one scene per value of the sweep, named ``name[field=value,...]``.

        Raises
        ------
        InputError
            A swept field or value is not allowed, or a case repeats.
        """
        return self._expanded if self._swept() else (self,)

    @functools.cached_property
    def _expanded(self) -> tuple[Scene, ...]:
        lists = self._swept()
        rows = (
            zip(*lists.values(), strict=True) if self.sweep.get("mode") == "zip" else itertools.product(*lists.values())
        )
        return tuple(self._cases(lists, rows))

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with other values, which has cases of its own."""
        copy = super().model_copy(update=update, deep=deep)
        vars(copy).pop("_expanded", None)
        return copy

    def _cases(self, lists: dict[str, list[Any]], rows: Iterable[tuple[Any, ...]]) -> Iterator[Scene]:
        names = set()
        for row in rows:
            case = self.with_values(dict(zip(lists, row, strict=True)), label=True)
            if case.name in names:
                raise InputError("must not repeat a case", source=self.name, field="sweep", value=f"{case.name} twice")
            names.add(case.name)
            yield case

    def with_values(self, values: dict[str, Any], label: bool = False) -> Scene:
        """Return a copy with dotted keys replaced.

        A key that is set leaves the sweep, and so does a key that it excludes.

        Raises
        ------
        InputError
            A key is no key of a scene, a value is not allowed, or two of the keys exclude each other.
        """
        data = self._data_but_for({field.partition(".")[0] for field in values})
        replaced_keys = set(values)
        for field, value in values.items():
            excluded = _excluded(field, value)
            if both := [other for other in excluded if other in values]:
                raise InputError(f"{field} and {both[0]} exclude each other", source=self.name, value="both")
            # set ``section.key``, or a key of a table in it, in place; exclusive partners of the key are taken out
            where = self.name
            if field in ("name", "sweep", "gate") or field.startswith(("sweep.", "gate.")):
                raise InputError("must be a key as in time.step=0.001", source=where, field=field, value=repr(field))
            table, key = _table_of(data, field)
            if table is data and "." in field:
                raise InputError("must be section.key", source=where, field=field, value=repr(field))
            for partner in _excluded(field, value):
                table.pop(partner.rpartition(".")[2], None)
            table[key] = value
            replaced_keys |= set(excluded)
        sweep = {f: v for f, v in self.sweep.items() if f not in replaced_keys}
        data["sweep"] = sweep if set(sweep) - {"mode"} else {}
        if label:
            inside = ",".join(f"{field}={_short(value)}" for field, value in values.items())
            data["name"] = f"{self.name}[{inside}]"
        return parse_scene(data, self.name)

    def definition(self) -> dict[str, Any]:
        """Return the scene as plain data (what a file would state)."""
        return _stated(self)

    def _data_but_for(self, changing: Set[str]) -> dict[str, Any]:
        """Return what the scene states: tables that change as plain data, the others as they are, once checked."""
        data = {}
        for name, field in type(self).model_fields.items():
            if name not in self.model_fields_set:
                continue
            value = getattr(self, name)
            table = field.alias or name
            if isinstance(value, Section) and table in changing:
                value = _stated(value)
            data[table] = value
        return data


def _stated(table: Section) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(table.model_dump_json(exclude_unset=True, by_alias=True))
    return data


def _table_of(data: dict[str, Any], field: str) -> tuple[dict[str, Any], str]:
    """Return the table that a dotted key stands in, made where it is absent, and what of the key is left there.

    ``plane.block.1.at`` stands in the second entry of a list of tables, ``plane.block.top.at`` in that of this name.
    What is inside of no table is left whole.
    """
    table = data
    key = field
    while "." in key:
        section, _, remainder = key.partition(".")
        inside = table.setdefault(section, {})
        if isinstance(inside, list):
            entry, _, remainder = remainder.partition(".")
            names = [str(number) for number in range(len(inside))] + [other.get("name") for other in inside]
            inside = inside[names.index(entry) % len(inside)] if remainder and entry in names else None
        if not isinstance(inside, dict):
            break
        table = inside
        key = remainder
    return table, key


def _short(value: object) -> str:
    """Return a value for a name; digits beyond six are kept, since names must tell cases apart."""
    if isinstance(value, list | tuple):
        return "x".join(map(_short, value))
    if isinstance(value, dict):  # a layer or a joint
        return "/".join(map(_short, value.values()))
    if not isinstance(value, float):
        return str(value)
    return f"{value:g}" if float(f"{value:g}") == value else repr(value)


def _excluded(field: str, value: object) -> tuple[str, ...]:
    """Return the keys of the same table that a key with this value excludes."""
    if field == "time.scheme":
        # What the new scheme has no number for goes; rho_inf of one scheme is rho_inf of the next.
        if value == "newmark":
            return ("time.rho_inf", "time.split")
        if value == "leapfrog":
            return ("time.alpha", "time.delta", "time.rho_inf", "time.split")
        return ("time.alpha", "time.delta") if value == "composite" else ("time.alpha", "time.delta", "time.split")
    return _EXCLUSIVE.get(field, ())


def tables_of_scenes(model: type[Section] = Scene, inside: str = "") -> dict[str, type[Section]]:
    """Return the tables that a scene may have, by their names; ``column.layer`` is an entry of a list in a table."""
    tables = {}
    for name, field in model.model_fields.items():
        for table in (field.annotation, *get_args(field.annotation)):
            if isinstance(table, type) and issubclass(table, Section):
                place = f"{inside}{field.alias or name}"
                tables[place] = table
                tables |= tables_of_scenes(table, f"{place}.")
    return tables


@functools.cache
def _all_tables() -> dict[str, type[Section]]:
    """Return the tables that a scene may have, and the scene itself under the empty name."""
    return {"": Scene} | tables_of_scenes()


OUR_WORDS = {"a valid tuple": "a list", "a valid number": "a number"}  # in the place of pydantic's
FILES = {  # keys that name files, and what these are; `Kind.files` has more
    "fem.mesh": "mesh file",
    "load.base_motion": "record of the base's motion",
    "input.record": "record of the input",
}
_EXCLUSIVE = {
    "time.gg": ("time.gg_rate",),
    "time.gg_rate": ("time.gg",),
    "contact.damping_ratio": ("contact.restitution",),
    "contact.restitution": ("contact.damping_ratio",),
    "fem.elements": ("fem.mesh",),
    "fem.mesh": ("fem.elements",),
    "block.side": ("block.width", "block.height", "block.vertices", "block.base", "block.top"),
    "block.vertices": ("block.side", "block.width", "block.height"),
    "block.width": ("block.side", "block.vertices"),
    "block.height": ("block.side", "block.vertices"),
}


def parse_scene(data: dict[str, Any], source: str) -> Scene:
    """Return the scene of plain data, or raise InputError: source, field, rule and value of the first defect."""
    try:
        # A file must not state the scene's name, which is that of the file; plain data have it.
        refuse_unknown_keys({key: value for key, value in data.items() if key != "name"}, _all_tables(), source)
        return Scene.model_validate(data)
    except ValidationError as error:
        raise first_defect(error, source) from None
    except RecursionError:
        raise InputError(
            "must not be nested so deeply", source=source, field="scene", value="too many levels"
        ) from None


def first_defect(error: ValidationError, source: str) -> InputError:
    """Return the first defect of a pydantic report as the error of bad input."""
    errors = error.errors(include_url=False)
    first = errors[0]
    rule, value = rule_and_value(dict(first))
    value, _, known = value.partition(DID_YOU_MEAN)
    field = ".".join(str(part) for part in first["loc"])
    first_word, _, remainder = rule.partition(": ")
    if remainder and " " not in first_word:  # a rule on a whole table begins with its field
        field = f"{field}.{first_word}" if field else first_word
        rule = remainder
    if first["type"] == "missing":  # all that is missing at once, which is one thing to do
        missing = [".".join(map(str, entry["loc"])) for entry in errors if entry["type"] == "missing"]
        more = len(errors) - len(missing)
        field = ", ".join(missing)
        rule = "is required" if len(missing) == 1 else "are required"
    else:
        more = len(errors) - 1
    return InputError(
        rule,
        source=source,
        field=field or None,
        value=(value or clip(first["input"])) + (f" (and {more} more)" if more else ""),
        advice=f"{DID_YOU_MEAN[2:]}{known}" if known else _number_meant(first["input"]),
    )


def _number_meant(value: object) -> str | None:
    """Return what to write for a number with a decimal comma or a sign of per cent, None for anything else."""
    if not isinstance(value, str) or not NEARLY_A_NUMBER.fullmatch(value):
        return None
    number = value.replace(",", ".").replace(" ", "")
    return f"write {float(number[:-1]) / 100:.12g}" if number.endswith("%") else f"write {number}, with a point"


def rule_and_value(error: Mapping[str, Any]) -> tuple[str, str]:
    """Return the rule that an error of pydantic names, in our words, and the value where the message has it."""
    message = error["msg"]
    for theirs, ours in OUR_WORDS.items():
        message = message.replace(theirs, ours)
    rule, _, value = message.removeprefix("Value error, ").partition(", got ")
    if error["type"] == "extra_forbidden":
        rule = "unknown key"
    elif error["type"] == "missing":
        rule = "is required"
        value = "nothing"
    elif "Input should be" in message:
        rule = f"must be {rule.removeprefix('Input should be ')}"
    elif error["type"].endswith(("too_short", "too_long")):
        rule = f"must{rule.partition('should')[2].partition(' after')[0]}"
    return rule, value


def scene_names() -> list[str]:
    """Return the names of the built-in scenes."""
    return list(scene_files())


def load_scene(source: str | Path) -> Scene:
    """Return the scene of a TOML file, or of a name that `scene_names` lists.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or states something that is not allowed.
    """
    path = Path(source)
    built_in = None if path.suffix == ".toml" else scene_files().get(str(source))
    return _parsed(path, _read(path)) if built_in is None else _built_in(built_in, _read(built_in))


@functools.cache
def _built_in(path: Path, text: bytes) -> Scene:
    """Return a built-in scene, which many studies name: one that has been loaded is the same, with its cases."""
    return _parsed(path, text)


def _parsed(path: Path, text: bytes) -> Scene:
    data = _plain_data(path, text)
    refuse_unknown_keys(data, _all_tables(), path.name)
    _beside(path.parent, data)
    return parse_scene({"name": path.stem} | data, path.name)


def _beside(directory: Path, data: dict[str, Any]) -> None:
    """Let the files that a scene names, in a table or in the sweep, stand beside the scene's own file."""

    def beside(value: object) -> object:
        return str(directory / value) if isinstance(value, str) else value

    for _, _, table, key in named_files(data):
        table[key] = beside(table[key])
    sweep = data.get("sweep")
    if not isinstance(sweep, dict):
        return
    for field, values in sweep.items():
        if key_of_any_entry(field, _all_tables()) in _files() and isinstance(values, list):
            sweep[field] = [beside(value) for value in values]


@functools.cache
def _files() -> dict[str, str]:
    """Return the keys that name files, those of kinds too, and what these are."""
    files = dict(FILES)
    for kind in kinds().values():
        files |= kind.files
    return files


def named_files(tables: Mapping[str, Any]) -> Iterator[tuple[str, str, Any, str]]:
    """Yield where tables name a file: the place, what the file is, the table and the key that has its name.

    A table of a list, as ``[[plane.block]]``, has a place for each of its entries.
    """
    for field, role in _files().items():
        *parts, key = field.split(".")
        holders = [("", tables)]
        for part in parts:
            inner = [(f"{place}.{part}".lstrip("."), _value(holder, part)) for place, holder in holders]
            holders = []
            for place, value in inner:
                if isinstance(value, list | tuple):
                    holders += [(f"{place}.{number}", entry) for number, entry in enumerate(value)]
                else:
                    holders.append((place, value))
        for place, holder in holders:
            if _value(holder, key) is not None:
                yield place, role, holder, key


def _check_files(tables: Mapping[str, Section]) -> None:
    for place, _, table, key in named_files(tables):
        name = getattr(table, key)
        if "\0" in name:
            raise ValueError(f"{place}: {key}: must not hold a NUL, got {name!r}")
        try:
            regular(Path(name))
        except InputError as error:
            raise ValueError(f"{place}: {key}: {error}") from None
        except (OSError, ValueError):  # that it cannot be read is said where it is read
            continue


def _value(table: Any, key: str) -> Any:
    return table.get(key) if isinstance(table, dict) else getattr(table, key, None)


def _read(path: Path) -> bytes:
    try:
        regular(path, LARGEST_FILE)
        return path.read_bytes()
    except InputError:
        raise
    except FileNotFoundError:
        near = ", ".join(difflib.get_close_matches(path.stem, scene_names(), cutoff=0.5))
        suggestion = f"did you mean {near}? " if near else ""
        advice = f"{suggestion}dda-validate list scenes names the built-in ones"
        raise InputError("no such scene file", source=path, advice=advice) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path) from None


def _plain_data(path: Path, text: bytes) -> dict[str, Any]:
    try:
        return tomllib.loads(text.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise InputError("must be UTF-8 text", source=path, value="bytes that are not") from None
    except (ValueError, RecursionError) as error:  # TOMLDecodeError is one, so is an integer too long
        advice = None
        if comma := DECIMAL_COMMA.search(text.decode("utf-8-sig")):
            advice = f"{comma[1]}: a number has a point, and no comma"
        raise InputError(f"must be TOML: {' '.join(str(error).split())}", source=path, advice=advice) from None


def parse_assignment(text: str) -> tuple[str, Any]:
    """Split ``key=value`` of the command line; the value is TOML, or else a plain word.

    Raises InputError where there is no ``=`` or no key.
    """
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise InputError("must be key=value", field="--set", value=repr(text[:LONGEST_VALUE]))
    if "\n" in text or "\r" in text:
        raise InputError("must be one line", field="--set", value=repr(text), advice="one --set for each key")
    if len(value) > LONGEST_VALUE:
        raise InputError(
            f"must have at most {LONGEST_VALUE} characters, got {len(value)}", field="--set", value=repr(key)
        )
    try:
        parsed = tomllib.loads(f"value = {value}")["value"]
    except (ValueError, RecursionError):  # no TOML, or a number of more digits than Python reads
        parsed = value
    return key.strip(), parsed
