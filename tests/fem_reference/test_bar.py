"""The exact bar against routes that know nothing of its modes."""

import subprocess
import sys
from itertools import product

import numpy as np
import pytest
from conftest import thinned
from oracles.bars import OTHER, PAPER
from oracles.bars import damped as damped_bar

from fem_reference.exact import continuum
from fem_reference.exact.bar import Bar, applicable
from fem_reference.exact.bar_modes import cut_off, shares, wave_numbers
from fem_reference.problem.problem import Problem, Scheme
from fem_reference.scheme.modal import applicable as scheme_applicable
from fem_reference.scheme.modal import weighted_response

SOFT = Bar(0.8, 2.6, 3100.0, 2.5e10, 9e7, 1.2e6)


def newmark_by_transform(bar, scheme, steps):
    """Displacement and pressure from the bar's closed form at complex frequencies.

    With z one step's delay the scheme turns sigma^2 D + L D = G f into an ordinary differential equation
    along the bar; its solution is inverted by the trapezoidal rule on a circle.
    """
    count = 16 * steps
    radius = 10.0 ** (-1.0 / steps)  # rounding grows tenfold, aliasing falls by sixteen digits
    z = radius * np.exp(2j * np.pi * np.arange(count) / count)
    a, d, gg = scheme.alpha, scheme.delta, scheme.gg
    start = 1.0 if scheme.start == "consistent" else 0.0
    P = (gg * z * ((1 - d) * z + d) / (1 - gg * z) + (0.5 - a) * z + a) / (1 - z)
    Q = (gg * z * d / (1 - gg * z) + a) / (1 - z)
    G = start + z / (1 - z) - Q * start / P
    wave = np.sqrt(bar.young / bar.density)
    gamma = bar.height / wave / (scheme.step * np.sqrt(P))
    kappa = bar.base_stiffness * bar.height / (bar.young * bar.width)
    # Over exp(gamma), which overflows for small steps.
    gamma = np.where(gamma.real < 0, -gamma, gamma)
    e, root = np.exp(-gamma), np.exp(-gamma / 2)
    below = gamma * (1 - e * e) / 2 + kappa * (1 + e * e) / 2
    middle = (root + e * root) / 2 + kappa / gamma * (root - e * root) / 2
    unit = -bar.pressure * bar.height / bar.young * G / below
    base = unit * e
    sequences = (unit * middle, -bar.base_stiffness / bar.width * base)
    powers = radius ** np.arange(count)
    return [(np.fft.fft(s).real / count / powers)[1 : steps + 1] for s in sequences]


@pytest.mark.parametrize("bar", [PAPER, OTHER, SOFT])
@pytest.mark.parametrize(
    "scheme",
    [
        Scheme(0.5, 1.0, 1.0, 1e-3),
        Scheme(0.5, 1.0, 0.9, 1e-2),
        Scheme(0.25, 0.5, 1.0, 7e-4, "consistent"),
        Scheme(0.25, 0.5, 0.95, 2e-5),
        Scheme(0.5625, 1.0, 1.0, 3e-4, "consistent"),
        Scheme(0.3025, 0.6, 0.98, 2e-3),
        Scheme(0.5, 1.0, 0.0, 1e-3),
    ],
)
def test_history_against_the_transform(bar, scheme):
    result = bar.solve(scheme, 150)
    for (name, column), expected in zip(result.columns.items(), newmark_by_transform(bar, scheme, 150), strict=True):
        # Before the wave has arrived there is only rounding of the static value to compare with.
        scale = max(np.abs(expected).max(), 1e-3 * min(1.0, bar.kappa) * abs(bar.static()[name]))
        assert np.abs(column - expected).max() <= 1e-9 * scale
    assert result.estimate <= 1e-10


