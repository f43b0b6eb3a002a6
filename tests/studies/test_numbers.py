"""What the formulas of each study give, in numbers kept in `numbers.toml`: bands of gates, rows, what chapters draw.

Rows are computed here from stand-ins of runs, waves that a name decides, so that nothing is marched: what a row says of
them means nothing, but a sign, a constant or a term of its formula that is another one shows. That formulas are right
is told by the gates, which are long, and by tests with truths. A number is the sum of w log10(|value| / ROUNDING), w
from 1 to 2, with the sign of the value; one that rounding decides is written as "~". `KEEP_PAGES=1` writes the file
anew.
"""

import json
import math
import os
import tomllib
import zlib
from pathlib import Path

import numpy as np
import pytest

from validation.engine.finished import Finished
from validation.runs.case_name import scene_of
from validation.runs.history import History
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.suite.folders import get_study, judged_studies

KEPT = Path(__file__).with_name("numbers.toml")
ROUNDING, LARGEST = 1e-11, 1e30  # of a value that counts
MOST = 9  # scenes of a row


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


class Histories:
    """Runs that did not take place, as `Results` has their histories."""

    def __init__(self, cases, factor):
        self.cases = cases
        self.factor = factor

    def history(self, key):
        case = self.cases[key]
        time = case.scene.time.step * np.arange(1, case.scene.time.steps + 1)
        names = (case.scene.name, case.solver)
        return History(time, Columns(time, self.factor, names, *case.scene.run.columns))


def stand_in(key, case):
    """Return the row of a run that did not take place."""
    numbers = Numbers(case.scene.name, case.solver)
    return Row(key, "", case.scene.name, case.solver, Outcome.COMPLETED, numbers, numbers, numbers, (), 0.01, 9)


def summed(values):
    """Return the number of some values."""
    total = 0.0
    for order, value in enumerate(values):
        size = 0.3 + share(value) if isinstance(value, str) else value or 0.0
        if abs(size) > ROUNDING:
            weight = 1 + order * 0.6180339887 % 1
            total += math.copysign(weight * math.log10(min(abs(size), LARGEST) / ROUNDING), size)
    return total


def values_in(data):
    """Yield the numbers and words in what a chapter draws."""
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, np.ndarray):
        data = data.tolist()
    if isinstance(data, (list, tuple)):
        for part in data:
            yield from values_in(part)
    elif isinstance(data, (int, float, str)):
        yield data


def rows_of(study, factor=1.0):
    """Return the numbers of a study's rows, each of the first cases of some scenes, by their names."""
    cases = {f"{case.solver} {case.scene.name}": case for case in study.cases()}
    rows = {(case.scene.name, case.solver): stand_in(key, case) for key, case in cases.items()}
    finished = Finished(rows, Histories(cases, factor), study.recipes())
    first = {}
    for scene, name in study.recipes():
        first.setdefault(name, {}).setdefault(scene_of(scene), scene)
    values = {}
    with np.errstate(all="ignore"):
        for name, scenes in first.items():
            for scene in list(scenes.values())[:MOST]:
                metrics = finished.row(scene, name).metrics
                values.setdefault(f"row {name}", []).extend([*metrics.values(), 7.0 * len(metrics)])
    return {name: summed(found) for name, found in values.items()}


def numbers(study):
    edges = [edge for gate in study.gates() for edge in (gate.low, gate.high)]
    return {"bands": summed(edges), "data": summed(values_in(dict(study.data()))), **rows_of(study)}


def kept():
    return tomllib.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}


def keep(name, found):
    changed = rows_of(get_study(name), 1 + 1e-11)
    lines = {
        key: "~" if abs(changed.get(key, value) - value) > 1e-6 else round(value, 4) for key, value in found.items()
    }
    text = ""
    for study, of_study in sorted((kept() | {name: lines}).items()):
        text += f"[{study}]\n"
        text += "".join(f"{json.dumps(key)} = {json.dumps(value)}\n" for key, value in of_study.items())
    KEPT.write_text(text, encoding="utf-8")


@pytest.mark.parametrize("name", judged_studies())
def test_formulas_give_what_they_gave(name):
    found = numbers(get_study(name))
    if os.environ.get("KEEP_PAGES"):
        keep(name, found)
    before = kept()[name]
    assert list(found) == list(before)
    changed = {key: value for key, value in found.items() if before[key] not in ("~", pytest.approx(value, abs=2e-4))}
    assert changed == {}
