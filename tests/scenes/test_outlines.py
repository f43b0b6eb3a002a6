"""Outlines of blocks, records and loads as a scene reads them."""

import pytest

from validation.scenes.outline import check_polygon

PENTAGON = [[0.0, 0.0], [3.0, 0.0], [4.0, 2.0], [2.0, 3.0], [-1.0, 2.0]]


@pytest.mark.parametrize(
    ("vertices", "words"),
    [
        (((0, 0), (2, 0), (2, 1), (2, 0.5), (0, 2)), "cross themselves, got edges 1 and 2"),
        (((0, 0), (1, 0), (1.5, 1), (2, 0)), "cross themselves, got edges 0 and 3"),  # back over the first one
        (((0, 0), (1, 0), (2, 0)), "cross themselves"),
        (((0, 0), (0, 2), (1, 2), (1, 0)), "must run counter-clockwise"),
        (((0, 0), (4, 0), (4, 2), (2, 0), (0, 2)), "cross themselves"),  # a corner touches the base
        (((0, 0), (2, 2), (2, 0), (0, 2)), "cross themselves"),
        (((0, 0), (2, 0), (1, 0), (1, 2)), "cross themselves"),  # an edge folded back on its neighbour
        (((0, 0), (0, 0), (2, 0), (2, 2)), "must not repeat"),
        (((0, 0), (2, 0)), "must be three or more"),
    ],
)
def test_outlines_that_are_none(vertices, words):
    with pytest.raises(ValueError, match=words):
        check_polygon(vertices, 0, 1)


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
