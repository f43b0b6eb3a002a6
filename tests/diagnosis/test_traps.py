"""One slip at a time in a plain DDA code of someone else's: each is named, and what is no slip is not."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.few_moves import FEW, among, only
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run

from validation.diagnosis import judgement
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign

PLAIN = Plain(steps=50)  # figures-3-4 at 2 ms


def judged(base=PLAIN, pressure=True, **slip):
    displacement, contact = run(replace(base, **slip))
    time = base.dt * np.arange(1, base.steps + 1)
    return compare(scene_of(base), Foreign(time, displacement, contact if pressure else None))


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
    assert all(stages[name].agrees for name in ("reading", "bounded", "statics", "frequency", "damping"))
