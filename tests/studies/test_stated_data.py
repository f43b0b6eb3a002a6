"""What the scenes and records of studies hold is what their pages state: gates on the motion cannot see that."""

import math

import numpy as np
import pytest

from validation.scenes.record import base_record
from validation.studies.impacts import formulas as impacts
from validation.studies.response import formulas as response
from validation.studies.rocking import formulas as rocking
from validation.studies.slopes import formulas as sliding
from validation.suite.bands import cases, half_unit


def test_the_scenes_of_impacts_hold_the_published_data():
    inch = 0.0254
    pound = 4.4482216152605
    (rod,), (bar,), (mass,) = (tuple(cases(name)) for name in ("ansys-vm265", "siconos-bar", "bouncing-mass"))
    assert rod.block.young == pytest.approx(3e7 * pound / inch**2, rel=1e-12)
    assert rod.block.density == pytest.approx(0.73e-3 * pound / inch**4, rel=1e-12)
    assert (rod.block.velocity, rod.contact.gap) == pytest.approx((-202.2 * inch, 0.01 * inch), rel=1e-12)
    assert impacts.transit(rod) == pytest.approx(10 / math.sqrt(3e7 / 0.73e-3), rel=1e-12)
    assert [bar.block.young, bar.block.density, bar.block.velocity, bar.contact.gap] == [210e9, 7800.0, -0.1, 5e-5]
    landing, leaving, depth = impacts.bounce(mass)
    assert landing == pytest.approx((math.sqrt(41) - 1) / 10)
    assert leaving - landing == pytest.approx(0.2 * (math.pi - math.atan(math.sqrt(41))))
    assert depth == pytest.approx(0.1 + math.sqrt(0.01 + 0.41))
    assert all(impacts.stiffness_ratio(case) == pytest.approx(1e4) for case in (rod, bar))


def shaking(t):
    """The record of the slope: a pulse of three sines [m]."""
    parts = ((0.042, 1.3, 0.0), (0.0085, 2.9, 1.0), (0.0022, 5.3, 2.0))
    swings = sum(size * np.sin(2 * np.pi * rate * t + phase) for size, rate, phase in parts)
    return (t / 0.4) ** 3 * np.exp(3 - 3 * t / 0.4) * swings


def sines(*frequencies):
    """A record of sines of a millimetre each [m]."""
    return lambda t: 1e-3 * np.sin(2 * np.pi * np.outer(frequencies, t)).sum(axis=0)


def pulse(t):
    """A constant acceleration that ends [m]."""
    end = rocking.DURATION
    return rocking.PUSH * np.where(t <= end, t**2 / 2, end**2 / 2 + end * (t - end))


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "direction", "formula"),
    [
        (sliding.QUAKE, "x", shaking),
        (rocking.PULSED, "x", pulse),
        (response.BASE, "y", sines(*response.FREQUENCIES)),
        (response.DAMPING, "y", sines(*response.LOW)),
    ],
)
def test_a_record_is_its_formula(name, direction, formula):
    for case in cases(name):
        record = base_record(case)
        assert record.time[-1] >= case.time.duration * (1 - 1e-12)
        assert getattr(record, direction) == pytest.approx(formula(record.time), abs=5.1e-11)  # ten decimals


@pytest.mark.parametrize(
    ("printed", "half"),
    [("-0.04033057058886", 5e-15), ("3514046.36162", 5e-6), ("-9.871e-3", 5e-7), ("41", 0.5), (1e7, 0.0)],
)
def test_the_uncertainty_of_a_printed_number_is_half_a_unit_of_its_last_digit(printed, half):
    assert half_unit(printed) == pytest.approx(half, rel=1e-9)
