"""Area integrals, polygon checks, material and block data."""

import numpy as np
import pytest

from dda import Block, Material

ROCK = Material(2500.0, 3e9, 0.2)
# an L, whose integrals are those of two rectangles
ELL = [[0, 0], [4, 0], [4, 1], [1.5, 1], [1.5, 3], [0, 3]]


# area, centroid and central moments of the L, of 4 x 1 and 1.5 x 2
ELL_SECTION = (7.0, 41 / 28, 8 / 7, 2881 / 336, 109 / 21, -45 / 14)


# The shifts are powers of two so that the shifted corners are exact; then so is the local shape.
@pytest.mark.parametrize("shift", [(0.0, 0.0), (2.0**30, -(2.0**28))])
def test_section_of_an_ell_is_exact_near_and_far(shift):
    section = Block(np.array(ELL) + shift, ROCK).section
    s, x0, y0, s1, s2, s3 = ELL_SECTION
    got = [section.area, section.s1, section.s2, section.s3]
    assert got == pytest.approx([s, s1, s2, s3], rel=1e-14)  # a few dozen roundings
    assert section.centroid == pytest.approx((x0 + shift[0], y0 + shift[1]), rel=1e-15)


def test_corners_on_a_straight_edge_are_accepted():
    assert Block([[0, 0], [1, 0], [2, 0], [2, 2], [0, 2]], ROCK).section.area == 4.0
