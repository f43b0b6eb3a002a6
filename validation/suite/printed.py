"""Numbers that somebody printed, as a table of comma-separated values in the folder of a study.

An entry ``[[gate]]`` says where they are, of which scene a line is, and by which of its keys::

    numbers = "errors.csv"
    scene = "methods-locked-{scheme}"
    by = ["contact.stiffness", "time.step"]

The first lines of such a table::

    scheme,    contact.stiffness, time.step=0.01, time.step=0.002
    constant,  1e9,               0.557273246,    0.507955225

A column that the scene's pattern names fills it in; a key, or a key and its value (a list's between blanks), picks the
case. What stands under a key and its value is a number of the entry's only metric, under any other name one of the
metric of that name, if the entry's ``metrics``, where it has some, name it. An empty place is no number, a line that
begins with # a remark.
"""

from __future__ import annotations

import csv
import operator
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.scenes.scene import Scene


def printed_numbers(
    path: Path, entry: dict[str, Any], cases: Mapping[str, Sequence[Scene]]
) -> Mapping[str, Mapping[str, str]]:
    """Return the numbers of a table as their texts, by case and metric.

    ``scene``, ``by`` and ``metrics`` are taken out of the entry; `cases` are those of each scene, by its name.

    Raises
    ------
    ValueError
        A line is of no case or of several.
    """
    pattern = entry.pop("scene")
    keys = entry.pop("by", ())
    metrics = entry.pop("metrics", ())
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    numbers: dict[str, dict[str, str]] = {}
    for line in csv.DictReader(lines, skipinitialspace=True):
        words = {column: text.strip() for column, text in line.items() if text and text.strip()}
        name = pattern.format(**words)
        values = {key: _value(words[key]) for key in keys if key in words}
        for column, text in words.items():
            key, equals, value = column.partition("=")
            unpicked = metrics and not equals and column not in metrics
            if unpicked or column in keys or f"{{{column}}}" in pattern:
                continue
            picked = values | {key: _value(value)} if equals else values
            (metric,) = metrics if equals else (column,)
            subject = _case(path, cases[name], picked) if picked else name
            numbers.setdefault(subject, {})[metric] = text
    return numbers


def _value(text: str) -> tuple[float, ...]:
    """Return the numbers of a key's value, those of a list between blanks."""
    return tuple(map(float, text.split()))


def _case(path: Path, cases: Sequence[Scene], values: Mapping[str, tuple[float, ...]]) -> str:
    """Return the name of the one case that has these values."""
    matching = [
        case.name
        for case in cases
        if all(np.allclose(operator.attrgetter(key)(case), value, 1e-9, 0) for key, value in values.items())
    ]
    if len(matching) != 1:
        raise ValueError(f"{path}: {dict(values)} must be of one case, got {', '.join(matching) or 'none'}")
    return matching[0]
