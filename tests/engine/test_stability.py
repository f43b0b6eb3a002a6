"""Outcomes by name, spectral radii, limits by bisection, and growth beyond them."""

from types import SimpleNamespace

import numpy as np
import pytest
from conftest import thinned

from validation import load_scene
from validation.engine import stability
from validation.engine.case import Case
from validation.engine.measure import execute
from validation.metrics.growth import Stability
from validation.metrics.values import NOT_REPORTED
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.solvers.contract import Prepared, Solver
from validation.solvers.registry import get_solver

EXPLICIT, LINEAR = {"time.alpha": 0.0, "time.delta": 0.5}, {"time.alpha": 1 / 6, "time.delta": 0.5}


@pytest.fixture
def scene(scene_file):
    return load_scene(scene_file).with_values({"time.allow_unstable": True})


def row(scene, solver="dda", measures=("stability",)):
    return execute(Case(scene, solver, measures=measures), "k", "s")[0]


NAMES = [
    ({}, Outcome.COMPLETED, Stability.STABLE),
    ({"time.alpha": 0.25, "time.delta": 0.5}, Outcome.COMPLETED, Stability.MARGINAL),
    (EXPLICIT | {"time.step": 0.01}, Outcome.UNSTABLE, Stability.UNSTABLE),
    (EXPLICIT | {"time.step": 1e3}, Outcome.OVERFLOW, Stability.OVERFLOW),
]


@pytest.mark.parametrize(
    ("solver", "values", "outcome", "kind"),
    thinned([(s, *each) for s in ("dda", "fem", "dda-60") for each in NAMES], 3),
)
def test_every_outcome_has_its_name(scene, solver, values, outcome, kind):
    found = row(scene.with_values(values | {"fem.elements": 2}), solver)
    assert (found.outcome, found.metrics["stability.kind"]) == (outcome, kind)
    assert any("predicted growth" in note for note in found.notes) is (kind in (Stability.UNSTABLE, Stability.OVERFLOW))
    assert outcome.sentence.endswith(".") and kind.sentence.endswith(".")


def test_growth_seen_is_the_spectral_radius_predicted(scene):
    case = scene.with_values(LINEAR | {"time.step": 0.006, "time.gg": 0.9, "time.steps": 120})
    found = row(case)
    assert found.metrics["stability.growth"] == pytest.approx(found.metrics["stability.radius"], rel=1e-9)
    assert found.metrics["stability.radius_seen"] == pytest.approx(found.metrics["stability.radius"], rel=1e-12)
    assert found.metrics["stability.radius"] > 1.1
    assert "predicted" in found.notes[-1]


class Grower(Solver):
    """A solver whose history grows by 1.5 a step and whose modes say otherwise."""

    name = "grower"

    def solve(self, scene, full=False, fields=None):
        values = 1.5 ** np.arange(scene.time.steps) * (self.sound if scene.time.steps > 10 else 0.0)
        return Run(Outcome.COMPLETED, History(values, {"displacement": values}))

    def diagnostics(self, scene):
        return {"predicted_radius": 1.2, "spectral_radius": 1.2, "largest_omega": 1.0}

    def modes(self, scene):
        return ()


def test_a_run_without_a_history_or_a_prediction_is_returned_as_it_is(scene):
    prepared = SimpleNamespace(diagnostics=Prepared.diagnostics.__get__(object()))
    grown = Run(Outcome.COMPLETED, History(np.ones(3), {"displacement": 1.5 ** np.arange(3)}))
    for run in (Run(Outcome.TIMEOUT), Run(Outcome.COMPLETED), grown):
        assert stability.with_growth_outcome(run, prepared, scene) is run


@pytest.mark.parametrize(("sound", "steps"), [(1.0, 50), (0.0, 50), (0.0, 400), (1.0, 400)])
def test_growth_at_another_rate_is_named(scene, sound, steps):
    solver = Grower()
    solver.sound = sound
    case = scene.with_values({"time.steps": steps, "run.columns": ["displacement"]})
    run = stability.with_growth_outcome(solver.solve(case), solver.prepare(case), case)
    assert run.outcome is (Outcome.MISPREDICTED if sound else Outcome.COMPLETED)
    assert run.outcome.sentence.endswith(".")


def test_growth_too_slow_to_show_is_said(scene):
    case = scene.with_values(EXPLICIT)
    fastest = get_solver("dda").diagnostics(case)["largest_omega"] / case.time.step
    found = row(case.with_values({"time.step": 2.001 / fastest, "time.steps": 20}))
    assert found.outcome is Outcome.COMPLETED and found.metrics["stability.kind"] == Stability.UNSTABLE
    assert "few" in found.notes[-1]


LIMITS = [
    (EXPLICIT, 1.0, 2.0),
    (LINEAR, 1.0, 2 * np.sqrt(3)),
    ({"time.alpha": 0.1, "time.delta": 0.6}, 1.0, 1 / np.sqrt(0.2)),
    # with gg: Omega^2 = 2 (1 + gg) / [1/2 + gg (2 delta - 1/2) - 2 alpha (1 + gg)]
    ({"time.alpha": 0.1, "time.delta": 0.6}, 0.8, np.sqrt(3.6 / (0.5 + 0.8 * 0.7 - 0.36))),
]


@pytest.mark.parametrize(
    ("solver", "values", "gg", "limit"),
    thinned([(solver, *each) for solver in ("dda", "fem") for each in reversed(LIMITS)], 9),
)
def test_limits_by_bisection_are_the_closed_forms(scene, solver, values, gg, limit):
    case = scene.with_values(values | {"time.gg": gg, "fem.elements": 1})
    assert stability.limit(get_solver(solver), case) == pytest.approx(limit, rel=1e-6)


def test_without_a_limit_bisection_says_so(scene):
    assert stability.limit(get_solver("dda"), scene) == "undefined"
    assert stability.limit(get_solver("bar"), scene) == NOT_REPORTED
    assert row(scene, measures=("limit",)).metrics == {"stability.limit": "undefined"}
