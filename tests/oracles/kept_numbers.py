"""Numbers that are kept in a file at eight digits, a paragraph each part, a line each entry."""

import os

import numpy as np
import pytest


def flat(value):
    """Yield the numbers in a value, without parts of an array or a complex number that only rounding leaves."""
    if isinstance(value, dict):
        yield from flat(list(value.values()))
    elif isinstance(value, np.ndarray):
        parts = np.array([value.real, value.imag] if np.iscomplexobj(value) else value, dtype=float)
        size = np.max(np.abs(parts), initial=1e-15)
        yield from np.where(np.abs(parts) <= 1e-10 * size, 0.0, parts).ravel().tolist()
    elif isinstance(value, complex):
        yield from flat(np.array(value))
    elif isinstance(value, (list, tuple)):
        for one in value:
            yield from flat(one)
    else:
        yield float(value) * (abs(value) > 1e-15)


def hold(path, parts, part):
    """Hold the entries of a part, tuples that begin with a name, to their lines; with ``KEEP_PAGES=1`` write them."""
    found = [[name, *flat(values)] for name, *values in parts[part]()]
    kept = path.read_text().split("\n\n") if path.exists() else [""] * len(parts)
    number = list(parts).index(part)
    if os.environ.get("KEEP_PAGES"):
        kept[number] = "\n".join(" ".join([f"{name}:", *(f"{x:.8g}" for x in values)]) for name, *values in found)
        path.write_text("\n\n".join(kept))
    lines = kept[number].strip().splitlines()
    assert [line.rpartition(":")[0] for line in lines] == [name for name, *_ in found]
    for line, (_, *values) in zip(lines, found, strict=True):
        numbers = [float(x) for x in line.rpartition(":")[2].split()]
        assert values == pytest.approx(numbers, rel=2e-7, abs=1e-16, nan_ok=True), line
