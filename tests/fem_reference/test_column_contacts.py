"""Line elements on contacts that open or slip: balances in every step, natural modes, weights."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned

from fem_reference.column.contact_model import ColumnContact, ContactColumn
from fem_reference.column.contact_system import column_at_start, model_of, stepper_of, system_of
from fem_reference.column.contacts import solve_contacts
from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.column.stepping import observed_by
from fem_reference.contact import compilation
from fem_reference.contact.iteration import CONVERGED
from fem_reference.contact.law import AT_LOWER, AT_UPPER, INSIDE
from fem_reference.problem.problem import Scheme

AVERAGE, CONSTANT = (0.25, 0.5), (0.5, 1.0)


def scheme(numbers, dt, gg=1.0, start="consistent"):
    return Scheme(numbers[0], numbers[1], gg, dt, start)


def ground(*strata, motion="pressure", impedance=None):
    """Strata by thickness, density and modulus of pressure, or twice that of shear."""
    return Ground(tuple(Stratum(*numbers, 0.0) for numbers in strata), motion, impedance=impedance)


def still(steps, **parts):
    rest = dict.fromkeys(("displacement", "velocity", "acceleration", "pressure"), np.zeros(steps + 1))
    return Excitation(**(rest | parts))


def random_column(seed):
    """A column of four strata with contacts between them, its drive, and a step."""
    random = np.random.default_rng(seed)
    strata = [(*random.uniform((0.5, 1500.0), (2.0, 3000.0)), 10 ** random.uniform(8, 9.5)) for _ in range(4)]
    tops = np.cumsum([0.0, *(one[0] for one in strata)])
    sheared = bool(seed % 2)
    impedance = 2e6 if seed % 3 == 2 else None
    heights = tops[1 if impedance else 0 : 4]
    stiff = [math.inf if random.random() < 0.2 else 10 ** random.uniform(8.5, 10) for _ in heights]
    numbers = [(0.0, 10 ** random.uniform(4, 5.5)) if sheared else (random.choice([0.0, 1e-3]),) for _ in heights]
    law = [ColumnContact(float(x), k, *more) for x, k, more in zip(heights, stiff, numbers, strict=True)]
    motion = "shear" if sheared else "pressure"
    velocities = tuple(random.normal(size=4))
    kind = "frictional" if sheared else "unilateral"
    weight = 0.0 if sheared else 9.81
    column = ContactColumn(ground(*strata, motion=motion, impedance=impedance), kind, tuple(law), velocities, weight)
    dt = 10 ** random.uniform(-4.5, -3)
    t = dt * np.arange(101)
    w = 0.2 / dt
    shaking = {"displacement": 1e-3 * np.sin(w * t), "velocity": 1e-3 * w * np.cos(w * t)}
    shaking["acceleration"] = -w * w * shaking["displacement"]
    return column, still(100, **shaking, pressure=1e5 * np.cos(3 * w * t)), dt


RANDOM = range(18)


def stepper_and_start(column, elements, degree, how, drive):
    model = model_of(column, [elements] * len(column.ground.strata), degree)
    system = system_of(column, model, how, drive, observed_by(model, (), ()))
    stepper = stepper_of(column, system, how)
    return stepper, column_at_start(stepper, column, model)


@pytest.mark.parametrize("seed", thinned(RANDOM, 11))
def test_forces_bounds_and_momentum_balance_in_every_step(seed):
    column, drive, dt = random_column(seed)
    how = scheme(AVERAGE if seed % 4 < 2 else CONSTANT, dt, 0.99)
    stepper, before = stepper_and_start(column, 2, 1 + seed % 2, how, drive)
    system, rows = stepper.system, stepper.system.rows
    ones = np.ones(len(system.F))
    frictional = column.law == "frictional"
    gaps = np.zeros(len(column.contacts)) if frictional else np.array([one.gap for one in column.contacts])
    for step in range(1, 51):
        marched = stepper.march(before, stepper.record(1))
        assert marched.outcome == CONVERGED
        state = marched.state
        # of the sum over all runs the contacts between them drop out
        load = system.F + system.pushes @ drive.parts[step]
        drag = np.zeros_like(load) if system.C is None else system.C @ state.V
        force = load + system.B.T @ state.force - drag - system.K @ state.D
        size = np.abs(state.force).max() + np.abs(load).max() + np.abs(drag).max()
        assert ones @ (system.M @ state.A) == pytest.approx(ones @ force, abs=1e-9 * size)
        size = np.abs(state.force).max() + 1.0
        assert np.all(state.force >= rows.lower - 1e-9 * size)
        assert np.all(state.force <= rows.upper + 1e-9 * size)
        slip = state.slid - before.slid if frictional else state.place
        assert np.all(slip[(state.states == AT_LOWER)] >= 0) and np.all(slip[state.states == AT_UPPER] <= 0)
        if frictional:
            assert np.all(slip[state.states == INSIDE] == 0)
        # the springs carry what their length says, and what is rigid has none
        apart = system.B @ state.D - system.ground @ drive.parts[step] + gaps
        length = apart - state.slid
        closed = length if frictional else np.minimum(length, 0.0)
        assert closed == pytest.approx(-state.force * rows.compliance, abs=1e-9 * np.abs(length).max())
        before = state


@pytest.mark.parametrize(("seed", "welded"), thinned([(1, False), (4, True), (0, False)], 3))  # opens, slips, opens
def test_natural_modes_are_the_same_column(seed, welded, monkeypatch):
    column, drive, dt = random_column(seed)
    column = replace(column, contacts=column.contacts[1:]) if welded else column
    names = ["displacement", "contact_pressure", "stress_1", "velocity_1", "force_2"]
    arguments = (column, [2] * 4, 1, scheme(CONSTANT, dt, 0.99), drive, names, [0.7, column.contacts[-1].height])
    plain = solve_contacts(*arguments)
    monkeypatch.setattr(compilation, "LONG", 1)
    monkeypatch.setattr(compilation, "compiled", lambda: (None, "plain"))
    modal = solve_contacts(*arguments)
    assert plain.solves > 0 == modal.solves and len(modal.time) == len(plain.time) == 100
    assert np.count_nonzero(np.diff(plain.states)) > 0
    for name in names:
        # force and stress are differences of displacements that have the rounding of the highest mode
        size = np.abs(plain.columns[name]).max()
        assert modal.columns[name] == pytest.approx(plain.columns[name], abs=1e-8 * size), name


@pytest.mark.parametrize(
    ("law", "speed", "force"),
    [
        ("frictional", 0.3, -2e4),
        ("frictional", -0.3, 2e4),
        ("frictional", 0.0, 0.0),
        ("unilateral", 0.3, 0.0),
        ("unilateral", 0.0, 8.665511265164639),  # of 1e4 Pa on the top, through the mesh's own inertia
    ],
)
def test_a_rigid_contact_that_moves_at_the_start_bears_what_its_slip_or_gap_says(law, speed, force):
    """Its strength against the slip, nothing where its faces part: not what would keep accelerations together."""
    joint = ColumnContact(1.0, math.inf, *((0.0, 2e4) if law == "frictional" else ()))
    strata = ground((1.0, 2000.0, 1e8), (1.0, 2000.0, 1e8), motion="shear" if law == "frictional" else "pressure")
    column = ContactColumn(strata, law, (joint,), (0.0, speed), unsupported=True)
    pressed = still(1, pressure=np.full(2, 1e4)) if law == "unilateral" else still(1)
    _, state = stepper_and_start(column, 4, 2, scheme(AVERAGE, 1e-4), pressed)
    assert state.force[0] == pytest.approx(force, abs=1e-9)


@pytest.mark.parametrize("modal", [False, True])
def test_a_settled_column_carries_its_weight_and_stays(modal, monkeypatch):
    """On a base that has moved, over gaps: what the springs and each stratum give way under what is above."""
    if modal:
        monkeypatch.setattr(compilation, "LONG", 1)
        monkeypatch.setattr(compilation, "compiled", lambda: (None, "plain"))
    strata = ground((1.0, 2000.0, 1e8), (0.7, 2500.0, 3e8))
    joints = ColumnContact(0.0, 2e9, 1e-3), ColumnContact(1.0, 1e9, 3e-4)
    column = ContactColumn(strata, "unilateral", joints, (0.0, 0.0), 9.81, settled=True)
    upper = 2500 * 0.7 * 9.81
    whole = upper + 2000 * 9.81
    top = 4e-3 - 1e-3 - whole / 2e9 - (upper + 2000 * 9.81 / 2) / 1e8 - 3e-4 - upper / 1e9 - upper * 0.7 / 2 / 3e8
    names = ("displacement", "force_1", "force_2")
    drive = still(9, displacement=np.full(10, 4e-3))
    found = solve_contacts(column, [2, 3], 2, scheme(AVERAGE, 1e-4), drive, names, (0.0, 1.0))
    for name, value in zip(names, (top, whole, upper), strict=True):
        assert found.columns[name] == pytest.approx(np.full(9, value), rel=1e-10), name
