"""Slips, wrong rows and noise in a plain DDA code of someone else's: each is named, and what is no slip is not."""

import re
from dataclasses import replace

import numpy as np
import pytest
from oracles.few_moves import FEW, among, only
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run

from validation.diagnosis import judgement, search
from validation.diagnosis.fits.bar import Bar
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign

PLAIN = Plain(steps=50)  # figures-3-4 at 2 ms


def judged(base=PLAIN, pressure=True, **slip):
    return answer_to(base, run(replace(base, **slip))[: 1 + pressure])


def answer_to(base, columns):
    scene = scene_of(base).with_values({"contact.law": "unilateral"} if base.opens else {})
    return compare(scene, Foreign(base.dt * np.arange(1, base.steps + 1), *columns))


def test_a_tolerance_decides_what_counts_as_the_same(monkeypatch):
    only(monkeypatch, "density-factor", "gg")
    named(judged(), [], {})
    displacement, _ = run(replace(PLAIN, rho=2725.0))
    foreign = Foreign(PLAIN.dt * np.arange(1, PLAIN.steps + 1), displacement)
    assert [compare(scene_of(PLAIN), foreign, tolerance).causes for tolerance in (0.05, 1e-5)] == [
        [],
        ["density-factor"],
    ]


@pytest.mark.parametrize("factor", [0.0, pytest.param(-1.0, marks=pytest.mark.long)])
def test_gravity_that_is_missing_or_upwards_is_named(factor, monkeypatch):
    given = replace(PLAIN, q=2e5, g=9.81)
    only(monkeypatch, "gravity-factor", "load-factor", "gg", "scheme")
    named(judged(given, g=9.81 * factor), ["gravity-factor"], {"gravity-factor": factor})


def named(answer, causes, values):
    """Causes and their numbers are these, and nothing is left."""
    assert answer.causes == causes
    assert answer.values == pytest.approx(values, rel=1e-5)
    assert answer.unexplained == 0 and answer.misfit < 1e-9


def test_a_scheme_and_a_discount_are_named_together(monkeypatch):
    monkeypatch.setattr(judgement, "rivals_of", lambda scene: ())
    among(monkeypatch, FEW)
    answer = judged(replace(PLAIN, steps=30), alpha=0.25, delta=0.5, gg=0.96)
    assert (answer.causes, answer.values) == (["scheme", "gg"], {"gg": pytest.approx(0.96)})


def test_a_run_that_diverges_is_told_so_and_nothing_else():
    answer = judged(replace(PLAIN, dt=0.01), alpha=0.05, delta=0.5)
    assert answer.causes == ["diverged"] and answer.departs
    assert answer.values == {"diverged": 14.2068}


@pytest.mark.parametrize("discount", [1.0, pytest.param(0.98, marks=pytest.mark.long)])
def test_stiffness_damping_and_a_scheme_are_told_as_two(discount, monkeypatch):
    only(monkeypatch, "stiffness-damping", "viscous-damping", "scheme", "gg", "start")
    answer = judged(replace(PLAIN, steps=60, gg=discount), structural=1e-4)
    assert answer.causes == ["unexplained"]
    assert {one["causes"][0] for one in answer.alike} == {"stiffness-damping", "scheme"}


@pytest.mark.long
@pytest.mark.parametrize("slip", [{"shaken": 0.01}, {"hardening": 20.0}])
def test_what_is_in_no_catalogue_is_not_named(slip):
    answer = judged(**slip)
    assert answer.causes == ["unexplained"] and answer.departs
    assert answer.nearest is not None and answer.values == {}


def test_causes_that_give_the_same_rows_are_told_with_a_scene_that_tells(monkeypatch):
    only(monkeypatch, "density-factor", "side-factor", "load-factor", "gg")
    half = judged(replace(PLAIN, steps=20), rho=1350.0)
    named(half, ["density-factor"], {"density-factor": 0.5})
    assert [one["causes"] for one in half.alike] == [["step-factor"], ["side-factor", "load-factor"]]
    assert half.alike[0]["values"]["step-factor"] == pytest.approx(2**0.5, rel=1e-5)
    assert "gravity" in half.alike[0]["further_scene"]


def test_the_evidence_says_which_column_is_right_by_itself(monkeypatch):
    only(monkeypatch, "pressure-shift", "time-shift", "pressure-factor", "gg")
    late = judged(late=1)
    named(late, ["pressure-shift"], {"pressure-shift": 1.0})
    stages = {stage.name: stage for stage in late.evidence}
    assert stages["displacement"].agrees and not stages["contact_pressure"].agrees
    assert all(stages[name].agrees for name in ("reading", "statics", "frequency", "damping"))


STIFF = Plain(steps=60, p=5e9, dt=0.001)


def printed(values, digits):
    return np.array([float(f"{v:.{digits - 1}e}") for v in values])


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
    answer = answer_to(STIFF, (displacement, pressure))
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
    assert answer_to(base, columns).causes == []


def test_five_digits_in_millimetres_are_a_unit_not_a_load():
    displacement, _ = run(STIFF)
    assert answer_to(STIFF, (printed(1e3 * displacement, 5),)).causes == ["unit"]


OPENS = Plain(steps=36, dt=0.001, p=3e9, alpha=0.25, delta=0.5, consistent=True, opens=True)


@pytest.mark.long
@pytest.mark.parametrize(
    ("slip", "cause"),
    [({"lags": "opening"}, "late-opening"), ({"lags": "switching"}, "late-contact"), ({"band": 1e-3}, "dead-band")],
    ids=str,
)
def test_what_switches_a_contact_is_named(slip, cause):
    assert judged(OPENS, **slip).causes == [cause]


@pytest.mark.parametrize("steps", [20, pytest.param(36, marks=pytest.mark.long)])
def test_a_tension_that_a_contact_bears_is_told_with_what_gives_the_same_rows(steps, monkeypatch):
    if steps == 20:
        monkeypatch.setattr(search, "moves", lambda *given: [])
    answer = judged(replace(OPENS, steps=steps), tension=1e6)
    assert answer.causes == ["opening-tension"]
    low, high = answer.intervals["opening-tension"]
    assert low <= 1e6 * 2 / OPENS.side <= high  # two corners, over the length of the base
    assert f"({low:.3g} to {high:.3g} Pa" in answer.sentence


def test_noise_has_no_shape_and_is_no_tenth_of_a_column():
    n = np.arange(60)
    noisy = Bar(np.zeros(60), 1.0, 5.0, 1e-3, n >= 0)
    white, slow = 1e-3 * np.random.default_rng(0).standard_normal(60), 1.2e-3 * np.sin(0.2 * n)
    assert noisy.holds(white) and not noisy.holds(0.5 * slow)
    assert not replace(noisy, norm=0.05).holds(white)
    assert replace(noisy, rounding=np.full(60, 2e-3)).holds(slow)


def test_missing_shear_springs():
    assert judged(replace(PLAIN, mu=0.2), ps=0.0).causes == ["shear-springs-factor"]
