"""Outlines of blocks, records and loads as a scene reads them."""

import pytest

from validation.scenes.outline import check_polygon

PENTAGON = [[0.0, 0.0], [3.0, 0.0], [4.0, 2.0], [2.0, 3.0], [-1.0, 2.0]]


@pytest.mark.parametrize(
    "vertices",
    [
        tuple(map(tuple, PENTAGON)),
        ((0, 0), (3, 0), (3, 3), (2, 1), (1, 1), (0, 3)),  # a notch whose floor is in line with no edge
        ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (2, 2), (2, 3), (0, 3)),  # upright edges in one line that do not meet
        ((0, 0), (1, 0), (2, 0), (2, 1), (0, 1)),  # a vertex within a straight edge
    ],
    ids=["pentagon", "notch", "C", "straight"],
)
def test_outlines_that_are_sound(vertices):
    check_polygon(vertices, 0, 2)
