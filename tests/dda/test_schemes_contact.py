"""Schemes by name where contact opens or slips: one block, columns, sub-blocks."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.frictional import shaken
from oracles.scheme_cases import every_scheme, few_schemes, scheme_of, truth_of
from oracles.staged import System, march
from oracles.unilateral_checks import apart

from dda import (
    COLUMNS,
    BaseMotion,
    Block,
    Load,
    Material,
    Unilateral,
    UnilateralModel,
    UnilateralOptions,
    named_scheme,
    opening_subdivided,
    response,
    solve_unilateral,
)
from dda.bodies.bonded_column import Drive, solve_column
from dda.bodies.column import Column, Layer, Spring
from dda.bodies.column_equations import equations
from dda.bodies.contact_column import ColumnOptions, solve_contact_column
from dda.bodies.opening_block import unknowns_of
from dda.linear.natural_modes import free_modes

ENERGIES = UnilateralOptions(energies=True)


def block(mu=0.0, height=2.0):
    return Block.rectangle(2.0, height, Material(2700.0, 1e9, mu, "plane stress"))


def total(energies):
    """Return what is stored and what was lost, whose sum does not change."""
    return functools.reduce(np.add, energies.values())


# ---- one block -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("gg", [pytest.param(1.0, marks=pytest.mark.long), 0.97])
@every_scheme
def test_a_block_that_lands_and_bounces_is_the_one_of_the_papers(name, values, gg):
    step, steps, p = 2e-4, 150, 2e9
    model = UnilateralModel(block(0.25, 1.5), Unilateral(p, gap=2e-4), Load(3e6, 0.1), velocity=-0.3)
    form = model.reduced
    assert form.contacts == 2
    system = System(form.M, np.diag(form.K), lambda t: form.F, B=form.B[:2], p=p)
    start = -0.3 * (form.translation @ form.axes[:, 1])
    x, v, N = march(system, name, step, steps, form.start, start, gg, **truth_of(values))
    result = solve_unilateral(model, scheme_of(name, values, step, gg), steps)
    D = unknowns_of(form, result.history, None, step).T
    V = result.history.motion[:, 6:] @ free_modes(form.M, form.K)[1].T / step
    for found, expected in ((D, x), (V, v), (result.history.force, N)):
        assert np.max(np.abs(found - expected)) < 1e-12 * np.max(np.abs(expected))
    switches = np.count_nonzero(np.diff(result.closed, axis=1))
    assert switches >= 2 and result.solves >= steps * len(scheme_of(name, values, step).stages)


# ---- columns ---------------------------------------------------------------------------------------------------------

LAYERS = (Layer(1.0, 2000.0, 5e7, 0.0, 1, -0.1), Layer(0.7, 2500.0, 8e7, 0.0, 1, -0.1))


def still_drive(scheme, steps, pressure=2e4):
    none = np.zeros(1 + steps * len(scheme.stages))
    return Drive(none, none, none, none + pressure)


def open_column(scheme, steps):
    springs = [Spring(0.0, 3e8, gap=1e-5), Spring(1.0, 2e8)]
    return Column(LAYERS, joints=springs, law="unilateral", gravity=9.81), still_drive(scheme, steps)


@pytest.mark.parametrize("gg", [pytest.param(1.0, marks=pytest.mark.long), 0.97])
@few_schemes
def test_a_column_that_opens_is_the_one_of_the_papers(name, values, gg):
    step, steps, p = 2e-4, 200, 2e4
    scheme = scheme_of(name, values, step, gg)
    column, drive = open_column(scheme, steps)
    options = ColumnOptions(energies=True)
    result = solve_contact_column(
        column, scheme, drive, ("displacement", "contact_pressure", "velocity_1"), [1.7], options
    )
    m, K = np.array([2000.0, 1750.0]), np.array([5e7, 8e7 / 0.7])
    M = np.diag([m[0], m[0] / 12, m[1], m[1] / 12])
    load = np.array([-9.81 * m[0], 0.0, -9.81 * m[1] - p, -p / 2])
    B = np.array([[1, -0.5, 0, 0], [-1, -0.5, 1, -0.5]])
    system = System(
        M, np.diag([0.0, K[0], 0.0, K[1]]), lambda t: load, B=B, p=np.array([3e8, 2e8]), gap=np.array([1e-5, 0.0])
    )
    x, v, N = march(system, name, step, steps, np.zeros(4), np.array([-0.1, 0, -0.1, 0]), gg, **truth_of(values))
    expected = {
        "displacement": x[1:, 2] + x[1:, 3] / 2,
        "contact_pressure": N[1:, 0],
        "velocity_1": v[1:, 2] + v[1:, 3] / 2,
    }
    for column_name, truth in expected.items():
        assert np.max(np.abs(result.columns[column_name] - truth)) < 1e-12 * np.max(np.abs(truth)), column_name
    assert result.step_switches.sum() >= 2 and result.solves >= steps * len(scheme.stages)
    balance = total(result.energies)
    assert np.ptp(balance) < 1e-12 * np.max(np.abs(result.energies["load"]))


@few_schemes
def test_a_column_that_slips_closes_the_balance(name, values):
    scheme = scheme_of(name, values, 2e-4, 0.995)
    t = scheme.instants(200)
    drive = Drive(1e-3 * np.sin(120 * t), 0.12 * np.cos(120 * t), -14.4 * np.sin(120 * t), 0 * t)
    springs = [Spring(0.0, 3e8, strength=6e3), Spring(1.0, 2e8, strength=4e3)]
    column = Column([replace(layer, velocity=0.0) for layer in LAYERS], "shear", joints=springs, law="frictional")
    result = solve_contact_column(column, scheme, drive, options=ColumnOptions(energies=True))
    energies = result.energies
    assert energies["friction"][-1] > 0 and np.min(np.diff(energies["friction"])) >= -1e-9
    assert np.ptp(total(energies)) < 1e-12 * np.max(np.abs(energies["load"]))


@pytest.mark.parametrize("impedance", [None, 3e5])
@few_schemes
def test_a_bonded_column_steps_to_its_response(name, values, impedance):
    frequency, steps = 20.0, 700
    scheme = scheme_of(name, values, 4e-4, 0.93)
    bonded = Column([Layer(1.0, 2000.0, 5e7), Layer(0.7, 2500.0, 8e7)], joints=[Spring(1.0, 2e8)], impedance=impedance)
    t = scheme.instants(steps)
    pressure = np.cos(2 * np.pi * frequency * t)
    drive = Drive(0 * t, 0 * t, 0 * t, pressure)
    if name == "leapfrog" and impedance:
        with pytest.raises(ValueError, match=r"^impedance: "):
            solve_column(bonded, scheme, drive)
        return
    result = solve_column(bonded, scheme, drive)
    if name == "composite":
        with pytest.raises(ValueError, match=r"^scheme: "):
            response(equations(bonded), scheme, [frequency])
        return
    for column, (amplitude,) in response(equations(bonded), scheme, [frequency]).items():
        expected = (amplitude * np.exp(2j * np.pi * frequency * result.time)).real
        rest = (result.columns[column] - expected)[-250:]  # five periods
        rest -= np.mean(rest)  # on a dashpot alone a column stays where its start has brought it
        assert np.max(np.abs(rest)) < 1e-6 * abs(amplitude), column


# ---- sub-blocks ------------------------------------------------------------------------------------------------------


@few_schemes
def test_one_sub_block_on_a_base_that_shakes_is_the_block(name, values):
    scheme = scheme_of(name, values, 1e-4, 0.99)
    law = Unilateral(2e8, 1e8, friction=0.3)
    load = Load(1e5, 0.0, 5e4, 9.81, shaken(np.random.default_rng(0), 1e-4))
    model = UnilateralModel(block(0.25, 1.5), law, load, velocity=-0.01)
    one = solve_unilateral(model, scheme, 150, COLUMNS, ENERGIES)
    sub = solve_unilateral(opening_subdivided(model, 1, 1, 1e12), scheme, 150, COLUMNS, ENERGIES)
    for column in COLUMNS:
        assert np.max(np.abs(one.columns[column] - sub.columns[column])) < 1e-11 * np.max(np.abs(one.columns[column]))
    assert np.array_equal(sub.states, one.states) and np.any(np.abs(one.states) == 2)
    for field in ("normal", "shear", "gap", "slide", "slip"):
        assert apart(getattr(sub, field), getattr(one, field)) < 1e-10, field
    for mine, its in zip(sub.base_contacts, one.base_contacts, strict=True):
        assert apart(sub.normal[mine], one.normal[its]) < 1e-10
    assert sub.solves == one.solves and sub.slip[-1] == pytest.approx(one.slip[-1], rel=1e-11) and one.slip[-1] > 0
    stays = one.closed[:, 1:] & one.closed[:, :-1]  # where the slips of all stages are what the reference moves by
    moved = np.diff(one.slide + one.shear / law.shear)
    assert np.max(np.abs(moved - one.slipped[:, 1:])[stays]) < 1e-11 * np.max(np.abs(one.slide))
    assert sub.velocity == pytest.approx(one.velocity, rel=1e-9, abs=1e-12)
    for part, energy in one.energies.items():
        assert np.max(np.abs(energy - sub.energies[part])) < 1e-10 * np.max(one.energies["kinetic"]), part


# ---- two stages ------------------------------------------------------------------------------------------------------

SMALL = named_scheme("composite", step=1e-4)
CONTACT_SPEED = math.sqrt(2e6)  # rad/s, of a block of 4000 kg over 8e9 N/m and of one of 5000 kg/m^2 over 1e10 Pa/m


def pressed_block():
    """Return what the block loses whose load rises and whose base moves."""
    t = np.linspace(0, 0.04, 401)
    motion = BaseMotion(t, 1e-6 * np.column_stack([1 - np.cos(200 * t), 1 - np.cos(150 * t)]))
    high = Block.rectangle(1.0, 2.0, Material(2000.0, 1e9, 0.2))
    model = UnilateralModel(high, Unilateral(4e9, 1e9, friction=0.6), Load(1e6, ramp=0.03, motion=motion))
    return solve_unilateral(model, SMALL, 400, options=ENERGIES).energies


def column_on_a_half_space():
    """Return what the column loses whose load rises and below which a wave comes up."""
    joints = [Spring(2.0 * i, 1e10) for i in range(1, 5)]
    column = Column([Layer(10.0, 2500.0, 2e9, 0.2, 5)], joints=joints, law="unilateral", gravity=9.81, impedance=2e6)
    t = SMALL.instants(400)
    wave = (1e-3 * (1 - np.cos(80 * t)), 8e-2 * np.sin(80 * t), 6.4 * np.cos(80 * t))
    drive = Drive(*wave, 1e6 * np.minimum(t / 0.03, 1))
    return solve_contact_column(column, SMALL, drive, options=ColumnOptions(energies=True)).energies


@pytest.mark.parametrize("lost", [pressed_block, column_on_a_half_space])
def test_the_work_of_two_stages_leaves_the_algorithm_little(lost):
    """The work in a stage is by the trapezoidal rule, (omega h)^2/12 off; the algorithm loses what it leaves."""
    energies = lost()
    given = np.ptp(energies["load"])
    assert given > 0 and np.max(np.abs(energies["algorithmic"])) < (CONTACT_SPEED * SMALL.step) ** 2 / 12 * given
