"""The closed forms of waves: numbers of an independent computation, identities, limits."""

import numpy as np
import pytest

from validation.theory import waves
from validation.theory.stepping import Stepping

CONSTANT, AVERAGE = (0.5, 1.0), (0.25, 0.5)
GLUES = [(1, -2.8691e-1, 0.001071), (10, -3.0699e-2, 0.007117), (100, 1.1680e-2, 0.008762), (1e4, 1.6673e-2, 0.008967)]
JOINTS = [
    (10, 0.5, AVERAGE, 0.895981),
    (160, 0.5, AVERAGE, 0.894433),
    (10, 0.5, CONSTANT, 0.871194),
    (40, 0.1, CONSTANT, 0.893212),
]
COLUMN = waves.Column(height=0.5, density=2000.0, modulus=1.8e9)
SPEED = (1.8e9 / 2000.0) ** 0.5


def wave(blocks, courant, scheme, gg=1.0):
    """Return the stepping and w of a wave of some blocks of `COLUMN` a wavelength."""
    return Stepping(courant * 0.5 / SPEED, *scheme, gg), 2 * np.pi * SPEED / (blocks * 0.5)


@pytest.mark.parametrize("scheme", [CONSTANT, AVERAGE, (0.31, 0.83)])
@pytest.mark.parametrize("gg", [1.0, 0.9, 0.0])
def test_squared_frequency_satisfies_predictor_and_corrector(scheme, gg):
    alpha, delta, dt = *scheme, 3e-3
    stepping, w = Stepping(dt, alpha, delta, gg), np.array([0.3, 20.0, 700.0])
    A, V, z = -stepping.squared_frequency(w), stepping.velocity_factor(w), np.exp(1j * w * dt)
    assert np.allclose((z - gg) * V, dt * ((1 - delta) + delta * z) * A, rtol=1e-10)
    assert np.allclose(z - 1, gg * dt * V + dt**2 * ((0.5 - alpha) + alpha * z) * A, rtol=1e-10)


@pytest.mark.parametrize(("ratio", "speed", "left"), GLUES)
def test_waves_in_glued_blocks(ratio, speed, left):
    column = waves.Column(0.5, 2000.0, 1.8e9, glue=ratio * 1.8e9 / 0.5)
    stepping, w = wave(10, 0.5, CONSTANT)
    kept, error = column.travelled(stepping, w, 50.0)
    assert kept == pytest.approx(left, abs=6e-7)
    assert error == pytest.approx(speed, rel=6e-5)


def test_beyond_the_cut_off_the_wave_decays():
    k = COLUMN.wavenumber(np.array([1.1, 2.0, 50.0]) * 12 * SPEED**2 / 0.25)
    assert np.allclose(k.real * 0.5, np.pi)
    assert np.all(k.imag < 0)


@pytest.mark.parametrize(("blocks", "courant", "scheme", "transmitted"), JOINTS)
def test_joint_in_a_column(blocks, courant, scheme, transmitted):
    stepping, w = wave(blocks, courant, scheme)
    T, R = waves.joint_in_column(COLUMN, stepping.squared_frequency(w), 2000.0 * SPEED * w)
    assert abs(T) == pytest.approx(transmitted, abs=6e-7)
    if scheme == AVERAGE:
        assert abs(T) ** 2 + abs(R) ** 2 == pytest.approx(1, rel=1e-12)


def test_joint_in_a_continuum():
    found = waves.joint_transmission([0.25, 0.5, 1.0, 2.0])
    assert np.allclose(found, [0.4472136, 0.7071068, 0.8944272, 0.9701425], atol=5e-8)
