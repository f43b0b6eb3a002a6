"""What results hold, in numbers kept in `numbers.toml`, for lines that no truth judges; `KEEP_PAGES=1` writes it anew.

A number is the sum of all values of a part of a result, each by a weight of its own; one that rounding decides is
written as nan, and stays so.
"""

import math
import os
import re
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest
from oracles.stand_ins import kept

KEPT = Path(__file__).with_name("numbers.toml")
DERIVED = ("energies", "slide", "gap", "velocity", "horizontal_velocity", "states", "slip", "angle", "area")
DIGITS = 6e-6


def flat(values):
    """Return numbers in a row."""
    return np.nan_to_num(np.ravel(values).astype(complex), posinf=1e9, neginf=-1e9)


def evened(table, least):
    """Return the values of a table in a row, each part over its greatest one, so that none hides the others."""
    parts = [np.ravel(table[name]) for name in sorted(table) if name != "balance"]
    sizes = [np.max(np.abs(part), initial=0.0) for part in parts]
    return flat(
        np.concatenate(
            [part / (size + (least or 1e-5 * max(sizes) or 1.0)) for part, size in zip(parts, sizes, strict=True)]
        )
    )


def parts_of(result):
    """Yield name and numbers of all arrays in a result or a table; those of a table within it are one array."""
    if is_dataclass(result):
        names = [field.name for field in fields(result) if not field.name.endswith(("_seconds", "time"))]
        names += [name for name in DERIVED if hasattr(type(result), name)]
        result = {name: getattr(result, name) for name in names}
    elif hasattr(result, "_asdict"):
        result = result._asdict()
    yield "", flat([value for name, value in result.items() if isinstance(value, int | float) and name != "solves"])
    for name, part in result.items():
        if isinstance(part, np.ndarray):
            yield name, flat(part)
        elif isinstance(part, dict):
            yield name, evened(part, 1e-7 if name == "columns" else 0.0)
        elif hasattr(part, "_asdict"):
            yield from parts_of(part)
        elif isinstance(part, tuple) and part and not isinstance(part[0], str):
            yield name, flat(part)


def numbers_of(result):
    """Return the numbers of a result, the last of all that is whole, and the greatest value that each is a sum of."""
    numbers = []
    sizes = []
    parts = []
    counts = []
    for name, part in parts_of(result):
        (counts if np.array_equal(part, np.rint(part)) and name != "solves" else parts).append(part)
    for values in [*parts, np.concatenate([[], *counts])]:
        order = np.arange(1.0, len(values) + 1)
        numbers.append(float(np.cos(order) @ values.real + np.sin(order) @ values.imag))
        sizes.append(float(np.max(np.abs(values), initial=0.0)))
    return numbers, sizes


def write(name, numbers):
    """Write the numbers of a result; what was left out as rounding stays so."""
    table = kept(KEPT)
    old = table.get(name, [])
    is_left = [place < len(old) and math.isnan(old[place]) for place in range(len(numbers))]
    table[name] = [math.nan if left else value for left, value in zip(is_left, numbers, strict=True)]
    lines = [f'"{key}" = [{",".join(f"{value:.6g}" for value in table[key])}]\n' for key in sorted(table)]
    KEPT.write_text(re.sub(r"(?<=e)\+?(-?)0", r"\1", "".join(lines)), encoding="utf-8")


@pytest.fixture(scope="session")
def kept_numbers():
    return kept(KEPT)


@pytest.fixture
def held(kept_numbers, request):
    """Hold a result of a short test to its numbers."""

    def check(name, result):
        if request.node.get_closest_marker("long"):
            return
        numbers, sizes = numbers_of(result)
        if os.environ.get("KEEP_PAGES"):
            write(name, numbers)
            return
        assert len(numbers) == len(kept_numbers[name]), name
        for number, (value, size, expected) in enumerate(zip(numbers, sizes, kept_numbers[name], strict=True)):
            assert math.isnan(expected) or abs(value - expected) <= DIGITS * max(size, abs(expected)), (name, number)

    return check
