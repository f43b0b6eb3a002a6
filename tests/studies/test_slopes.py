"""The studies `slopes` and `creep`: their gates hold, each is bitten by a fault, and every fault is seen."""

import math
from dataclasses import replace

import numpy as np
import pytest
from faults import seams
from faults.fault import Fault, energy_changed, of_first, scaled, told
from faults.kill_matrix import check_study

from validation import solve
from validation.scenes.scene import load_scene
from validation.studies.creep import formulas as creep
from validation.theory import friction


def of_law(**changes):
    """Change fields of the contact law, each a function of the law."""
    return of_first(
        lambda model: {"contact": replace(model.contact, **{k: f(model.contact) for k, f in changes.items()})}
    )


def of_scheme(change):
    """Change the scheme."""
    return lambda sound: lambda model, scheme, *a, **k: sound(model, replace(scheme, **change(scheme)), *a, **k)


DDA = ("dda",)
FAULTS = [
    Fault("the angle of friction for its tangent", DDA, seams.DDA_OPENED,
          of_law(friction=lambda law: law.friction and math.atan(law.friction))),
    Fault("friction a millionth high", DDA, seams.DDA_OPENED,
          of_law(friction=lambda law: law.friction and (1 + 1e-6) * law.friction)),
    Fault("no friction at all", DDA, seams.DDA_OPENED, of_law(friction=lambda law: 0.0, cohesion=lambda law: 0.0)),
    Fault("no cohesion", DDA, seams.DDA_OPENED, of_law(cohesion=lambda law: 0.0)),
    Fault("friction lagged", DDA, seams.DDA_OPENED, of_law(rules=lambda law: "lagged")),
    Fault("the slope turned", DDA, seams.DDA_OPENED, scaled(slope=-1.0)),
    Fault("the slope in the weight only", DDA, seams.DDA_OPENED, scaled(slope=0.0)),
    Fault("gravity a millionth high", DDA, seams.DDA_OPENED, scaled(gravity=1 + 1e-6)),
    Fault("springs a thousandth soft", DDA, seams.DDA_OPENED, of_law(stiffness=lambda law: 0.999 * law.stiffness)),
    Fault("gg twice", DDA, seams.DDA_OPENED, of_scheme(lambda scheme: {"gg": scheme.gg**2})),
    Fault("gg left out", DDA, seams.DDA_OPENED, of_scheme(lambda scheme: {"gg": 1.0})),
    Fault("work of friction a hundredth high", DDA, seams.DDA_OPENED, energy_changed("friction", lambda e: 1.01 * e)),
    Fault("kinetic energy doubled", DDA, seams.DDA_OPENED, energy_changed("kinetic", lambda e: 2.0 * e)),
    Fault("energy of the load left out", DDA, seams.DDA_OPENED, energy_changed("load", np.zeros_like)),
    Fault("slip counted on", DDA, seams.DDA_OPENED, told(lambda found: {"slip": found.slip + found.time * 1e-6})),
]  # fmt: skip


@pytest.mark.long
def test_every_gate_of_sliding_is_bitten_and_every_fault_is_seen(tmp_path, finished_cases):
    # The facts are bitten in test_facts.py.
    check_study("slopes", FAULTS, tmp_path, finished_cases, lambda gate: gate.scene != "slope-facts")


def check_creep(faults, directory, finished_cases, scenes, is_checked=lambda gate: True):
    """Check the kill matrix of the gates of the study of creep on some scenes."""
    check_study(
        "creep",
        faults,
        directory,
        finished_cases,
        lambda gate: gate.scene.partition("[")[0] in scenes and is_checked(gate),
    )


CREEP = [
    Fault("friction consistent", DDA, seams.DDA_OPENED, of_law(rules=lambda law: "consistent")),
    Fault("no friction at all", DDA, seams.DDA_OPENED, of_law(friction=lambda law: 0.0)),
]


@pytest.mark.long
def test_every_gate_of_creep_holds_and_the_exact_ones_are_bitten(tmp_path, finished_cases):
    faults = [Fault("gravity a fifth high", ("block-events",), seams.EVENTS_BLOCK, scaled(gravity=1.2))]
    check_creep(faults, tmp_path, finished_cases, (creep.EXACT,), lambda gate: gate.metric != "share")


def kept_reference(sound):
    """Let a corner that opens keep the shear reference that it had."""

    def faulty(march, length, before, after):
        sound(march, length, before, after)
        for r in range(len(after.path)):
            if after.rows.slip[r] == 0:
                after.path[r] = before.path[r]

    return faulty


SPRINGS = [
    Fault("shear reference kept while open", DDA, seams.DDA_REFERENCES, kept_reference),
    Fault("gravity a hundredth high", DDA, seams.DDA_OPENED, scaled(gravity=1.01)),
    Fault("springs a thousandth soft", DDA, seams.DDA_OPENED, of_law(stiffness=lambda law: 0.999 * law.stiffness)),
    Fault("no friction at all", DDA, seams.DDA_OPENED, of_law(friction=lambda law: 0.0)),
    Fault("no friction in the exact motion", ("block-events",), seams.EVENTS_BLOCK,
          of_first(lambda problem: {"friction": 0.0})),
]  # fmt: skip


@pytest.mark.long
def test_creep_on_springs_of_any_stiffness_is_gated_and_bitten(tmp_path, finished_cases):
    check_creep(SPRINGS, tmp_path, finished_cases, (creep.STIFFNESS, creep.DAMPED))


@pytest.mark.long
def test_creep_at_fine_steps_and_its_orders_are_bitten(tmp_path, finished_cases):
    scenes = (creep.STEPS, creep.LAGGED, "creep-claim", "slope-exact-constant", "slope-exact-average")
    check_creep([*CREEP, SPRINGS[2]], tmp_path, finished_cases, scenes)


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
