"""What a JSON file states, checked against a model of plain data: every defect with the place of its value."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from validation.errors import InputError
from validation.problems.data import Data
from validation.runs.defects import Defects, Place
from validation.runs.tables import read_text
from validation.scenes.scene import rule_and_value
from validation.scenes.unknown import clip, did_you_mean

LARGEST_FILE = 1_000_000  # bytes
DECODER = json.JSONDecoder()
BLANKS = " \t\r\n"
Stated = TypeVar("Stated", bound=Data)
Address = tuple[str | int, ...]  # keys and indices that lead to a value
RULES = {  # in the place of what pydantic says of a pattern or of each of several types
    "settings_name": "must be small letters, digits, points, plus or minus signs",
    "step_s": "must be a positive number [s], an object of such numbers by problem, or null",
    "link": "must be an address that begins with http:// or https://, or null",
}


class Document:
    """A JSON text, and where in it each key and each value stands; InputError where it holds no object."""

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        self._text = text
        self._keys: dict[Address, int] = {}
        self._values: dict[Address, int] = {}
        self.repeated: list[tuple[str, Place]] = []  # keys that stand twice, of which one value would be lost
        try:
            content = json.loads(text)
            self._walk(0, ())
        except json.JSONDecodeError as error:
            before, after = text[: error.pos].rstrip(BLANKS), text[error.pos : error.pos + 1]
            advice = "a comma after the last entry?" if before.endswith(",") and after in ("}", "]") else None
            if after in ("/", "#"):
                advice = "JSON has no comments"
            place = Place(path, error.lineno, error.colno)
            raise InputError(f"must be JSON: {error.msg}", source=place, advice=advice) from None
        except (RecursionError, ValueError):  # too many levels, or an integer of too many digits
            raise InputError("must be JSON of few levels and short numbers", source=Place(path)) from None
        if not isinstance(content, dict):
            raise InputError("must be an object", source=Place(path, 1, 1), value=type(content).__name__)
        self.content: dict[str, Any] = content

    def place(self, address: Address, of_key: bool = False) -> Place:
        """Return where a value stands, or its key; of what is absent, where that stands in which it is missed."""
        is_key = of_key and address in self._keys
        before = self._text[: self._keys[address] if is_key else self._values[self.known(address)]]
        return Place(self.path, before.count("\n") + 1, len(before) - before.rfind("\n"))

    def known(self, address: Address) -> Address:
        """Return the part of an address that stands in the text."""
        while address not in self._values:
            address = address[:-1]
        return address

    def _walk(self, start: int, address: Address) -> int:
        """Note where a value and its parts stand, in a text that is JSON, and return where it ends."""
        start = self._skip(start)
        self._values[address] = start
        opening = self._text[start]
        if opening not in "{[":
            return DECODER.raw_decode(self._text, start)[1]
        at = self._skip(start + 1)
        index = 0
        while self._text[at] not in "}]":
            part: str | int = index
            if opening == "{":
                key_start = at
                part, at = DECODER.raw_decode(self._text, at)
                is_repeated = (*address, part) in self._keys
                self._keys[*address, part] = key_start
                if is_repeated:
                    self.repeated.append((str(part), self.place((*address, part), of_key=True)))
                at = self._skip(at) + 1  # the colon
            at = self._skip(self._walk(at, (*address, part)))
            if self._text[at] == ",":
                at = self._skip(at + 1)
            index += 1
        return at + 1

    def _skip(self, at: int) -> int:
        while self._text[at] in BLANKS:
            at += 1
        return at


def read_document(path: Path, advice: str) -> Document:
    """Return a JSON file that holds an object, or raise InputError."""
    try:
        return Document(path, read_text(path, LARGEST_FILE))
    except FileNotFoundError:
        raise InputError("is required", source=Place(path), value="no such file", advice=advice) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=Place(path)) from None


def checked(document: Document, model: type[Stated], template: Mapping[str, Any], defects: Defects) -> Stated | None:
    """Return what a document states as plain data; None, and the defects, where it does not conform."""
    before = len(defects)
    for key, place in document.repeated:
        defects.add(place, "must appear once", field=key)
    stated = None
    try:
        stated = model.model_validate(document.content)
    except ValidationError as error:
        for one in error.errors(include_url=False):
            _add(document, model, dict(one), defects)
    for field, blank in template.items():
        if blank and document.content.get(field) == blank and not defects.has(document.path, field):
            defects.add(document.place((field,)), "must be filled in", field=field, value=clip(blank))
    return stated if len(defects) == before else None


def _add(document: Document, model: type[Data], error: dict[str, Any], defects: Defects) -> None:
    address = document.known(tuple(error["loc"]))
    rule, value = rule_and_value(error)
    advice = None
    if error["type"] == "extra_forbidden":
        known = model.model_fields
        advice = did_you_mean(str(error["loc"][-1]), known) or f"known are {', '.join(known)}"
    elif error["type"] == "missing":
        address = tuple(error["loc"])
    elif address and address[0] in RULES:
        rule = RULES[str(address[0])]
        value = ""
    elif error["type"] == "string_pattern_mismatch":
        rule = "must not be blank"
    place = document.place(address, of_key=error["type"] == "extra_forbidden")
    field = ".".join(map(str, address))
    if defects.has(document.path, field):
        return
    defects.add(place, rule, field=field or None, value=value or clip(error["input"]), advice=advice)
