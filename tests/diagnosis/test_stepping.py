"""The linear stepping of candidate changes: the suite's solver, closed forms and loops written for one scheme each."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.sliding_block import Plain, run

import dda
from validation.diagnosis.fits.target import Target
from validation.diagnosis.schemes import stages
from validation.diagnosis.stepping import histories
from validation.diagnosis.variant import Rectangle, Variant

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


@pytest.mark.parametrize("poisson", [0.0, 0.3])
def test_powers_of_one_step_are_the_steps_one_by_one(poisson):
    """The same variant stepped in a loop, as unequal steps are: one of them longer by less than a rounding shows."""
    rectangle = replace(BLOCK, poisson=poisson)
    variant = Variant(0.3, 0.6, 0.98, "consistent", softness=0.2, base=5.0, viscous=3.0, point=0.5, coupling=0.9)
    steps = np.full(STEPS, DT)
    steps[0] *= 1 + 1e-8
    loop = histories(rectangle, [variant], steps)
    close(stepped(variant, rectangle), (loop.displacement[:, 0], loop.pressure[:, 0]), 1e-7)


@pytest.mark.parametrize("damping", [(8.0, 0.0), (0.0, 2e-4)])
def test_viscous_damping_is_that_of_the_suites_own_scheme(damping):
    mass, stiffness = damping
    variant = replace(OWN, viscous=mass, structural=stiffness)
    close(stepped(variant), solved(dda.Scheme(0.5, 1.0, 1.0, DT, mass_damping=mass, stiffness_damping=stiffness)))


def test_several_steps_in_one_are_a_run_at_a_part_of_the_step():
    fine = solved(dda.Scheme(0.5, 1.0, 1.0, DT / 4), 4 * STEPS)
    close(stepped(replace(OWN, parts=4)), [column[3::4] for column in fine])


def test_what_is_exact_in_time_is_the_limit_of_fine_steps():
    """Average acceleration errs by (w dt)^2 / 12 of the phase: 256 steps in one leave some 1e-5."""
    fine = solved(dda.Scheme(0.25, 0.5, 1.0, DT / 256, "consistent"), 256 * STEPS)
    close(stepped(replace(OWN, exact=True)), [column[255::256] for column in fine], 3e-4)


@pytest.mark.parametrize("consistent", [False, True])
def test_a_load_that_comes_on_in_time_is_that_of_a_plain_code(consistent):
    """A program may start from the acceleration of the full load, although none of it is there at first."""
    program = Plain(dt=DT, steps=STEPS, ramp=0.0125, alpha=0.3, delta=0.6, consistent=consistent)
    rectangle = Rectangle(2.0, 2.0, 2700.0, 1e9, 0.0, False, 2e9, 2e9, 5e6)
    start = "consistent" if consistent else "zero"
    close(stepped(replace(OWN, alpha=0.3, delta=0.6, gg=1.0, ramp=0.0125, start=start), rectangle), run(program))


@pytest.mark.parametrize(
    ("family", "number"), [("hht", 0.1), ("hht", 1 / 3), ("chung-hulbert", 0.0), ("chung-hulbert", 0.8)]
)
def test_generalised_alpha_is_its_recursion_mode_by_mode(family, number):
    """One mode, a block so stiff that it only moves on its springs: x'' + w^2 x = f by the textbook's equations."""
    rigid = replace(BLOCK, young=1e17, gravity=0.0)
    w2 = rigid.normal / (rigid.density * rigid.width * rigid.height)
    force = -rigid.pressure * rigid.width / (rigid.density * rigid.width * rigid.height)
    am, af = (0.0, number) if family == "hht" else ((2 * number - 1) / (number + 1), number / (number + 1))
    beta, gamma = (1 - am + af) ** 2 / 4, 0.5 - am + af
    x, v, a, rows = 0.0, 0.0, force, []
    for _ in range(STEPS):
        # (1 - am) a1 + am a + w^2 ((1 - af) x1 + af x) = f,  x1 = known + beta dt^2 a1
        known = x + DT * v + DT * DT * (0.5 - beta) * a
        new = (force - am * a - w2 * ((1 - af) * known + af * x)) / (1 - am + (1 - af) * beta * DT * DT * w2)
        x, v, a = known + beta * DT * DT * new, v + DT * ((1 - gamma) * a + gamma * new), new
        rows.append(x)
    variant = replace(OWN, family=family, spectral=number, start="consistent")
    displacement, _ = stepped(variant, rigid)
    close([displacement], [np.array(rows)], 1e-6)
    (stage,) = stages(variant)
    assert math.isclose(stage.beta, beta) and math.isclose(stage.gamma, gamma)


def test_steps_of_other_lengths_are_newmark_s_recursion_in_seconds():
    """One mode, a block so stiff that it only moves on its springs; velocity and acceleration are not per step."""
    rigid = replace(BLOCK, young=1e17, gravity=0.0)
    mass = rigid.density * rigid.width * rigid.height
    steps = DT * (1 + 0.5 * np.sin(np.arange(STEPS)))
    x, v, a, rows = 0.0, 0.0, 0.0, []
    for dt in steps:
        known = x + dt * v + dt * dt * 0.2 * a
        new = (-rigid.pressure * rigid.width - rigid.normal * known) / (mass + 0.3 * dt * dt * rigid.normal)
        x, v, a = known + 0.3 * dt * dt * new, v + dt * (0.4 * a + 0.6 * new), new
        rows.append(x)
    run = histories(rigid, [replace(OWN, alpha=0.3, delta=0.6)], steps)
    close([run.displacement[:, 0]], [np.array(rows)], 1e-6)


def test_implicit_euler_is_newmark_s_1_and_three_halves_from_rest():
    euler = stepped(replace(OWN, family="theta", spectral=1.0, start="consistent"))
    close(stepped(replace(OWN, alpha=1.0, delta=1.5)), euler)


def test_a_variant_that_grows_beyond_any_double_is_far_away_and_says_nothing():
    """Central differences at a step beyond their limit: warnings are errors here, and the other variant stays."""
    steps = np.full(400, 0.05)
    target = Target(BLOCK, steps, np.arange(400), np.full((1, 400), -1e-9))
    found = target.responses([OWN, replace(OWN, alpha=0.0, delta=0.5)])
    assert np.all(np.abs(found) <= 1e6) and np.abs(found[-1, 1]) == 1e6
    assert np.all(np.isfinite(histories(BLOCK, [OWN], steps).displacement))
