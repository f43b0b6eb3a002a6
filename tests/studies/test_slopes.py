"""The studies `slopes` and `creep`: their gates hold, each is bitten by a fault, and every fault is seen."""

import math
from dataclasses import replace

import pytest
from faults.fault import changed_fields, of_first, told
from faults.fault_table import faults_of
from faults.kill_matrix import check_study

from validation import solve
from validation.scenes.scene import load_scene
from validation.studies.creep import formulas as creep
from validation.theory import friction


def of_law(**changes):
    """Change fields of the contact law, each by a function of its value."""
    return of_first(lambda model: {"contact": replace(model.contact, **changed_fields(model.contact, changes))})


def with_lag(rules):
    return "lagged"


def consistently(rules):
    return "consistent"


def atan(friction):
    """Take the angle of friction for its tangent."""
    return friction and math.atan(friction)


def squared(gg):
    return gg**2


counted_on = told(lambda found: {"slip": found.slip + found.time * 1e-6})


@pytest.mark.long
def test_every_gate_of_sliding_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    # The facts are bitten in test_facts.py.
    check_study(
        "slopes", faults_of("slopes", globals()), tmp_path, finished_cases, lambda gate: gate.scene != "slope-facts"
    )


def kept_reference(sound):
    """Let a corner that opens keep the shear reference that it had."""

    def faulty(march, length, before, after):
        sound(march, length, before, after)
        for r in range(len(after.path)):
            if after.rows.slip[r] == 0:
                after.path[r] = before.path[r]

    return faulty


CREEP = {  # scenes by their faults
    "creep-exact": (creep.EXACT,),
    "creep-springs": (creep.STIFFNESS, creep.DAMPED),
    "creep-steps": (creep.STEPS, creep.LAGGED, "creep-claim", "slope-exact-constant", "slope-exact-average"),
}


@pytest.mark.long
@pytest.mark.parametrize("name", CREEP)
def test_creep_is_gated_and_bitten(name, tmp_path, finished_cases):
    def is_checked(gate):
        return gate.scene.partition("[")[0] in CREEP[name] and (name != "creep-exact" or gate.metric != "share")

    check_study("creep", faults_of(name, globals()), tmp_path, finished_cases, is_checked)


CREEP_FACTORS = [  # slope and friction [deg], shear springs over normal ones, speed of the exact block over g / w_n
    (40.0, 45.0, 0.4, 12.4),
    (20.0, 30.0, 0.4, 0.811),
    (20.0, 22.0, 0.4, 1.210),
    (5.0, 30.0, 0.4, 0.0276),
    (10.0, 30.0, 0.4, 0.171),
    (20.0, 60.0, 0.4, 0.236),
    (20.0, 30.0, 0.1, 2.91),
]


@pytest.mark.long
@pytest.mark.parametrize(("slope", "phi", "shear", "factor"), CREEP_FACTORS)
def test_the_creep_of_the_exact_block_scales_with_g_over_w_n_by_a_factor_of_slope_friction_and_springs(
    slope, phi, shear, factor
):
    values = {"load.slope": slope, "contact.friction": phi, "contact.shear_stiffness": shear * 1e9}
    case = load_scene("creep-exact").expand()[0].with_values(values)
    history = solve(case, "block-events").history
    way = creep.slid(history.columns)[-1]
    assert way / history.time[-1] / friction.creep_scale(case) == pytest.approx(factor, rel=0.03)
