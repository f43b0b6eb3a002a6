"""Matrices of the two-block model: printed forms, high precision, contact-gap coordinates."""

import numpy as np
import pytest
from oracles import block_in_digits

from dda import Block, Contact, Material, Scheme, TwoBlockModel

PENTAGON = [[1, 1], [3.1, 1.7], [2.9, 3.3], [1.5, 4], [0.7, 2]]
MATERIALS = [Material(2100.0, 3e9, -0.6), Material(2100.0, 3e9, 0.37, "plane strain")]
ELL = np.array([[0, 0], [4, 0], [4, 1], [1.5, 1], [1.5, 3], [0, 3]])


def test_section_of_an_ell_is_that_of_two_rectangles_near_and_far():
    for shift in ((0.0, 0.0), (2.0**30, -(2.0**28))):  # by which the shifted corners are exact
        section = Block(ELL + shift, MATERIALS[0]).section
        moments = [section.area, section.s1, section.s2, section.s3]
        assert moments == pytest.approx([7.0, 2881 / 336, 109 / 21, -45 / 14], rel=1e-14)  # a few dozen roundings
        assert section.centroid == pytest.approx((41 / 28 + shift[0], 8 / 7 + shift[1]), rel=1e-15)


def rotated(width, height, angle, origin):
    """Return the corners of a rectangle turned about its first corner."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[0, 0], [width, 0], [width, height], [0, height]]) @ [[c, s], [-s, c]] + origin


@pytest.mark.parametrize("material", MATERIALS)
def test_matrices_agree_with_high_precision(material):
    model = TwoBlockModel(Block(PENTAGON, material), Contact(2e9, 0.7e9), 5e6, base=1, top=3)
    exact = block_in_digits.locked_matrices(model, Scheme(0.5, 1.0, 1.0, 1e-3))
    for got, digits in zip((model.mass, model.stiffness, model.force), exact, strict=True):
        exact = digits.astype(float)
        np.testing.assert_allclose(got, exact, rtol=0, atol=1e-14 * np.abs(exact).max())


@pytest.mark.parametrize(
    ("material", "vertices", "kept"),
    [
        # loaded in w and e2 alone: a bulge on one side couples the rest through the inertia
        (Material(1.0, 1.0, 0.0), [[0, 0], [2, 0], [2.5, 1], [2, 2], [0, 2]], ("U", "w", "s", "ex", "e2", "gxy")),
        (Material(1.0, 1.0, 0.0), rotated(2.0, 0.7, 0.0, [0.1, 0.3]), ("w", "e2")),
        (Material(1.0, 1.0, 0.2), [[0, 0], [3, 0], [2.1, 1.7], [0.9, 1.7]], ("w", "ex", "e2")),
        (Material(1.0, 1.0, 0.0), rotated(2.0, 0.7, 0.4, [0, 0]), ("U", "w", "s", "e2", "gxy")),
    ],
)
def test_unknowns_out_of_reach_are_dropped(material, vertices, kept):
    top = 3 if vertices[2][0] == 2.5 else 2
    model = TwoBlockModel(Block(vertices, material), Contact(1.0), 1.0, top=top)
    assert model.reached.unknowns == kept
