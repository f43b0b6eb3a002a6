"""What tests are answered, as numbers that are kept beside them, and the fixture that compares.

Sentences, and numbers at the level of rounding, are none of them. `KEEP_PAGES=1` writes the numbers anew.
"""

import dataclasses
import functools
import math
import os

import numpy as np
import pytest
from oracles.stand_ins import differing, keep, kept, summed

LEAST = 1e-5  # of a number that counts
LARGE = {"search", "scene", "scene_fit", "reading", "problem", "jacobian", "residual"}


def said(value, least=LEAST):
    """Yield the numbers and names that are said by an answer, one by one."""
    if dataclasses.is_dataclass(value):
        fields = {field.name: (getattr(value, field.name), field.default) for field in dataclasses.fields(value)}
        value = {name: part for name, (part, default) in fields.items() if part is not default}
    if isinstance(value, dict):
        for name in sorted(value):
            if name not in LARGE:
                yield str(name)
                yield from said(value[name], least)
    elif isinstance(value, np.ndarray):
        yield from said([float(np.linalg.norm(value)), value.size], least)
    elif isinstance(value, list | tuple):
        yield len(value)
        for part in value:
            yield from said(part, least)
    elif isinstance(value, str):
        yield "" if " " in value else value
    elif isinstance(value, int | float | np.generic):
        yield float(value) if abs(value) > least else 0.0


kept_answers = functools.cache(kept)


def compared(request, path, *names):
    """Run a test, then compare what the functions of these names, which its module imports, have answered."""
    if request.node.get_closest_marker("long"):
        yield
        return
    answers = []

    def recording(function):
        def recorded(*given, **named):
            answers.append(function(*given, **named))
            return answers[-1]

        return recorded

    with pytest.MonkeyPatch.context() as patch:
        for name in names:
            if hasattr(request.module, name):
                patch.setattr(request.module, name, recording(getattr(request.module, name)))
        yield
    call = getattr(request.node, "callspec", None)
    name = " ".join([request.node.originalname[5:27], *([call.id[:30]] if call else [])])
    table = request.module.__name__.rpartition("test_")[2]
    if not answers:
        return
    found = {name: summed(said(answers))}
    if os.environ.get("KEEP_PAGES"):
        keep(path, table, kept(path).get(table, {}) | found, {})
    else:
        before = kept_answers(path).get(table, {})
        others = differing(found, {name: before.get(name, math.nan)})
        assert not others, others
