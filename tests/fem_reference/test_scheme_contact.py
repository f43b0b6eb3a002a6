"""Schemes of stages on a base that opens: against exact motion, printed rebounds and each other."""

import functools

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

from fem_reference import (
    UNILATERAL_COLUMNS,
    Friction,
    Unilateral,
    named_scheme,
    solve_unilateral,
)
from fem_reference.contact.columns import columns_of
from fem_reference.contact.points import build
from fem_reference.contact.stepper import ContactStepper
from fem_reference.events.block_events import solve as exact_motion
from fem_reference.events.block_model import BlockProblem
from fem_reference.exact.opening_bar import OpeningBar
from fem_reference.history.unilateral import block_at_start

HHT_TENTH = 0.9 / 1.1
IMPLICIT = [
    ("chung-hulbert", {"rho_inf": 0.8}),
    ("chung-hulbert", {"rho_inf": 0.5}),
    ("chung-hulbert", {"rho_inf": 0.0}),
    ("hht", {"rho_inf": HHT_TENTH}),
    ("wbz", {"rho_inf": 0.5}),
    ("composite", {"split": 0.5}),
    ("composite", {}),
    ("composite", {"rho_inf": 0.5}),
]
EVERY = [*IMPLICIT, ("leapfrog", {})]
STORED = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOST = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")
START_ENERGY = 5e4  # J: the unit of the printed energies


def unlocked(name, options, step, steps, p=1e9, gg=1.0, columns=UNILATERAL_COLUMNS):
    """The block of one strain, one linear element, that lifts off under its pressure."""
    scheme = named_scheme(name, step=step, gg=gg, **options)
    return solve_unilateral(make(p=p, elements=1, degree=1), scheme, steps, columns=columns).columns


@functools.cache
def exact():
    """Exact motion of the unlocked block."""
    return exact_motion(BlockProblem(2.0, 2.0, 2700.0, 1e9, 1e9, 5e6), 0.06)


@pytest.mark.parametrize(
    ("name", "options", "peak", "energy", "error"),
    [
        ("chung-hulbert", {"rho_inf": 0.8}, 13.01, -0.1041, 0.0824),
        ("chung-hulbert", {"rho_inf": 0.5}, 12.38, -0.4380, 0.0783),
        ("chung-hulbert", {"rho_inf": 0.0}, 10.71, -0.9922, 0.1305),
        ("hht", {"rho_inf": HHT_TENTH}, 12.59, -0.3690, 0.0786),
        ("wbz", {"rho_inf": 0.5}, 11.43, -0.5935, 0.0859),
        ("composite", {"split": 0.5}, 12.98, -0.2141, 0.0679),
        ("composite", {}, 12.94, -0.2271, 0.0671),
        ("composite", {"rho_inf": 0.5}, 12.99, -0.1270, 0.0519),
        ("leapfrog", {}, 13.46, -0.1242, 0.1200),
    ],
)
def test_the_unlocked_block_at_one_millisecond(name, options, peak, energy, error):
    """Peak pressure [MPa], energy at 0.1 s and error of v over 0.05 s, which another program gave."""
    columns = unlocked(name, options, 1e-3, 100)
    assert columns["contact_pressure"].max() / 1e6 == pytest.approx(peak, abs=0.006)
    stored = sum(columns[column] for column in STORED)
    assert stored[-1] / START_ENERGY == pytest.approx(energy, abs=6e-5)
    v = exact().at(1e-3 * np.arange(1, 51)).displacement[1]
    assert np.linalg.norm(columns["displacement"][:50] - v) / np.linalg.norm(v) == pytest.approx(error, abs=6e-5)
    # the energies that are kept and lost are those at the start
    assert np.abs(stored + sum(columns[column] for column in LOST)).max() < 1e-10 * START_ENERGY
    solves = columns["solves"]
    assert solves.min() == (2 if name == "composite" else 1)


def test_the_opening_bar_takes_one_stage():
    with pytest.raises(ValueError, match=r"^scheme: must have one stage, .*'composite' has 2"):
        OpeningBar.of(make()).solve(named_scheme("composite", step=1e-3), 3)


@pytest.mark.parametrize(("name", "options"), thinned(EVERY, 3))
def test_a_motion_does_not_depend_on_how_it_is_stepped(name, options):
    """One column of elements and the whole block, plain and in natural modes; energies balance with friction."""
    explicit = name == "leapfrog"
    scheme = named_scheme(name, step=2e-5 if explicit else 5e-4, gg=0.99, **options)
    problem = make(elements=3, degree=1, traction=1e6, gravity=9.81, poisson=0.3)
    contact = Unilateral(shear="glued", friction=Friction(20.0, 1e4))
    stepper_columns = UNILATERAL_COLUMNS
    tables = []
    for modal in (False, True):
        model = build(problem)
        system = model.system("glued", contact.friction)
        stepper = ContactStepper(system.in_modes() if modal else system, scheme, energies=True, losses=True)
        record = stepper.record(60)
        marched = stepper.march(block_at_start(stepper, model, contact), record)
        assert marched.steps == 60
        columns = columns_of(record, model, system.rows)
        tables.append(np.array([columns[name] for name in stepper_columns]).T)
    sizes = np.abs(tables[0]).max(axis=0) + 1e-300
    kept = [stepper_columns.index(column) for column in ("displacement", "contact_pressure", "base_shear")]
    assert (np.abs(tables[1] - tables[0]) / sizes)[:, kept].max() < 1e-7
    stored = sum(tables[0][:, stepper_columns.index(column)] for column in STORED)
    lost = sum(tables[0][:, stepper_columns.index(column)] for column in LOST)
    assert np.abs(stored + lost).max() < 1e-9 * np.abs(tables[0][:, stepper_columns.index("load_energy")]).max()


def test_a_cut_step_keeps_the_acceleration():
    """Two half steps of generalised alpha are those of half the step, from the state that the first has left."""
    problem = make(elements=2, degree=1, poisson=0.2)
    model = build(problem)
    whole = ContactStepper(model.system(), named_scheme("chung-hulbert", step=2e-4, rho_inf=0.5))
    short = ContactStepper(model.system(), named_scheme("chung-hulbert", step=1e-4, rho_inf=0.5))
    state = block_at_start(whole, model, Unilateral())
    same = block_at_start(short, model, Unilateral())
    for _ in range(2):
        state = whole.march(state, whole.record(1), 0.5).state
        same = short.march(same, short.record(1)).state
    np.testing.assert_allclose(state.A, same.A, rtol=1e-12)
    np.testing.assert_allclose(state.D, same.D, rtol=1e-12)
