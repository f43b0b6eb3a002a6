"""`compare`: the model that fits, against the suite's own DDA and against a DDA program of another make."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import refused, typed
from matplotlib.image import imread
from oracles.sliding_block import Plain, history, write_measured_point

from validation import load_scene, solve
from validation.diagnosis.causes import intervals_of
from validation.diagnosis.fits.fit import fit, intervals, untold
from validation.diagnosis.fits.target import Target
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import read
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Variant, rectangle_of

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "ntdda"
YIELDS = {"opens": True, "updated": True, "base": (5.0, 2e12)}  # as a block of 50 GPa on points


def scene(**changes):
    base = {"time.step": 0.002, "time.steps": 60}
    return load_scene("figures-3-4").with_values(base | {k.replace("__", "."): v for k, v in changes.items()})


def test_a_fit_finds_the_scheme_and_its_interval_holds_it():
    column = rectangle_of(scene())
    steps = np.full(80, 0.001)
    true = Variant(0.31, 0.7, 0.985, softness=0.02)
    noise = 1e-5 * np.random.default_rng(3).standard_normal(80)
    noisy = histories(column, [true], steps).displacement[:, 0] + noise
    free = ("alpha", "delta", "gg", "softness")
    target = Target(column, steps, np.arange(80), noisy[None])
    (found,) = fit(target, [(Variant(0.25, 0.5, 1.0), free)], rounds=20)
    for name, interval in intervals(found).items():
        # the interval is a 95 % one; twice it fails once in ten thousand
        assert abs(interval.value - getattr(true, name)) < 2 * interval.half_width, name
        assert interval.half_width < 0.1, name
    assert untold(found) == []
    ends = intervals_of(target, found, ["gg", "springs-factor"])
    for cause, name, number in (("gg", "gg", float), ("springs-factor", "softness", lambda x: math.exp(-x))):
        one = intervals(found)[name]
        expected = sorted(number(one.value + by * one.half_width) for by in (-1, 1))
        assert ends[cause] == pytest.approx(expected, rel=1e-6), cause


def test_what_one_settled_row_cannot_tell_is_said():
    column = rectangle_of(scene())
    steps = np.full(140, 0.01)
    v = Variant(0.5, 1.0, 1.0)
    late = histories(column, [v], steps).displacement[100:, 0] * (1 + 1e-6 * np.sin(np.arange(40)))
    target = Target(column, steps, np.arange(100, 140), late[None])
    (found,) = fit(target, [(v, ("alpha", "delta", "gg", "softness"))])
    assert {name for direction in untold(found) for name in direction} >= {"alpha", "delta", "gg"}


@pytest.mark.long
def test_the_example_of_ntdda():
    done = typed("compare", EXAMPLE / "scene.toml", EXAMPLE / "ntdda-p1E-dt2ms_meas.m", "--json")
    assert done.returncode == 1, done.stderr  # what surrounds the scheme is no fault, and not what the scene gives
    example = json.loads(done.stdout)
    assert not any(
        example[key] for key in ("slips", "remedy", "unexplained", "nearest", "alike", "departure", "opened")
    )
    assert example["causes"] == ["base-compliance", "own-weight", "geometry-updated"]
    assert set(example["values"]) == set(example["intervals"]) == {"base-compliance", "own-weight"}
    assert len(example["evidence"]) == 5
    assert example["scheme"] == {"alpha": 0.5, "delta": 1.0, "gg": 1.0}
    # the number stands in the example's README
    assert example["values"]["base-compliance"] == pytest.approx(0.0015, abs=1e-4)


@pytest.mark.long
def test_numbers_of_the_examples_readme():
    foreign = read(EXAMPLE / "ntdda-p1E-dt2ms_meas.m")
    column = rectangle_of(load_scene(EXAMPLE / "scene.toml"))
    target = Target(column, np.full(200, 0.002), np.arange(200), foreign.displacement[None])
    plain = Variant(0.5, 1.0, 1.0)
    moving = replace(plain, updated=True)
    free = [("softness",), ("softness", "load"), ("softness", "weight")]
    found = fit(target, [(plain, ()), *((moving, names) for names in free)])
    assert [f"{f.misfit:.1e}" for f in found] == ["8.7e-03", "2.0e-03", "1.4e-05", "1.9e-06"]
    assert found[3].variant.weight == pytest.approx(0.970, abs=5e-4)


@pytest.mark.long
@pytest.mark.parametrize(
    ("program", "opened"),
    [
        (Plain(dt=1e-3, p=1e9, g=9.81, steps=60, **YIELDS), (1, 2)),
        # a heavy base that adds 1 % to the static displacement, and swings at 1.4 krad/s: no dead band
        (Plain(dt=4e-4, gg=0.99, steps=60, **YIELDS | {"base": (5.0, 1.05e11)}), (1, 7)),
    ],
)
def test_a_program_of_another_make(program, opened, tmp_path):
    """Base that yields, moving geometry, weight, opening: the scheme is named and the steps are found."""
    made = history(program)
    assert made.opened == opened
    s = scene(time__step=program.dt, contact__stiffness=program.p, block__density=program.rho, time__gg=program.gg)
    answer = compare(s, read(write_measured_point(made, tmp_path / "m.m", program.dt)))
    assert answer.scheme == {"alpha": 0.5, "delta": 1.0, "gg": program.gg}
    assert answer.opened == opened
    expected = {"contact-opened"} if opened else set()
    assert {*answer.causes} - {"own-weight"} == {"base-compliance", "geometry-updated"} | expected
    assert (answer.departure and answer.departure.step) == (opened and opened[0])


@pytest.mark.long
def test_the_report_is_one_page_and_a_remedy_reads_the_history(tmp_path):
    exact = solve(scene(time__steps=16), "dda")
    path = tmp_path / "theirs.csv"
    rows = zip(1e3 * exact.time, -1e3 * exact.displacement, strict=True)
    path.write_text("t;uy\n" + "\n".join(f"{t:.7g};{u:.7g}" for t, u in rows))
    arguments = ["compare", "figures-3-4", path, "--set", "time.step=0.002", "--columns", "time=t,displacement=uy"]
    assert "--figure" in refused(*arguments, "--figure", "f.txt")
    slipped = typed(*arguments, "--json")
    assert slipped.returncode == 1  # it departs
    answer = json.loads(slipped.stdout)
    assert answer["causes"] == ["sign", "unit"]
    assert answer["departure"] == {"step": 1, "kind": "amplitude"}
    written = ("--out", tmp_path / "a.pdf", "--figure", tmp_path / "f.png")
    done = typed(*arguments, *answer["remedy"].split(), *written)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF-")
    assert imread(tmp_path / "f.png").shape[:2] == (1080, 1920)  # a slide
