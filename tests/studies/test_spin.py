"""Blocks that spin, and blocks on a ledge: the exact motions against numbers of other programs."""

import math

import numpy as np
import pytest

from validation.theory.spinning import Slide, Spinning

SQUARE = Spinning(2.0, 2.0, 2700.0, 1e8, 0.25, 20.0)
RECTANGLE = Spinning(2.0, 1.0, 2700.0, 1e8, 0.25, 20.0)
SWING = 0.0162591742724599694  # s


def test_a_square_swings_as_its_equation_of_one_unknown_has_it():
    half, whole = (SQUARE.at(np.array([time])) for time in (SWING / 2, SWING))
    assert half["ex"] == pytest.approx(0.00535691683443636, abs=1e-13)
    assert whole["ex"] == pytest.approx(0.0, abs=1e-13) and whole["gxy"] == pytest.approx(0.0, abs=1e-13)
    assert whole["angle"] == pytest.approx(0.323451928308864315, abs=1e-12)
    assert SQUARE.steady_strain == pytest.approx(0.00267842049503542, abs=1e-16)
    assert SQUARE.momentum == 144000


@pytest.mark.long
def test_a_square_spins_for_a_hundred_turns_as_its_equation_has_it():
    moved = SQUARE.at(np.array([10 * math.pi]))
    assert moved["ex"] == pytest.approx(0.00180174707, abs=5e-12)
    assert moved["angle"] == pytest.approx(624.973081387 - 198 * math.pi, abs=1e-9)


@pytest.mark.long
def test_a_rectangle_swings_as_two_other_programs_have_it():
    moved = RECTANGLE.at(np.array([math.pi]))
    printed = {"ex": 7.48780141e-4, "ey": 0.00194805412, "gxy": 2 * -3.86763715e-4, "angle": -0.335056469}
    assert {name: values[0] for name, values in moved.items()} == pytest.approx(printed, rel=1e-8)


def test_a_rigid_block_tips_as_two_other_programs_have_it():
    rough = Slide(2.0, 1.0, 0.3, -1.5, 3.0)
    assert rough.tips == pytest.approx((0.670541516162, 1.026596317936), abs=1e-12)
    assert rough.turn(0.93) == pytest.approx(0.05450298, abs=5e-9)
    smooth = Slide(2.0, 1.0, 0.0, -1.5, 0.5)
    assert smooth.tips == pytest.approx((3.0, 0.5))
    assert smooth.turn(3.829836472302) == pytest.approx(0.729337582516, abs=1e-11)
    stops = Slide(2.0, 1.0, 0.5, -1.5, 3.5)
    assert stops.tips is None and stops.turn(9.0) == 0.0
    assert stops.start + stops.stopping_distance == pytest.approx(-0.251274209990, abs=1e-12)
    with pytest.raises(ValueError, match="time"):
        rough.turn(0.94)  # the slide ends at 0.936 s
