"""The study `methods`: its gates hold, each is bitten by a fault, and it says what its scenes show."""

import math
from dataclasses import replace

import numpy as np
import pytest
from faults.fault_table import faults_of
from faults.kill_matrix import check_study
from scipy.linalg import expm

from validation import load_scene, solve
from validation.solvers.registry import get_solver
from validation.studies.methods import formulas as methods
from validation.studies.methods.methods import METHODS, SCHEMES, method


def of_scheme(change):
    """Change the scheme that the adapter hands to DDA."""
    return lambda sound: lambda scene: change(sound(scene))


def of_table(change):
    """Change the stages of a scheme other than Newmark's."""
    return of_scheme(lambda scheme: scheme if scheme.table is None else replace(scheme, table=change(scheme.table)))


def exchanged(table):
    """Exchange am and af."""
    return table._replace(stages=tuple(stage._replace(am=stage.af, af=stage.am) for stage in table.stages))


def half_split(table):
    """Let the first stage of a composite scheme end at half the step, with the numbers of another split."""
    if len(table.stages) < 2:
        return table
    first = table.stages[0]._replace(alpha=1 / 16, delta=1 / 4, e_0=1 / 16, g_0=1 / 4, d_u=1 / 2, end=1 / 2)
    return table._replace(stages=(first, *table.stages[1:]))


def from_rest(scheme):
    """Begin without the acceleration of the load."""
    return scheme if scheme.lag else replace(scheme, start="zero")


def sprung(contact):
    """Put springs in the place of a rigid stop."""
    return replace(contact, stiffness=1e12) if math.isinf(contact.stiffness) else contact


def growing(result):
    """Multiply the columns of a history by a factor that grows with the step."""
    factor = 1 + 8e3 * (result.time[1] - result.time[0])
    return {"columns": {name: factor * values for name, values in result.columns.items()}}


def long_steps(scheme):
    return replace(scheme, step=1.01 * scheme.step)


def discounted(scheme):
    return replace(scheme, gg=0.999)


def without_lag(table):
    """Take leapfrog without its first half step."""
    return table._replace(lag=0.0)


@pytest.mark.long
def test_every_gate_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    without_runs = {(row.scene, row.name) for row in methods.derived() if not row.needs}  # in test_facts.py

    def is_checked(gate):
        return (gate.scene, gate.pair[0]) not in without_runs

    check_study("methods", faults_of("methods", globals()), tmp_path, finished_cases, is_checked)


def test_every_method_is_one_scheme_of_the_theory():
    assert len({one.id for one in METHODS}) == len(METHODS)
    assert {one.group for one in SCHEMES} == {"Newmark", "generalised-alpha", "composite", "explicit"}
    for one in SCHEMES:
        assert methods.locked(one).time.scheme == one.stepping.scheme
        # 2 W0 dt of a step from rest: the scheme takes the load as its stages say
        assert one.stepping.solves == (0 if one.group == "explicit" else one.solves)


def test_the_exact_locked_block_is_that_of_the_exact_solver():
    odd = {"block.width": 1.3, "block.height": 1.7}
    case = methods.locked(method("average")).expand()[0].with_values(odd)
    exact = solve(case, "block-events").displacement
    assert (
        np.abs(methods.exact_locked(case, solve(case, "block-events").time) - exact).max() < 1e-12 * np.abs(exact).max()
    )
    assert math.isclose(case.time.duration, methods.LOCKED_TIME)


def test_a_rate_of_discount_converges_in_the_order_of_the_scheme():
    """Beside the end of M D'' + c M D' + K D = F from rest, by an exponential; without a rate `cost` gates it."""
    light = load_scene("figure-9").with_values({"time.gg": 1.0})
    model = get_solver("dda").prepare(light).model
    of_block = np.ix_([1, 4], [1, 4])  # displacement and strain along y
    stiffness = np.linalg.solve(model.mass[of_block], model.stiffness[of_block])
    load = np.linalg.solve(model.mass[of_block], model.force[[1, 4]])
    rate = 60.0
    motion = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -rate * np.eye(2)]])
    end = np.linalg.solve(motion, (expm(0.02 * motion) - np.eye(4)) @ [0.0, 0.0, *load])
    errors = []
    for steps in (400, 800):
        values = {"time.step": 0.02 / steps, "time.steps": steps, "time.start": "consistent", "time.gg_rate": rate}
        errors.append(solve(light.with_values(values), "dda").displacement[-1] - end[0])
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02) and abs(errors[1]) < 1e-4 * abs(end[0])
