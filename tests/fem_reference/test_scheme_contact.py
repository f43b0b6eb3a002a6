"""Schemes of stages on a base that opens: printed rebounds and the exact motion."""

import functools

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

from fem_reference import named_scheme, solve_unilateral
from fem_reference.events.block_events import solve as exact_motion
from fem_reference.events.block_model import BlockProblem

HHT_TENTH = 0.9 / 1.1
STORED = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOST = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")
START_ENERGY = 5e4  # J: the unit of the printed energies


def unlocked(name, options, step, steps, p=1e9):
    """The block of one strain, one linear element, that lifts off under its pressure."""
    scheme = named_scheme(name, step=step, **options)
    return solve_unilateral(make(p=p, elements=1, degree=1), scheme, steps).columns


@functools.cache
def exact():
    """Exact motion of the unlocked block."""
    return exact_motion(BlockProblem(2.0, 2.0, 2700.0, 1e9, 1e9, 5e6), 0.06)


@pytest.mark.parametrize(
    ("name", "options", "peak", "energy", "error"),
    thinned(
        [
            ("chung-hulbert", {"rho_inf": 0.8}, 13.01, -0.1041, 0.0824),
            ("chung-hulbert", {"rho_inf": 0.0}, 10.71, -0.9922, 0.1305),
            ("hht", {"rho_inf": HHT_TENTH}, 12.59, -0.3690, 0.0786),
            ("wbz", {"rho_inf": 0.5}, 11.43, -0.5935, 0.0859),
            ("composite", {}, 12.94, -0.2271, 0.0671),
            ("composite", {"rho_inf": 0.5}, 12.99, -0.1270, 0.0519),
            ("leapfrog", {}, 13.46, -0.1242, 0.1200),
        ],
        7,
    ),
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
