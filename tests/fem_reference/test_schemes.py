"""Schemes of stages on a locked base: roots, hidden damping, orders and responses against closed forms."""

import math
from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import error, make, stepped
from scipy.linalg import eigh

from fem_reference import Bar, Scheme, named_scheme, solve
from fem_reference.exact.vibration import response as bar_response
from fem_reference.history.response import response
from fem_reference.mesh.model import build
from fem_reference.scheme import modal
from fem_reference.scheme.diagnostics import diagnostics
from fem_reference.scheme.eigen import eigenvalues
from fem_reference.scheme.newmark import Stepper
from fem_reference.scheme.stage import Motion

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
EVERY = [*IMPLICIT, ("leapfrog", {})]


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


@pytest.mark.parametrize(("name", "options"), thinned(EVERY, 9))
def test_every_path_gives_the_stepped_history(name, options):
    """Without and with the savings in space and time, and the work that is counted."""
    explicit = name == "leapfrog"
    scheme = named_scheme(name, step=1e-5 if explicit else 1e-3, gg=0.99, **options)
    steps = 8
    problem = make(elements=2, poisson=0.3)
    result = solve(problem, scheme, steps)
    assert error(result.columns.values(), stepped(problem, scheme, steps)) < 1e-10
    whole = solve(problem, scheme, steps, full=True)
    assert error(result.columns.values(), list(whole.columns.values())) < 1e-9
    stages = len(scheme.stages)
    assert whole.solves == stages * steps + 1
    assert whole.factorisations == len(set(scheme.stage_matrices)) + (not explicit)


@pytest.mark.parametrize(("case", "ramp"), thinned(product(IMPLICIT, [0.0, 0.0123]), 7))
def test_the_bar_is_the_limit_of_the_mesh(case, ramp):
    name, options = case
    scheme = named_scheme(name, step=1e-3, gg=0.97, **options)
    bar = Bar.of(make(ramp=ramp)).solve(scheme, 60)
    coarse, fine = (solve(make(elements=count, ramp=ramp), scheme, 60) for count in (8, 16))
    assert error(fine.columns.values(), list(bar.columns.values())) < 2e-4
    assert error(fine.columns.values(), list(bar.columns.values())) < 0.1 * error(
        coarse.columns.values(), list(bar.columns.values())
    )


@pytest.mark.parametrize(("name", "options"), thinned(IMPLICIT, 4))
def test_the_response_of_the_bar_is_that_of_a_fine_mesh(name, options):
    scheme = named_scheme(name, step=1e-3, gg=0.97, **options)
    frequencies = np.array([0.0, 13.0, 60.0])
    exact = bar_response(Bar.of(make()), scheme, frequencies)
    mesh = response(make(elements=48), scheme, frequencies)
    for column, amplitudes in exact.items():
        np.testing.assert_allclose(amplitudes, mesh[column], rtol=1e-7)
    assert exact["contact_pressure"][0] == pytest.approx(5e6, rel=1e-9)


def test_stability_limits():
    for gg in (1.0, 0.9, 0.3, 0.0):
        limit = math.sqrt(2 * (1 + gg))
        below, above = modal.radii(limit * np.array([0.999, 1.001]), named_scheme("leapfrog", step=1.0, gg=gg))
        assert below <= 1 + 1e-12 < above
    for name, options in IMPLICIT:
        for gg in (1.0, 0.9):
            assert modal.applicable(named_scheme(name, step=1.0, gg=gg, **options)) is None


def test_diagnostics_agree_with_themselves():
    found = diagnostics(make(elements=2, poisson=0.3), named_scheme("chung-hulbert", step=1e-3, rho_inf=0.4))
    assert found.spectral_radius == pytest.approx(found.predicted_radius, abs=1e-9)
    assert found.spectral_radius < 1


@pytest.mark.parametrize(("alpha", "delta"), [(0.5, 1.0), (0.25, 0.5), (0.5625, 1.0), (0.3025, 0.6), (1 / 6, 0.5)])
def test_a_free_step_loses_the_energy_that_the_scheme_takes(alpha, delta):
    """In the energy of the scheme, V M V + D K D + c dt^2 A M A with c = alpha - delta / 2, as Hughes has it."""
    model = build(make(poisson=0.3, elements=2, degree=1), full=True)
    highest = np.sqrt(eigh(model.K.toarray(), model.M.toarray(), eigvals_only=True)[-1])
    dt = 2.0 / highest  # of the schemes here the one with alpha = 1/6 has a limit, at sqrt(12)
    c = alpha - delta / 2
    step = Stepper(model.M, model.K, np.zeros_like(model.F), Scheme(alpha, delta, 1.0, dt))

    def size(d, a):
        return d @ (model.K @ d) + c * dt**2 * a @ (model.M @ a)

    D, V = np.random.default_rng(5).normal(size=(2, len(model.F)))
    state = Motion(D, V * highest, -np.linalg.solve(model.M.toarray(), model.K @ D))
    energies = [state.V @ (model.M @ state.V) + size(state.D, state.A)]
    for _ in range(20):
        new = step.advance(state)
        energies.append(new.V @ (model.M @ new.V) + size(new.D, new.A))
        loss = (2 * delta - 1) * size(new.D - state.D, new.A - state.A)
        assert abs(energies[-1] - energies[-2] + loss) < 1e-12 * energies[0]
        state = new
