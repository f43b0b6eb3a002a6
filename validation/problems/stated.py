"""What the JSON file of a folder of answers states, checked against its model: every defect with its field."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from validation.errors import InputError
from validation.problems.data import AnswersData
from validation.problems.pack import ANSWERS_TEMPLATE, CHOSEN
from validation.runs.defects import Defects, Place
from validation.runs.tables import read_text
from validation.scenes.scene import rule_and_value
from validation.scenes.unknown import clip, did_you_mean

LARGEST_FILE = 1_000_000  # bytes
RULES = {  # in the place of what pydantic says of a pattern or of each of several types
    "settings_name": "must be small letters, digits, points, plus or minus signs",
    "step_s": "must be a positive number [s], an object of such numbers by problem, or null",
    "link": "must be an address that begins with http:// or https://, or null",
}


def read_document(path: Path, advice: str, defects: Defects) -> dict[str, Any]:
    """Return the object that a JSON file holds, or raise InputError; a key that stands twice is a defect."""
    try:
        text = read_text(path, LARGEST_FILE)
    except FileNotFoundError:
        raise InputError("is required", source=Place(path), value="no such file", advice=advice) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=Place(path)) from None

    def taken(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        for key, count in Counter(key for key, _ in pairs).items():
            if count > 1:  # one of the values would be lost
                defects.add(Place(path), "must appear once", field=key)
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
    return content


def checked(path: Path, content: dict[str, Any], defects: Defects) -> AnswersData | None:
    """Return what a file states of answers; None, and the defects, where it does not conform."""
    data = None
    try:
        data = AnswersData.model_validate(content)
    except ValidationError as error:
        for one in error.errors(include_url=False):
            _add(path, dict(one), defects)
    for field, blank in ANSWERS_TEMPLATE.items():
        if blank and content.get(field) == blank and not defects.has(path, field) and field not in CHOSEN:
            defects.add(Place(path), "must be filled in", field=field, value=clip(blank))
    return data


def _add(path: Path, error: dict[str, Any], defects: Defects) -> None:
    address = error["loc"]
    rule, value = rule_and_value(error)
    advice = None
    if error["type"] == "extra_forbidden":
        known = AnswersData.model_fields
        advice = did_you_mean(address[-1], known) or f"known are {', '.join(known)}"
    elif error["type"] != "missing" and address[0] in RULES:
        address = address[:1]
        rule = RULES[address[0]]
        value = ""
    elif error["type"] == "string_pattern_mismatch":
        rule = "must not be blank"
    field = ".".join(map(str, address))
    if not defects.has(path, field):
        defects.add(Place(path), rule, field=field, value=value or clip(error["input"]), advice=advice)
