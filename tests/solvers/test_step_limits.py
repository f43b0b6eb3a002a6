"""A conditionally stable scheme is refused beyond its limit by every solver that steps; what grows is named."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from conftest import thinned

from validation.engine.measure import attempt
from validation.runs.history import History
from validation.runs.run import Outcome, Run
from validation.scenes.scene import parse_scene
from validation.solvers.contract import Solver
from validation.solvers.registry import get_solver, solve
from validation.solvers.soundness import reach

BLOCK = {"side": 2.0, "density": 2700.0, "young": 1e9}
CONTACT = {"stiffness": 1e9}
OPEN = {**CONTACT, "law": "unilateral"}
PLAIN = {"block": BLOCK, "contact": CONTACT, "load": {"pressure": 5e6}}
COLUMN = {
    "motion": "shear",
    "layer": [{"thickness": 10.0, "density": 2000.0, "young": 1e8, "blocks": 4}],
}
STACK = {
    "layer": [{"thickness": 6.0, "density": 2000.0, "young": 1e8, "blocks": 3, "velocity": -0.1}],
    "stiffness": 1e9,
}


def scene(step, steps=300, **tables):
    """Return a scene under central differences, a block unless `tables` says otherwise."""
    body = {} if "column" in tables else PLAIN
    time = {"step": step, "steps": steps} | tables.get("time", {"alpha": 0.0, "delta": 0.5})
    return parse_scene({**body, "fem": {"elements": 2}, **tables, "time": time}, "limited")


def refusal(solver, limited):
    """Return why a run is refused, None where it is not."""
    run = attempt(get_solver(solver), limited, full=False)[1]
    return run.notes[-1] if run.outcome is Outcome.REFUSED else None


TABLES = tomllib.loads(Path(__file__).with_name("step_limits.toml").read_text(encoding="utf-8"))
SCENES = TABLES["limited"]


def tables_of(name):
    """Return the solver of a scene of the table, and the scene's tables."""
    own = dict(SCENES[name])
    solver = own.pop("solver")
    plain = {"column": STACK if "law" in own["column"] else COLUMN} if "column" in own else PLAIN
    return solver, own | {key: table | own.get(key, {}) for key, table in plain.items()}


@pytest.mark.parametrize("name", thinned(SCENES, 4))
def test_a_step_just_beyond_the_limit_is_refused_and_one_just_below_it_does_not_grow(name):
    solver, tables = tables_of(name)
    said = refusal(solver, scene(1.0, 2, **tables))
    assert said is not None and "allow_unstable" in said
    limit = float(said.split("must not exceed ")[1].split(" s")[0])
    assert refusal(solver, scene(1.001 * limit, 2, **tables)) is not None
    run = solve(scene(0.999 * limit, **tables), solver)
    assert run.outcome is Outcome.COMPLETED, run.notes


def test_a_rigid_stop_has_no_stable_step_of_a_conditional_scheme():
    rigid = scene(1e-6, 2, contact={**OPEN, "stiffness": math.inf, "shear_stiffness": 0.0})
    said = refusal("dda", rigid.with_values({"time.alpha": 0.2}))
    assert said is not None and "stop" in said
    assert refusal("dda", rigid.with_values({"time.alpha": 0.25})) is None


GROWING = (
    "leapfrog, opening",
    "opening",
    "turning",
    "opening sub-blocks",
    "opening mesh",
    "locked",
    "mesh",
    "column of blocks",
)


@pytest.mark.parametrize("name", thinned(GROWING, 3))
def test_a_step_that_is_allowed_runs_and_its_growth_is_an_outcome_of_its_own(name):
    solver, tables = tables_of(name)
    run = solve(scene(0.05, 20, **tables).with_values({"time.allow_unstable": True}), solver)
    assert run.outcome is Outcome.UNBOUNDED, run.notes


class Driven(Solver):
    """A solver that returns the history that a test gives it."""

    name = "driven"

    def __init__(self, values):
        self.values = np.asarray(values, float)

    def solve(self, scene, full=False, fields=None):
        time = scene.time.step * np.arange(1.0, scene.time.steps + 1)
        return Run(Outcome.COMPLETED, History(time, {"displacement": self.values}))


@pytest.mark.parametrize(
    ("values", "outcome", "last"),
    [
        ([0.0, math.nan, 0.0], Outcome.NOT_A_NUMBER, "2"),
        ([0.0, math.inf, 0.0], Outcome.OVERFLOW, "2"),
        ([0.0, 0.0], Outcome.WRONG_SHAPE, "(3,)"),
        ([0.0, -1e15, 0.0], Outcome.UNBOUNDED, "2"),
        ([0.0, -1.0, 0.0], Outcome.COMPLETED, ""),
    ],
)
def test_solve_from_python_names_what_is_wrong_with_a_history_and_at_which_step(values, outcome, last):
    plain = scene(1e-3, 3, run={"columns": ["displacement"]})
    run = solve(plain, Driven(values))
    assert run.outcome is outcome
    assert "".join(run.notes).endswith(last)


def test_the_motion_of_a_base_enters_the_bound(tmp_path):
    record = tmp_path / "base.csv"
    record.write_text("time,x\n0,0\n1,2\n2,2\n")
    shaken = scene(1e-3, 1000, load={"base_motion": str(record)})
    assert reach(shaken) == pytest.approx(1.0 * 2 * 2 + 2.0, rel=0.01)  # T (2 m/s up and down again) + max |y|
    record.unlink()
    assert reach(shaken) == math.inf


RESTING = STACK | {"layer": [STACK["layer"][0] | {"velocity": 0.0}]}


@pytest.mark.parametrize("solver", ["dda", "fem"])
@pytest.mark.parametrize("case", TABLES["ends"].values(), ids=TABLES["ends"])
def test_what_cannot_be_stepped_is_an_outcome(case, solver):
    plain = RESTING if case["column"].get("law") == "unilateral" else COLUMN
    base = {"shape": "half-sine", "velocity": 0.1, "duration": 0.01}
    limited = scene(1e-4, 20, column=plain | case["column"], input=base)
    limited = limited.with_values({f"time.{key}": value for key, value in case["time"].items()})
    if get_solver(solver).refusal(limited):
        return  # it takes no such blocks
    run = attempt(get_solver(solver), limited, full=False)[1]
    assert run.outcome == case["outcome"]
    assert case["says"] in run.notes[-1]
