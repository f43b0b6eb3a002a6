"""Area integrals, polygon checks, material and block data."""

import math

import numpy as np
import pytest

from dda import Block, Contact, Material, Scheme, TwoBlockModel

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


@pytest.mark.parametrize(
    ("vertices", "rule"),
    [
        ([[0, 0], [0, 1], [1, 1], [1, 0]], "counter-clockwise"),
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "cross or touch"),
        ([[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]], "cross or touch"),
        ([[0, 0], [2, 0], [1, 0], [1, 1]], "cross or touch"),
        ([[0, 0], [1, 0], [1, 0], [0, 1]], "must differ"),
        ([[0, 0], [1, 0], [math.nan, 1]], "finite"),
        ([[0, 0], [1, 0]], "at least three"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0]], "at least three"),
    ],
)
def test_bad_polygons_are_refused_by_rule(vertices, rule):
    with pytest.raises(ValueError, match=rf"^vertices: .*{rule}"):
        Block(vertices, ROCK)


def test_corners_on_a_straight_edge_are_accepted():
    assert Block([[0, 0], [1, 0], [2, 0], [2, 2], [0, 2]], ROCK).section.area == 4.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Material(0.0, 1e9, 0.2), "density: .*0.0"),
        (lambda: Material(1.0, math.inf, 0.2), "young: .*inf"),
        (lambda: Material(1.0, 1.0, -1.0), "poisson: .*-1.0"),
        (lambda: Material(1.0, 1.0, 0.51), "poisson: .*0.51"),
        (lambda: Material(1.0, 1.0, math.nan), "poisson: .*nan"),
        (lambda: Material(1.0, 1.0, 0.5, "plane strain"), "poisson: .*0.5 in plane strain"),
        (lambda: Material(1.0, 1.0, 0.1, "axial"), "hypothesis: .*axial"),
        (lambda: Contact(-1.0), "stiffness: .*-1.0"),
        (lambda: Contact(1.0, 0.0), "shear_stiffness: .*0.0"),
        (lambda: Scheme(-0.1, 1, 1, 1), "alpha: .*-0.1"),
        (lambda: Scheme(0.5, math.nan, 1, 1), "delta: .*nan"),
        (lambda: Scheme(0.5, 1, 1.1, 1), "gg: .*1.1"),
        (lambda: Scheme(0.5, 1, 1, 0.0), "step: .*0.0"),
        (lambda: Scheme(0.5, 1, 1, 1, "warm"), "start: .*warm"),
        (lambda: TwoBlockModel(Block(ELL, ROCK), Contact(1.0), math.nan), "pressure: .*nan"),
        (lambda: TwoBlockModel(Block(ELL, ROCK), Contact(1.0), 1.0, base=6), "base: .*6"),
        (lambda: TwoBlockModel(Block(ELL, ROCK), Contact(1.0), 1.0, base=1, top=1), "top: .*1"),
        (lambda: Block(ELL, ROCK).edge(-1), "edge: .*-1"),
    ],
)
def test_bad_data_is_refused_by_field_and_value(make, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        make()
