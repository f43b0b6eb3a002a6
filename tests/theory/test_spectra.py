"""Closed forms of block, bar and elements against eigenvalues and stepped modes of their own."""

import math

import numpy as np
import pytest
from oracles.staged import amplification, two_unknowns
from scipy.linalg import eigh

from validation.theory import spectra as expected
from validation.theory import statics

OBLONG = {"block.width": 0.7, "block.height": 3.1, "contact.stiffness": 4e8, "block.young": 6e8}


@pytest.fixture
def oblong(scene):
    return scene.with_values(OBLONG)


def test_what_damping_has_left_at_the_last_step(oblong):
    case = oblong.with_values({"time.steps": 7, "time.gg": 0.9})
    steps = [amplification(0.5, 1.0, 0.9, (w * case.time.step) ** 2) for w in two_unknowns(case.block, 4e8)]
    assert expected.remaining_motion(case) == pytest.approx(np.max(np.abs(np.linalg.eigvals(steps))) ** 7, rel=1e-10)


def test_modes_and_shares_of_the_bar(oblong):
    w, h = statics.size(oblong)
    b = expected.bar_modes(oblong, 4000)
    ratio = 2 * 4e8 * h / (6e8 * w)
    assert np.abs(b[:50] * np.tan(b[:50]) / ratio - 1).max() <= 1e-11
    assert np.all((b > np.pi * np.arange(4000)) & (b < np.pi * (np.arange(4000) + 0.5)))
    # static values: the displacement's shares fall as 1 / b^2, the pressure's alternate as 1 / b
    assert expected.bar_shares(oblong, "displacement", b).sum() == pytest.approx(1.0, abs=1e-4)
    pressure = np.cumsum(expected.bar_shares(oblong, "contact_pressure", b))
    assert (pressure[-1] + pressure[-2]) / 2 == pytest.approx(1.0, abs=1e-4)


ELEMENTS = {  # mass and stiffness of one of unit length
    1: (np.array([[2, 1], [1, 2]]) / 6, np.array([[1, -1], [-1, 1]])),
    2: (
        np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) / 30,
        np.array([[7, -8, 1], [-8, 16, -8], [1, -8, 7]]) / 3,
    ),
}


def modes_of_elements(degree, n):
    """Return the frequencies of n elements of the oblong bar on its spring, in units of the bar."""
    mass, stiff = ELEMENTS[degree]
    M, K = np.zeros((2, degree * n + 1, degree * n + 1))
    for i in range(n):
        part = slice(degree * i, degree * i + degree + 1)
        M[part, part] += mass / n
        K[part, part] += stiff * n
    K[0, 0] += 2 * 4e8 * 3.1 / (6e8 * 0.7)
    return np.sqrt(eigh(K, M, eigvals_only=True))


@pytest.mark.parametrize(("degree", "per_side"), [(1, 12), (2, 5)])
def test_a_mesh_is_too_stiff_by_its_leading_term(oblong, degree, per_side):
    """Against the lowest eigenvalue of elements of consistent mass on the spring, in units of the bar."""
    case = oblong.with_values({"fem.elements": per_side, "fem.degree": degree})
    exact = float(expected.bar_modes(oblong, 1)[0])
    lowest = modes_of_elements(degree, case.fem.per_side)[0]
    assert expected.mesh_frequency_error(case) == pytest.approx(lowest / exact - 1, rel=0.02)


def test_a_front_has_elements_and_histories_of_two_programs_a_rounding(oblong):
    case = oblong.with_values({"fem.elements": 7, "time.step": 3e-4, "time.steps": 90})
    speed = math.sqrt(6e8 / case.block.density)
    assert expected.elements_per_front(case) == pytest.approx(speed * 3e-4 / (3.1 / case.fem.per_side), rel=1e-12)
    assert expected.transit(case) == pytest.approx(3.1 / speed, rel=1e-12)
    squares = two_unknowns(case.block, 4e8)[0] ** 2 * 3e-4**2
    assert expected.rounding(case) == pytest.approx(10 * np.finfo(float).eps * 90 * (1 + 8 / 6) / squares, rel=1e-9)
