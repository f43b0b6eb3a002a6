"""What a JSON file states, checked against a model of plain data: every defect with the name of its field."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
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
Stated = TypeVar("Stated", bound=Data)
Address = tuple[str | int, ...]  # keys and indices that lead to a value
RULES = {  # in the place of what pydantic says of a pattern or of each of several types
    "settings_name": "must be small letters, digits, points, plus or minus signs",
    "step_s": "must be a positive number [s], an object of such numbers by problem, or null",
    "link": "must be an address that begins with http:// or https://, or null",
}


@dataclass(frozen=True)
class Document:
    """What a JSON file holds."""

    path: Path
    content: dict[str, Any]
    repeated: tuple[str, ...]  # keys that stand twice, of which one value would be lost

    @property
    def place(self) -> Place:
        """The file, as the place of a defect."""
        return Place(self.path)

    def known(self, address: Address) -> Address:
        """Return the part of an address that stands in the file."""
        value: Any = self.content
        for depth, part in enumerate(address):
            try:
                value = value[part]
            except (LookupError, TypeError):
                return address[:depth]
        return address


def read_document(path: Path, advice: str) -> Document:
    """Return a JSON file that holds an object, or raise InputError."""
    try:
        text = read_text(path, LARGEST_FILE)
    except FileNotFoundError:
        raise InputError("is required", source=Place(path), value="no such file", advice=advice) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=Place(path)) from None
    repeated: list[str] = []

    def taken(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        counts = Counter(key for key, _ in pairs)
        repeated.extend(key for key, count in counts.items() if count > 1)
        return dict(pairs)

    try:
        content = json.loads(text, object_pairs_hook=taken)
    except json.JSONDecodeError as error:
        before, after = text[: error.pos].rstrip(), text[error.pos : error.pos + 1]
        advice_of_json = "a comma after the last entry?" if before.endswith(",") and after in ("}", "]") else None
        if after in ("/", "#"):
            advice_of_json = "JSON has no comments"
        place = Place(path, error.lineno, error.colno)
        raise InputError(f"must be JSON: {error.msg}", source=place, advice=advice_of_json) from None
    except (RecursionError, ValueError):  # too many levels, or an integer of too many digits
        raise InputError("must be JSON of few levels and short numbers", source=Place(path)) from None
    if not isinstance(content, dict):
        raise InputError("must be an object", source=Place(path), value=type(content).__name__)
    return Document(path, content, tuple(repeated))


def checked(document: Document, model: type[Stated], template: Mapping[str, Any], defects: Defects) -> Stated | None:
    """Return what a document states as plain data; None, and the defects, where it does not conform."""
    before = len(defects)
    for key in document.repeated:
        defects.add(document.place, "must appear once", field=key)
    stated = None
    try:
        stated = model.model_validate(document.content)
    except ValidationError as error:
        for one in error.errors(include_url=False):
            _add(document, model, dict(one), defects)
    for field, blank in template.items():
        if blank and document.content.get(field) == blank and not defects.has(document.path, field):
            defects.add(document.place, "must be filled in", field=field, value=clip(blank))
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
    field = ".".join(map(str, address))
    if defects.has(document.path, field):
        return
    defects.add(document.place, rule, field=field or None, value=value or clip(error["input"]), advice=advice)
