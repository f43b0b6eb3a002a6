"""Rows that are wrong by themselves, and noise that is nothing but noise: neither makes an excuse for the other."""

import re
from dataclasses import replace

import numpy as np
import pytest
from oracles.few_moves import FEW, among
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run

from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign

STIFF = Plain(steps=60, p=5e9, dt=0.001)


def printed(values, digits):
    return np.array([float(f"{v:.{digits - 1}e}") for v in values])


def answer_of(base, columns):
    time = base.dt * np.arange(1, base.steps + 1)
    return compare(scene_of(base), Foreign(time, *columns))


@pytest.mark.parametrize(
    ("slip", "causes"),
    [({}, ["single-rows"]), pytest.param({"rho": 2970.0}, ["single-rows", "density-factor"], marks=pytest.mark.long)],
)
def test_a_row_printed_twice_is_told_by_its_step(slip, causes, monkeypatch):
    among(monkeypatch, FEW)
    displacement, pressure = (printed(values, 8) for values in run(replace(STIFF, **slip)))
    right = displacement[40]
    displacement[40] = displacement[39]
    pressure[40] = pressure[39]
    answer = answer_of(STIFF, (displacement, pressure))
    assert answer.causes == causes
    assert answer.values["single-rows"] == 41
    (stage,) = (stage for stage in answer.evidence if stage.name == "rows")
    assert stage.agrees is False
    off = 100 * abs(right - displacement[40]) / np.max(np.abs(displacement))
    assert float(re.search(r"([\d.]+) % off", stage.words)[1]) == pytest.approx(off, rel=0.06)  # of two digits


@pytest.mark.parametrize(
    ("base", "size", "seed"), [(Plain(steps=60, alpha=0.25, delta=0.5, gg=0.95), 1e-5, 0), (Plain(steps=60), 1e-3, 1)]
)
def test_white_noise_on_a_right_history_is_noise(base, size, seed):
    noise = np.random.default_rng(seed).standard_normal((2, base.steps))
    columns = [x + size * np.max(np.abs(x)) * e for x, e in zip(run(base), noise, strict=True)]
    assert answer_of(base, (columns[0], columns[1])).causes == []


def test_five_digits_in_millimetres_are_a_unit_not_a_load():
    displacement, _ = run(STIFF)
    time = STIFF.dt * np.arange(1, STIFF.steps + 1)
    answer = compare(scene_of(STIFF), Foreign(time, printed(1e3 * displacement, 5)))
    assert answer.causes == ["unit"]