@pytest.mark.parametrize("kappa", [1e-9, 1e-3, 0.7, 2.0, 40.0, 1e6, 1e15])
def test_wave_numbers_to_the_last_digits(kappa):
    mp = pytest.importorskip("mpmath").mp
    with mp.workdps(40):
        for n, b in enumerate(wave_numbers(kappa, 6)):
            low, high = mp.pi * n, mp.pi * n + mp.pi / 2
            root = mp.findroot(
                lambda x: x * mp.sin(x) - mp.mpf(kappa) * mp.cos(x),
                (max(low, mp.mpf(10) ** -12), high),
                solver="anderson",
            )
            assert abs(b - root) <= 5e-16 * root
            # The base's amplitude cos b is what enters the pressure.
            share = 2 * kappa * mp.cos(root) / (root**2 * (1 + mp.sin(2 * root) / (2 * root)))
            assert shares("contact_pressure", wave_numbers(kappa, 6), kappa)[n] == pytest.approx(
                float(share), rel=1e-14
            )


def test_mode_roots():
    scheme = Scheme(0.5, 1.0, 0.97, 4e-3)
    for mode in OTHER.modes(scheme, 4):
        h = (mode.frequency * scheme.step) ** 2
        h /= 1 + h / 2
        assert mode.eigenvalues.sum() == pytest.approx(1 - h / 2 + 0.97 * (1 - h), abs=1e-14)
        assert mode.eigenvalues[:2].prod() == pytest.approx(0.97 * (1 - h / 2), abs=1e-14)


def continuum_by_modes(bar, scheme, steps):
    """Mode sum, smoothly cut off: right away from the fronts."""
    b = wave_numbers(bar.kappa, 6000)
    t = scheme.step * np.arange(1, steps + 1)
    a = -np.log(scheme.gg) / scheme.step / 2
    w = np.sqrt(((b / bar.travel) ** 2 - a * a).astype(complex))
    phase = np.outer(w, t)
    x = (np.exp(-a * t) * (np.cos(phase) + a / w[:, None] * np.sin(phase))).real
    weights = [shares(name, b, bar.kappa) * cut_off(6000, 6000) for name in ("displacement", "contact_pressure")]
    return [bar.static()[n] * (1 - w @ x) for n, w in zip(("displacement", "contact_pressure"), weights, strict=True)]


@pytest.mark.parametrize("bar", [PAPER, OTHER, SOFT])
@pytest.mark.parametrize("gg", [1.0, 0.9])
def test_continuum_waves_against_modes(bar, gg):
    scheme = Scheme(0.25, 0.5, gg, 1.37e-3)
    result = bar.continuum(scheme, 60)
    travels = result.time / bar.travel
    away = np.abs(travels[:, None] - np.arange(1, 400) / 2).min(axis=1) > 0.02
    assert away.sum() > 30
    for column, expected in zip(result.columns.values(), continuum_by_modes(bar, scheme, 60), strict=True):
        assert np.abs(column - expected)[away].max() <= 1e-11 * np.abs(expected).max()


def test_continuum_waits_for_the_wave():
    early = PAPER.continuum(Scheme(0.5, 1.0, 1.0, PAPER.travel / 100), 99)
    assert np.all(early.columns["contact_pressure"] == 0)
    assert np.all(early.columns["displacement"][:49] == 0) and early.columns["displacement"][60] < 0


@pytest.mark.parametrize("gap", [0.0, 1e-9, 1e-5, 3e-3])
def test_nearly_equal_roots(gap):
    # (1/2, 1) has equal roots at Omega = 4; the recursion with trace and determinant is stable there.
    scheme = Scheme(0.5, 1.0, 1.0, 1.0)
    omega = np.array([1.0, 4.0 + gap, 4.0 - gap])
    weights = np.eye(3)
    found = weighted_response(omega, weights, scheme, 30)
    for w, row in zip(omega, found, strict=True):
        h = w * w / (1 + w * w / 2)
        x = [1 - h / 2, (1 - h / 2) ** 2 - h * (1 - h / 2)]
        for _ in range(28):
            x.append((2 - 1.5 * h) * x[-1] - (1 - h / 2) * x[-2])
        assert np.abs(row - (1 - np.array(x))).max() <= 1e-13


