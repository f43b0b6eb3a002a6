"""Schemes of stages on a locked base: roots, hidden damping, orders and responses against closed forms."""

import math
from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

from fem_reference import Bar, named_scheme
from fem_reference.exact.vibration import response as bar_response
from fem_reference.history import response as spaces
from fem_reference.history.response import response
from fem_reference.scheme import modal
from fem_reference.scheme.eigen import eigenvalues

HHT = {0.1: 0.9 / 1.1, 0.3: 0.7 / 1.3}  # rho_inf of alpha = -0.1 and -0.3
IMPLICIT = [
    ("chung-hulbert", {"rho_inf": 0.8}),
    ("chung-hulbert", {"rho_inf": 0.37}),
    ("chung-hulbert", {"rho_inf": 0.0}),
    ("hht", {"rho_inf": HHT[0.1]}),
    ("wbz", {"rho_inf": 0.5}),
    ("composite", {"split": 0.5}),
    ("composite", {}),
    ("composite", {"rho_inf": 0.5}),
    ("composite", {"rho_inf": 0.3, "split": 0.7}),
]


def generalised_alpha(name, rho):
    """Return am, af, beta and gamma in the words of the papers."""
    am, af = {
        "chung-hulbert": ((2 * rho - 1) / (rho + 1), rho / (rho + 1)),
        "hht": (0.0, (1 - rho) / (1 + rho)),
        "wbz": ((rho - 1) / (rho + 1), 0.0),
    }[name]
    return am, af, (1 - am + af) ** 2 / 4, 0.5 - am + af


def amplification(rho, split, omega):
    """Return R(i W) of the composite scheme as a Runge-Kutta method."""
    z = 1j * omega
    q1 = (rho + 1) / (2 * split * (rho - 1) + 4)
    q0 = (split - 1) * q1 + 0.5
    q2 = 0.5 - split * q1
    middle = (1 + split * z / 2) / (1 - split * z / 2)
    return (1 + q0 * z + q1 * z * middle) / (1 - q2 * z)


def characteristic(name, options, omega, gg):
    """Coefficients of the characteristic polynomial of one mode, highest power first, by closed forms."""
    square = omega**2
    if name == "leapfrog":
        return np.array([1.0, -(1 + gg - square), gg])
    if name == "composite":
        rho = options.get("rho_inf", 0.0)
        split = options.get("split", (2 - math.sqrt(2 + 2 * rho)) / (1 - rho) if rho < 1 else 0.5)
        R = amplification(rho, split, omega)
        return np.array([1.0, -(1 + gg) * R.real, gg * abs(R) ** 2])
    am, af, beta, gamma = generalised_alpha(name, options["rho_inf"])
    free = np.polymul(np.polymul([1, -1], [1, -gg]), [1 - am, am])
    moved = np.polyadd(gg * np.array([gamma, 1 - gamma]), np.polymul([beta, 0.5 - beta], [1, -gg]))
    return np.polyadd(free, square * np.polymul([1 - af, af], moved))


def damping_ratio(root):
    log = np.log(root)
    return -log.real / abs(log)


@pytest.mark.parametrize(("case", "gg"), thinned(product(IMPLICIT, [1.0, 0.93]), 5))
def test_the_roots_of_a_mode_are_those_of_the_closed_forms(case, gg):
    name, options = case
    scheme = named_scheme(name, step=1e-3, gg=gg, **options)
    for omega in (1e-3, 0.34456, 2.63, 17.3):
        closed = np.roots(characteristic(name, options, omega, gg))
        for roots in (modal.roots(omega, scheme), eigenvalues(omega / scheme.step, scheme)):
            distances = np.min(np.abs(closed[:, None] - roots), axis=1)
            assert np.max(distances) < (1e-8 if omega == 1e-3 else 1e-11)
            assert roots[0].imag != 0 or (gg < 1 and omega == 1e-3)  # a slow mode that gg overdamps
    # of the slowest mode, whose roots nearly meet, the closed forms say more than their numbers
    if gg == 1 and name != "composite":
        am, af, _, _ = generalised_alpha(name, options["rho_inf"])
        leading = (af - am) * (1 - am - af) ** 2 * 1e-6 / 8
        assert damping_ratio(modal.roots(1e-2, scheme)[0]) == pytest.approx(leading, rel=1e-3)


@pytest.mark.parametrize(("name", "options"), thinned(IMPLICIT, 4))
def test_the_response_of_the_bar_is_that_of_a_fine_mesh(name, options):
    scheme = named_scheme(name, step=1e-3, gg=0.97, **options)
    frequencies = np.array([0.0, 13.0, 60.0])
    exact = bar_response(Bar.of(make()), scheme, frequencies)
    mesh = response(make(elements=48), scheme, frequencies)
    for column, amplitudes in exact.items():
        np.testing.assert_allclose(amplitudes, mesh[column], rtol=1e-7)
    assert exact["contact_pressure"][0] == pytest.approx(5e6, rel=1e-9)


def test_a_frequency_that_no_small_space_holds_is_eliminated(monkeypatch):
    arguments = make(poisson=0.2, elements=4), named_scheme("chung-hulbert", step=1e-3, rho_inf=0.6), np.array([13.0])
    eliminated = spaces.response(*arguments)
    monkeypatch.setattr(spaces, "NARROW", 0)
    monkeypatch.setattr(spaces, "LARGEST", 3)
    for column, amplitudes in spaces.response(*arguments).items():
        np.testing.assert_allclose(amplitudes, eliminated[column], rtol=1e-10)


def test_stability_limits():
    for gg in (1.0, 0.9, 0.3, 0.0):
        limit = math.sqrt(2 * (1 + gg))
        below, above = modal.radii(limit * np.array([0.999, 1.001]), named_scheme("leapfrog", step=1.0, gg=gg))
        assert below <= 1 + 1e-12 < above
    for name, options in IMPLICIT:
        for gg in (1.0, 0.9):
            assert modal.applicable(named_scheme(name, step=1.0, gg=gg, **options)) is None
