"""JSON read strictly: finite numbers, records of their declared types, every defect one line that names the file."""

from __future__ import annotations

import functools
import json
import math
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from validation.errors import InputError
from validation.runs.regular import regular

LARGEST = 2**63  # what a count may be
LARGEST_FILE = 512e6  # bytes; the verdicts and manifests of all studies are some megabytes


def loads(text: str) -> Any:
    """Return the data of a JSON text, or raise ValueError: no JSON, endless nesting, or a number not finite."""
    try:
        return json.loads(text, parse_constant=_refuse, parse_float=_finite, parse_int=_count)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def read(path: Path, kind: Any, advice: str, content: str = "what a run writes") -> Any:
    """Return the data of a JSON file whose content is of a type, as it stands in the file.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    InputError
        It cannot be read, or is of another type; the line ends with the advice.
    """
    try:
        regular(path, LARGEST_FILE)
        data = loads(path.read_text(encoding="utf-8"))
    except (FileNotFoundError, InputError):
        raise
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", source=path, advice=advice) from None
    except UnicodeDecodeError:
        raise InputError("must be UTF-8 text", source=path, value="bytes that are not", advice=advice) from None
    except ValueError as error:
        raise InputError(f"must be JSON: {error}", source=path, advice=advice) from None
    if defect := defect_of(data, kind):
        raise InputError(f"must be {content}: {defect}", source=path, advice=advice)
    return data


def defect_of(data: object, kind: Any) -> str | None:
    """Return where and how data is not of a type, or None where it is."""
    try:
        _adapter(kind).validate_python(data, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        place = ".".join(str(part) for part in first["loc"]) or "the whole"
        rule = " ".join(first["msg"].removeprefix("Value error, ").split())
        return f"{place}: {rule[:1].lower()}{rule[1:]}"
    return None


@functools.cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(kind)


def _refuse(word: str) -> float:
    raise ValueError(f"{word} is not a JSON number")


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is beyond the range of numbers")
    return value


def _count(text: str) -> int:
    if len(text) > 20 or abs(int(text)) > LARGEST:
        raise ValueError(f"{text[:24]} is beyond the range of numbers")
    return int(text)