@pytest.mark.parametrize(
    "scheme", [Scheme(0.0, 0.5, 1.0, 1e-3), Scheme(1 / 6, 0.5, 1.0, 1e-3), Scheme(0.5, 0.4, 1.0, 1e-3)]
)
def test_unstable_schemes_are_refused(scheme):
    assert scheme_applicable(scheme) is not None
    with pytest.raises(ValueError, match="stable for every frequency"):
        PAPER.solve(scheme, 10)


def test_continuum_without_rate_is_refused():
    with pytest.raises(ValueError, match=r"^gg: "):
        PAPER.continuum(Scheme(0.5, 1.0, 0.0, 1e-3), 10)
    with pytest.raises(ValueError, match=r"^steps: "):
        PAPER.continuum(Scheme(0.5, 1.0, 1.0, 1.0), 10)


def test_where_the_bar_is_exact():
    square = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
    data = (2700.0, 1e9, 0.0, "plane stress", 1e9, 1e9, 5e6)
    assert applicable(Problem(square, 0, 2, *data)) is None
    assert Bar.of(Problem(square, 0, 2, *data)) == PAPER
    assert "Poisson" in applicable(Problem(square, 0, 2, 2700.0, 1e9, 0.1, *data[3:]))
    assert "foundation" in applicable(Problem(square, 0, 2, *data, foundation="corner"))
    assert "rectangle" in applicable(Problem(square, 0, 1, *data))
    with pytest.raises(ValueError, match=r"^young: "):
        Bar(2.0, 2.0, 2700.0, -1e9, 2e9, 5e6)


@pytest.mark.long
def test_bar_does_not_load_the_finite_elements():
    code = "import sys, fem_reference.exact.bar; sys.exit('skfem' in sys.modules or 'meshio' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_mode_that_stops_at_once_has_no_power():
    """At gg = 0 and Omega to infinity both roots of constant acceleration are zero: static from the third step on."""
    bar = Bar(height=1.3, width=0.7, density=2100.0, young=4e7, base_stiffness=3e8, pressure=2e5)
    result = bar.solve(Scheme(0.5, 1.0, 0.0, 1e9), 7)
    for name, values in result.columns.items():
        assert np.all(np.isfinite(values)) and values[2:] == pytest.approx(bar.static()[name], rel=1e-13)
    assert np.isfinite(result.estimate)


DAMPED = product([2.0, 1e3, 1e9], [0.003, 1.0, 7.0, 60.0], [0.25, 0.250001, 0.2371])


@pytest.mark.parametrize(("kappa", "a", "step"), thinned(DAMPED, 7))
def test_damped_bar_against_its_transform(kappa, a, step):
    # On the fronts, right behind them and away from them; 2e-11 is the tail beyond the modes at a stiff spring.
    columns = ("displacement", "contact_pressure")
    found = continuum.histories(step * np.arange(1, 21), kappa, 2 * a, columns)
    for column, row in zip(columns, found, strict=True):
        for i in (5, 11, 18):
            assert row[i] == pytest.approx(damped_bar(column, step * (i + 1), kappa, a), abs=2e-11)


def test_late_damped_fronts_are_refused():
    with pytest.raises(ValueError, match=r"^steps: "):
        PAPER.continuum(Scheme(0.5, 1.0, 1 - 1e-6, PAPER.travel / 2), 20000)


def test_waves_beyond_the_range_of_the_exponential():
    # exp(-x / 2) is zero in doubles for the first of these waves, and the series still oscillates about one.
    mp = pytest.importorskip("mpmath").mp
    x, j = 1800.0, 500
    waves = continuum._Laguerre(np.full(j + 2, x))
    for _ in range(j):
        waves.advance()
    with mp.workdps(60):
        first, second = (mp.exp(-x / 2) * mp.laguerre(n, 0, x) for n in (j, j + 1))
        assert waves.advance()[0] == pytest.approx(float(first - second), abs=1e-12)
