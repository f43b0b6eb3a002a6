"""Outlines of blocks, records and loads as a scene reads them."""

import numpy as np
import pytest

from validation.errors import InputError
from validation.scenes import drive
from validation.scenes.record import Record, direction


def test_a_base_moves_along_one_line_towards_x_or_towards_y_where_that_is_steeper():
    for x, y, line in (
        ([0.0, -0.3, 0.7], [0.0, 0.0, 0.0], (1.0, 0.0)),
        ([0.0, 0.0, 0.0], [0.0, -0.2, -0.5], (0.0, 1.0)),
        ([0.0, 0.3, -0.9], [0.0, -0.4, 1.2], (-0.6, 0.8)),
        ([0.0, -8e-9, -4e-9], [0.0, -6e-9, -3e-9], (0.8, 0.6)),
    ):
        assert direction(Record(np.arange(3.0), np.array(x), np.array(y))) == pytest.approx(line, abs=1e-12)
    for x, y in (([0.0] * 3, [0.0] * 3), ([0.0, 1.0, 2.0], [0.0, 1.0, 2.01])):
        with pytest.raises(InputError) as error:
            direction(Record(np.arange(3.0), np.array(x), np.array(y)))
        assert error.value.field == "load.base_motion"


@pytest.mark.parametrize(
    ("shape", "parameter", "value"),
    [
        (drive.half_sine, 0.4, lambda t: 3 * np.sin(np.pi * t / 0.4) * (t < 0.4)),
        (drive.triangle, 0.4, lambda t: 3 * (1 - t / 0.4) * (t < 0.4)),
        (drive.sine, 1.7, lambda t: 3 * np.sin(2 * np.pi * 1.7 * t)),
        (drive.cosine, 1.7, lambda t: 3 * np.cos(2 * np.pi * 1.7 * t)),
    ],
)
def test_a_course_in_time_is_the_derivative_of_its_integral_and_begins_it_at_zero(shape, parameter, value):
    step = 1e-5
    t = np.array([0.03, 0.17, 0.33, 0.61])
    _, course, rise = shape(3.0, parameter, t)
    ahead, behind = (shape(3.0, parameter, t + shift) for shift in (step, -step))
    assert course == pytest.approx(value(t), rel=1e-12, abs=1e-12)
    assert (ahead[0] - behind[0]) / (2 * step) == pytest.approx(course, rel=1e-6, abs=1e-6)
    assert (ahead[1] - behind[1]) / (2 * step) == pytest.approx(rise, rel=1e-6, abs=1e-6)
    assert shape(3.0, parameter, np.zeros(1))[0] == 0


def test_a_record_is_straight_between_its_rows_and_ends_with_the_last_one():
    """Of accelerations the speed that it ends with stays."""
    record = (np.array([1.0, 2.0, 4.0]), np.array([2.0, 6.0, 4.0]))
    times = np.array([0.0, 1.5, 3.0, 5.0])
    course = [0.0, 4.0, 5.0, 0.0]
    integral = [0.0, 1.5, 9.5, 14.0]
    rise = [0.0, 4.0, -1.0, 0.0]
    twice = [0.0, 1 / 3, 8.5, 103 / 3]
    for order, parts in ((1, (integral, course, rise)), (2, (twice, integral, course))):
        assert np.array(drive.recorded(*record, order, times)) == pytest.approx(np.array(parts), abs=1e-12), order
