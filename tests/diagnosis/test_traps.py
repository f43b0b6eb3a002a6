"""One slip at a time in a plain DDA code of someone else's: each is named, and what is no slip is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import typed
from oracles.few_moves import only
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run

from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign

PLAIN = Plain(steps=50)  # figures-3-4 at 2 ms


def judged(base=PLAIN, pressure=True, **slip):
    displacement, contact = run(replace(base, **slip))
    time = base.dt * np.arange(1, base.steps + 1)
    return compare(scene_of(base), Foreign(time, displacement, contact if pressure else None))


MORE = [  # gg, start, formulas, springs, load and shifts are among the fifty of test_confusion
    ({"height": 2.2}, ["height-factor"], {"height-factor": 1.1}),
    ({"point": 1.0}, ["reported-point"], {"reported-point": 1.0}),
    ({"E": 0.8e9}, ["young-factor"], {"young-factor": 0.8}),
    ({"averaged": True}, ["pressure-shift"], {"pressure-shift": 0.5}),
    ({"displacement_times": 0.5}, ["load-factor"], {"load-factor": 0.5}),
    ({"side": 1.9}, ["side-factor"], {"side-factor": 0.95}),
    ({"mu": 0.3}, ["poisson"], {"poisson": 0.3}),
    ({"row_sign": -1.0}, ["load-row"], {"load-row": -1.0}),
    ({"coupling": 0.0}, ["coupling"], {"coupling": 0.0}),
    ({"keeps_stress": False}, ["stress-not-kept"], {}),
    ({"g": 9.81}, ["own-weight"], {"own-weight": 1.0}),
    # M a1 + K (0.9 x1 + 0.1 x) = F under (1/2, 1) has the rows of Newmark's (0.45, 0.9) from the consistent start
    ({"hht": -0.1}, ["scheme", "start"], {}),
    ({"ramp": 0.01}, ["load-ramp"], {"load-ramp": 0.01}),
    ({"E": 1e12}, ["young-factor"], {"young-factor": 1e3}),
]


@pytest.mark.parametrize(
    ("slip", "causes", "values"), [({}, [], {}), *(pytest.param(*m, marks=pytest.mark.long) for m in MORE)]
)
def test_a_slip_is_named_with_its_number(slip, causes, values):
    named(judged(**slip), causes, values)


GIVEN = replace(PLAIN, q=2e5, g=9.81)  # a scene with gravity, which a program may have forgotten or turned


@pytest.mark.parametrize("factor", [0.0, pytest.param(-1.0, marks=pytest.mark.long)])
def test_gravity_that_is_missing_or_upwards_is_named(factor, monkeypatch):
    only(monkeypatch, "gravity-factor", "load-factor", "gg", "scheme")
    named(judged(GIVEN, g=9.81 * factor), ["gravity-factor"], {"gravity-factor": factor})


def named(answer, causes, values):
    """Causes and their numbers are these, and nothing is left."""
    assert answer.causes == causes
    assert answer.values == pytest.approx(values, rel=1e-5)
    assert answer.unexplained == 0 and answer.misfit < 1e-9


def test_a_run_that_diverges_is_told_so_and_nothing_else():
    answer = judged(replace(PLAIN, dt=0.01), alpha=0.05, delta=0.5)
    assert answer.causes == ["diverged"] and answer.departs
    assert answer.values["diverged"] > 1.5


SHAKEN = {"shaken": 0.01}
UNKNOWN = [SHAKEN, {"hardening": 20.0}, {"hht": -0.1, "alpha": 0.3, "delta": 0.6}, {"friction": 1e5}]


@pytest.mark.long
@pytest.mark.parametrize("slip", UNKNOWN)
def test_what_is_in_no_catalogue_is_not_named(slip):
    answer = judged(**slip)
    assert answer.causes == ["unexplained"] and answer.departs
    assert answer.nearest is not None and answer.values == {}


@pytest.mark.long
def test_causes_that_give_the_same_rows_are_told_with_a_scene_that_tells():
    half = judged(rho=1350.0)
    named(half, ["density-factor"], {"density-factor": 0.5})
    assert [one["causes"] for one in half.alike] == [["step-factor"], ["side-factor", "load-factor"]]
    assert half.alike[0]["values"]["step-factor"] == pytest.approx(2**0.5, rel=1e-5)
    assert "gravity" in half.alike[0]["further_scene"]


@pytest.mark.long
def test_two_numbers_of_a_product_stand_for_two_others():
    both = judged(E=1.2e9, p=1.2e9)
    assert (both.causes, both.values) == (["unexplained"], {})
    found = {tuple(one["causes"]): one["values"] for one in both.alike}
    assert found["young-factor", "springs-factor"] == pytest.approx({"young-factor": 1.2, "springs-factor": 1.2})
    assert found["density-factor", "load-factor"] == pytest.approx({"density-factor": 1 / 1.2, "load-factor": 1 / 1.2})


def test_the_evidence_says_which_column_is_right_by_itself(monkeypatch):
    only(monkeypatch, "pressure-shift", "time-shift", "pressure-factor", "gg")
    late = judged(late=1)
    named(late, ["pressure-shift"], {"pressure-shift": 1.0})
    stages = {stage.name: stage for stage in late.evidence}
    assert stages["displacement"].agrees and not stages["contact_pressure"].agrees
    assert all(stages[name].agrees for name in ("reading", "bounded", "statics", "frequency", "damping"))


@pytest.mark.long
def test_a_tolerance_decides_what_counts_as_the_same(tmp_path):
    theirs = replace(PLAIN, rho=2725.0, steps=20)
    displacement, _ = run(theirs)
    path = tmp_path / "theirs.csv"
    rows = zip(theirs.dt * np.arange(1, theirs.steps + 1), displacement, strict=True)
    path.write_text("time,displacement\n" + "\n".join(f"{float(t)!r},{float(u)!r}" for t, u in rows))
    given = ("compare", "figures-3-4", path, "--set", "time.step=0.002", "--json")
    assert typed(*given).returncode == 1
    assert typed(*given, "--tolerance", "0.05").returncode == 0
    assert typed(*given, "--tolerance", "2").returncode == 2
