"""Numbers and histories of runs that did not take place, decided by names; what formulas make of them, as a number."""

import json
import math
import os
import tomllib
import zlib

import numpy as np

from validation.runs.history import History

ROUNDING, LARGEST = 1e-11, 1e30  # of a value that counts


def share(*names):
    """Return a number between 0 and 1 that names decide."""
    return zlib.crc32(" ".join(names).encode()) / 2**32


class Numbers(dict):
    """Every metric has a number below one, a frequency one of some 100 rad/s."""

    def __init__(self, *names):
        super().__init__()
        self.names = names

    def __missing__(self, metric):
        return (0.1 + 0.8 * share(metric, *self.names)) * (1000 if metric.endswith("frequency") else 1)

    def __contains__(self, metric):
        return True

    def get(self, metric, default=None):
        return self[metric]


class Columns(Numbers):
    """Every column is a wave about a line; a wave of forces and stresses is a million times as high."""

    def __init__(self, time, factor, names, *stated):
        super().__init__(*names)
        self.time = time
        self.factor = factor
        for name in stated:
            self[name] = self[name]

    def __missing__(self, name):
        phase = 6 * share(name, *self.names)
        height = 1e6 if any(word in name for word in ("pressure", "stress", "normal", "shear", "force")) else 1.0
        s = self.time / self.time[-1]
        wave = height * self.factor * (0.3 + phase / 9 + s * math.sin(phase) + 0.2 * np.sin(9 * s + phase))
        return self.setdefault(name, wave)


def history(scene, *names, factor=1.0):
    """Return a history at the steps of a scene."""
    time = scene.time.step * np.arange(1, scene.time.steps + 1)
    return History(time, Columns(time, factor, (scene.name, *names), *scene.run.columns))


def summed(values):
    """Return the number of some values."""
    total = 0.0
    for order, value in enumerate(values):
        size = 0.3 + share(value) if isinstance(value, str) else value or 0.0
        if abs(size) > ROUNDING:
            weight = 1 + order * 0.6180339887 % 1
            total += math.copysign(weight * math.log10(min(abs(size), LARGEST) / ROUNDING), size)
    return total


def numbers_in(value):
    """Yield the numbers and words of plain data, one by one."""
    if isinstance(value, dict):
        for name in sorted(value):
            yield name
            yield from numbers_in(value[name])
    elif isinstance(value, list | tuple):
        yield len(value)
        for part in value:
            yield from numbers_in(part)
    else:
        yield value if isinstance(value, str | float | int) else 0.5  # what is none, or an object


def kept(path):
    """Return the tables of numbers that a file keeps."""
    return tomllib.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def keep(path, name, found, changed):
    """Write a table of numbers; one that changes with what is changed by rounding is "~"."""
    lines = {}
    for key, value in found.items():
        lines[key] = round(value, 4) if abs(changed.get(key, value) - value) <= 1e-6 else "~"
    text = ""
    for table, numbers in sorted((kept(path) | {name: lines}).items()):
        text += f"[{table}]\n"
        text += "".join(f"{json.dumps(key)} = {json.dumps(value)}\n" for key, value in numbers.items())
    path.write_text(text, encoding="utf-8")


def assert_kept(path, table, found, changed=dict):
    """Compare numbers with those that a table of a file keeps; ``KEEP_PAGES=1`` writes them anew.

    ``changed`` returns what they are when what they are of is changed by rounding.
    """
    if os.environ.get("KEEP_PAGES"):
        keep(path, table, found, changed())
    others = differing(found, kept(path).get(table, {}))
    assert not others, others


def differing(found, before):
    """Return the numbers that are not what they were; NaN where one has come or gone."""
    both = {key: (found.get(key, math.nan), before.get(key, math.nan)) for key in found.keys() | before.keys()}
    return {key: now for key, (now, then) in both.items() if then != "~" and not abs(now - then) <= 1e-4}
