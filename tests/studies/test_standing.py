"""The study `standing`: limits and the truss against numbers of other programs."""

import math

import numpy as np
import pytest
from conftest import thinned
from oracles.stand_ins import history

from validation.models.plane import limits
from validation.models.plane.canon import half_truss
from validation.scenes.scene import load_scene
from validation.studies.standing.formulas import at_rest, turned_columns
from validation.suite.bands import cases

DIP = math.radians(30)
COULOMB = [(35, 3, 2.33678219, 2.56823), (35, 5, 2.73726587, 3.32522), (40, 3, 3.12255634, 4.33108)]
OVERHANG_FORCES = [(23357.143, 1167.857), (47441.803, 1608.197), (71389.604, 2185.396)]  # of a block of 24525 N
DROP = {  # x and y from the start, turn, N at A and C, shear at A, by DOP853 and LSODA
    0.02: (-2.24883958e-5, -0.00149383215506, 4.67369604e-4, 37054.6767, 51780.6618, 55455.6310),
    0.1: (-0.00104610905439, -0.0154670182010, 0.00682906629656, 427326.3996, 422875.8442, 173271.3700),
    0.2: (4.80616610e-5, -3.45723606e-4, -8.72548139e-5, 4513.5301, 14918.3912, 52106.9073),
}


@pytest.mark.parametrize(("phi", "count", "recursion", "program"), thinned(COULOMB, 3))
def test_columns_on_a_flat_base_have_the_brackets_of_another_program(phi, count, recursion, program):
    heights = limits.flat_height(count, 1.0, DIP, math.tan(math.radians(phi)))
    assert heights == pytest.approx((recursion, program), rel=3e-6)


@pytest.mark.long
def test_limits_are_those_of_another_program():
    assert math.degrees(limits.stepped_dip([2, 4, 4, 4, 4], 1.0, 1.0, 0.8)) == pytest.approx(14.6417, abs=5e-5)
    assert limits.keyed_dip(2.36188746487, 5, 1.0) == pytest.approx(DIP, rel=1e-11)
    assert limits.least_thickness(1.0, 7) == pytest.approx(0.095703, abs=5e-7)
    by_chords = [limits.least_thickness(1.0, 8, chords) for chords in (2, 4)]
    assert (4 * by_chords[1] - by_chords[0]) / 3 == pytest.approx(0.10086149113203, abs=4e-6)  # of arcs: second order
    assert limits.leaning_friction(math.radians(50), 7.5) == pytest.approx(0.352883148922, rel=1e-11)
    assert limits.harmonic(8, 1.0) == pytest.approx(761 / 560)
    forces = 24525 * np.array(limits.seat_forces(3, 2.0, 0.95))
    assert forces == pytest.approx(np.array(OVERHANG_FORCES), abs=5e-4)


@pytest.mark.long
def test_the_columns_of_the_book_need_the_friction_that_is_printed():
    dip = math.radians(30)
    for falls, friction in ((6.2, 0.7850566613), (6.0, 0.7855442214)):  # printed: 0.7855, with heights of 34, 28, ...
        heights = tuple(4.0 * min(n, 10) - falls * max(0, n - 10) for n in range(1, 17))
        recursion, program = limits.stepped_friction(heights, 10.0, 1.0, dip)
        assert recursion == pytest.approx(friction, abs=1e-9)
        assert 0.6 < program < recursion
    heights = [4.0 * min(n, 10) - 6.2 * max(0, n - 10) for n in range(1, 17)]
    assert 25 * limits.recursion(heights, 10.0, 1.0, dip, 0.65) == pytest.approx(4115.586, abs=5e-4)  # kN at the toe


def test_columns_begin_to_turn_as_another_program_has_them():
    scene = load_scene("standing-turning")
    assert 2e8 * turned_columns(scene, np.array([1e-4]))[0] == pytest.approx(0.442422153194, rel=1e-6)


def test_half_a_truss_rests_and_moves_as_another_program_has_it():
    truss = half_truss(next(cases("standing-truss-load")))
    u, load = truss.limit
    assert (math.atan2(1, 4) - u, load) == pytest.approx((0.114591304192557, 1110203.06756373), rel=1e-9)
    rests = [truss.rest(share * load)["turn"] for share in (0.0, 0.5, 0.9)]
    assert rests == pytest.approx([0.023357203961846915, 0.0482543113365478, 0.0836526059742487], rel=1e-9)
    assert truss.rest(0.0)["thrust"] == pytest.approx(217687.901496793, rel=1e-9)
    assert truss.rest(1.01 * load) is None
    rows = truss.motion(np.array([0.0, *DROP]))
    moved = rows[1:] - [*rows[0][:3], 0.0, 0.0, 0.0]
    assert moved == pytest.approx(np.array([*DROP.values()]), rel=1e-7, abs=1e-12)


def test_half_a_truss_is_loaded_with_its_weight_and_a_share_of_what_is_left_to_its_limit():
    loads = [at_rest(case, history(case, "dda"))["load"] for case in load_scene("standing-truss-load").expand()]
    assert loads == pytest.approx([loads[0] + share * (1 - loads[0]) for share in (0.0, 0.5, 0.9)], rel=1e-6)
