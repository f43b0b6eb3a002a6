"""The linear stepping of candidate changes: the suite's solver, closed forms and loops written for one scheme each."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.sliding_block import Plain, run

import dda
from validation import load_scene, solve
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Rectangle, Variant, own_variant, rectangle_of

DT, STEPS = 1e-3, 60
BLOCK = Rectangle(2.0, 1.5, 2700.0, 1e9, 0.0, False, 4e9, 4e9, 5e6, 9.81)
OWN = Variant(0.5, 1.0, 1.0)


def stepped(variant, rectangle=BLOCK):
    found = histories(rectangle, [OWN, variant], np.full(STEPS, DT))
    return found.displacement[:, 1], found.pressure[:, 1]


def close(one, other, tolerance=1e-10):
    for values, expected in zip(one, other, strict=True):
        assert np.max(np.abs(values - expected)) < tolerance * np.max(np.abs(expected))


def solved(scheme, steps=STEPS):
    found = dda.solve(BLOCK.model, scheme, steps)
    return found.columns["displacement"], found.columns["contact_pressure"]


OBLONG = {"block.width": 3.0, "block.height": 2.0}
OPENING = {"time.step": 5e-4, "contact.law": "unilateral"}
# the scene, what else dda is given, and the same as a candidate change
AS_DDA = [
    ({"time.alpha": 0.25, "time.delta": 0.5, "time.gg": 0.98, "time.start": "consistent"}, {}, {}),
    (
        {"block.poisson": 0.3, "time.step": 0.0007, "contact.stiffness": 3e9},
        {"contact.stiffness": 2e9},
        {"softness": np.log(1.5)},
    ),
    ({"block.poisson": 0.2, "block.hypothesis": "plane strain", "load.gravity": 9.81, "time.gg": 0.9} | OBLONG, {}, {}),
    ({"time.alpha": 0.0, "time.delta": 0.5, "time.step": 0.0005, "block.density": 1800.0}, {}, {}),
    ({"time.scheme": "chung-hulbert", "time.rho_inf": 0.7, "time.gg": 0.98}, {}, {}),
    ({"time.scheme": "hht", "time.rho_inf": 0.6, "time.start": "consistent", "load.gravity": 9.81} | OPENING, {}, {}),
    ({"time.scheme": "wbz", "time.rho_inf": 0.3, "time.gg": 0.98} | OPENING, {}, {}),
    ({"time.scheme": "leapfrog", "time.start": "consistent", "time.gg": 0.98} | OPENING, {}, {}),
    ({"time.scheme": "composite", "time.rho_inf": 0.4, "time.split": 0.35, "load.gravity": 9.81}, {}, {}),
    (OPENING, {"time.gg": 0.98, "load.gravity": 9.81 / 2}, {"gg": 0.98, "weight": 0.5}),
    (OPENING, {"contact.band": [1e-3, 1e-6]}, {"band": 1e-3, "reopening": 1e-3}),
    # with Poisson's ratio a closed contact is sheared from where it touched
    (OPENING | {"block.poisson": 0.3}, {"block.density": 2160.0, "block.young": 1.2e9}, {"density": 0.8, "young": 1.2}),
]


@pytest.mark.parametrize(("scene", "given", "changes"), AS_DDA)
def test_a_candidate_change_is_stepped_as_dda_steps_it(scene, given, changes):
    base = {"time.step": 0.002, "time.steps": 80, "run.solvers": ["dda"]}
    scene = load_scene("figures-3-4").with_values(base | scene)
    run = solve(scene.with_values(given), "dda")
    own = own_variant(scene)
    found = histories(
        rectangle_of(scene), [replace(own, gg=0.5), replace(own, **changes)], np.full(80, scene.time.step)
    )
    # two formulations of one recursion over 80 steps, a contact that switches: hundreds of roundings at most
    close([found.displacement[:, 1]], [run.displacement], 1e-12)
    close([found.pressure[:, 1]], [run.contact_pressure], 1e-10)


@pytest.mark.parametrize("poisson", [0.0, 0.3])
def test_powers_of_one_step_are_the_steps_one_by_one(poisson):
    """The same variant stepped in a loop, as unequal steps are: one of them longer by less than a rounding shows."""
    rectangle = replace(BLOCK, poisson=poisson)
    variant = Variant(0.3, 0.6, 0.98, "consistent", softness=0.2, base=5.0, viscous=3.0, point=0.5, coupling=0.9)
    steps = np.full(STEPS, DT)
    steps[0] *= 1 + 1e-8
    loop = histories(rectangle, [variant], steps)
    close(stepped(variant, rectangle), (loop.displacement[:, 0], loop.pressure[:, 0]), 1e-7)


def test_rows_that_come_late_are_open_late():
    opens = replace(OWN, opens=True)
    run = histories(replace(BLOCK, gravity=0.0), [opens, replace(opens, shift=2.0)], np.full(STEPS, DT))
    assert np.array_equal(run.open[2:, 1], run.open[:-2, 0]) and np.any(run.open) and not np.any(run.open[:2, 1])


def test_several_steps_in_one_are_a_run_at_a_part_of_the_step():
    fine = solved(dda.Scheme(0.5, 1.0, 1.0, DT / 4), 4 * STEPS)
    close(stepped(replace(OWN, parts=4)), [column[3::4] for column in fine])


def test_what_is_exact_in_time_is_the_limit_of_fine_steps():
    """Average acceleration errs by (w dt)^2 / 12 of the phase: 128 steps in one leave some 5e-5."""
    fine = solved(dda.Scheme(0.25, 0.5, 1.0, DT / 128, "consistent"), 128 * STEPS)
    close(stepped(replace(OWN, exact=True)), [column[127::128] for column in fine], 3e-4)


OPENS = {"opens": True}
SOFT = 8e9  # N/m, of a base that yields
# slips of a program, and the same as a candidate change
SLIPS = [
    ({"ramp": 0.0125}, {"ramp": 0.0125}),
    ({"ramp": 0.0125, "consistent": True}, {"ramp": 0.0125, "start": "consistent"}),
    *(({"formulas": one}, {"discounted": one}) for one in ("velocity", "displacement")),
    ({"viscous": 8.0, "structural": 2e-4}, {"viscous": 8.0, "structural": 2e-4}),
    ({"point": 0.7}, {"point": 0.7}),
    ({"late": 2}, {"late": 2.0}),
    ({"averaged": True}, {"late": 0.5}),
    ({"row_sign": -1.0}, {"strain_load": -1.0}),
    ({"coupling": 0.6}, {"coupling": 0.6}),
    ({"keeps_stress": False}, {"kept": "springs"}),
    ({"updated": True}, {"updated": True}),
    ({"g": 3.0, "mu": 0.2, "strain": True}, {"weight": 3.0 / 9.81, "poisson": 0.2, "other_plane": True}),
    ({"base": (5.0, SOFT)}, {"base": 5.0, "softness": np.log1p(2e9 / SOFT)}),
    ({"pressure_times": 0.6, "displacement_times": 1.3}, {"pressure_factor": 0.6, "displacement_factor": 1.3}),
    (OPENS, OPENS),
    (OPENS | {"band": 1e-3, "opening_band": 2e-4}, OPENS | {"band": 1e-3, "reopening": 0.2}),
    (OPENS | {"tension": 3e5}, OPENS | {"hold": 3e5 / 1e9}),
    *((OPENS | {"lags": lags}, OPENS | {"lags": lags}) for lags in ("opening", "switching")),
]


def test_slips_of_a_plain_program_are_stepped_as_that_steps_them():
    """It may start from the acceleration of the full load, although none of it is there at first."""
    rectangle = Rectangle(2.0, 2.0, 2700.0, 1e9, 0.0, False, 2e9, 2e9, 5e6)
    own = replace(OWN, alpha=0.3, delta=0.6, gg=0.98)
    for slip, changes in SLIPS:
        program = Plain(dt=DT, steps=STEPS, alpha=0.3, delta=0.6, gg=0.98, **slip)
        close(stepped(replace(own, **changes), rectangle), run(program), 1e-8)


@pytest.mark.parametrize("discounted", ["both", "(6)", "(7)"])
def test_steps_of_other_lengths_are_newmark_s_formulas_of_the_increment(discounted):
    """One mode, a block so stiff that it only moves on its springs; velocity and acceleration are not per step."""
    rigid = replace(BLOCK, young=1e17, gravity=0.0)
    mass = rigid.density * rigid.width * rigid.height
    alpha, delta, gg = 0.3, 0.6, 0.97
    in_6 = gg if discounted != "(7)" else 1.0
    in_7 = gg if discounted != "(6)" else 1.0
    steps = DT * (1 + 0.5 * np.sin(np.arange(STEPS)))
    x, v, a, rows = 0.0, 0.0, 0.0, []
    for dt in steps:
        carried = in_6 * v / (alpha * dt) + (0.5 / alpha - 1) * a
        load = -rigid.pressure * rigid.width - rigid.normal * x
        d = (load + mass * carried) / (mass / (alpha * dt * dt) + rigid.normal)
        v = delta * d / (alpha * dt) + in_7 * (1 - delta / alpha) * v + (1 - 0.5 * delta / alpha) * dt * a
        a = d / (alpha * dt * dt) - carried
        x += d
        rows.append(x)
    run = histories(rigid, [replace(OWN, alpha=alpha, delta=delta, gg=gg, discounted=discounted)], steps)
    close([run.displacement[:, 0]], [np.array(rows)], 1e-6)


def test_implicit_euler_is_newmark_s_1_and_three_halves_from_rest():
    euler = stepped(replace(OWN, family="theta", spectral=1.0, start="consistent"))
    close(stepped(replace(OWN, alpha=1.0, delta=1.5)), euler)
