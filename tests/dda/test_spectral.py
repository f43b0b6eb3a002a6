"""Closed forms of the scheme against the published numbers and the step."""

from itertools import product

import numpy as np
import pytest
from conftest import thinned

from dda import Block, Contact, Material, Scheme, TwoBlockModel, modes
from dda.scheme import spectral

CONSTANT, AVERAGE = (0.5, 1.0), (0.25, 0.5)
SCHEMES = [CONSTANT, AVERAGE, (0.5625, 1.0), (0.3025, 0.6), (1 / 6, 0.5), (0.0, 0.5), (0.4, 0.3)]


def square(ratio=1.0, mu=0.0):
    return TwoBlockModel(Block.rectangle(2.0, 2.0, Material(2700.0, 1e9, mu)), Contact(ratio * 1e9), 5e6)


@pytest.mark.parametrize(("alpha", "delta", "gg"), [(0.0, 0.5, 0.9), (0.1, 0.8, 0.6), (0.1, 0.4, 0.9), (0.2, 0.9, 0.0)])
def test_the_critical_omega_is_where_growth_begins(alpha, delta, gg):
    limit = spectral.critical_omega(alpha, delta, gg)
    assert spectral.spectral_radius(limit * (1 - 1e-6), alpha, delta, gg) < 1
    assert spectral.spectral_radius(limit * (1 + 1e-6), alpha, delta, gg) > 1


BLOCKS = [(1.0, 0.0), (30.0, 0.3), (100.0, -0.4)]  # p / E, Poisson's ratio


@pytest.mark.parametrize(
    ("weights", "gg", "shape", "step"), thinned(product(SCHEMES, [1.0, 0.93], BLOCKS, [1.7e-4, 2.3e-3]), 11)
)
def test_formulas_are_the_steps_of_the_modes(weights, gg, shape, step):
    alpha, delta = weights
    ratio, mu = shape
    model, scheme = square(ratio, mu), Scheme(alpha, delta, gg, step)
    reached = modes(model, scheme)
    omega = np.array([mode.frequency for mode in reached]) * step
    formula = spectral.eigenvalues(omega, alpha, delta, gg)
    own = np.array([mode.eigenvalues for mode in reached])
    size = max(1.0, np.abs(formula).max())
    np.testing.assert_allclose(own.sum(axis=1), formula.sum(axis=1), rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(own.prod(axis=1), formula.prod(axis=1), rtol=0, atol=1e-12 * size**2)
