"""The first contact of two polygons: closed and independent instants, pairs, places and normals."""

import math

import numpy as np
import pytest

from dda.plane.first_contact import CORNER_CORNER, CORNER_EDGE, EDGE_EDGE, first_contact

SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
LEDGE = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)])  # an L
BAR = np.array([(-2.0, -0.1), (2.0, -0.1), (2.0, 0.1), (-2.0, 0.1)])
AT_REST = (0.0,) * 6


def in_radians(motion):
    return (*motion[:2], math.radians(motion[2]), *motion[3:])


def contact_of(A, motion_A, B, motion_B, until=3.0, size=1.0):
    """Return the first contact of a scene that is drawn larger or smaller by a factor."""
    grown = np.array([size, size, 1.0, size, size, 1.0])
    return first_contact(size * A, size * B, grown * in_radians(motion_A), grown * in_radians(motion_B), until)


# A meets B, which is at rest: kind, every point (block, corner, edge, foot), normals in degrees. Those of a
# corner on an edge are by roots of 30 digits and by conservative advancement.
WALL = 2 * SQUARE + (3.2, 0)
SWUNG = (math.radians(135) - math.atan(0.05) - math.acos(1.2 / math.sqrt(4.01))) / 3
PLACES = {
    "a corner is clipped": (
        *(SQUARE, (2.413213562373095, 2, 45, 0, -1.5, 0), SQUARE, 0.666, CORNER_EDGE),
        *([(1, 2, 3, 0.000707106781186)], (45.0, 45.0)),
    ),
    "a bar swings onto a wall": (
        *(BAR * (0.5, 1) + (1, 0), (0, 0, 135, 0, 0, -3), WALL, SWUNG, CORNER_EDGE),
        *([(0, 1, 3, (2 - math.sqrt(4.01 - 1.44)) / 4)], (180.0, 180.0)),
    ),
    "nearly parallel": (
        *(SQUARE, (0.5, 3, 5.729577951308232e-5, 0, -1, 0), SQUARE, 0.9999990000005, CORNER_EDGE),
        *([(0, 0, 2, 0.74999949999975)], (90.0, 90.0)),
    ),
    "past a corner": (
        *(SQUARE, (-3, 2.2 + math.sqrt(2), 45, 2, -1, 0), SQUARE, 1.2, CORNER_EDGE),
        *([(0, 0, 2, 0.8)], (90.0, 90.0)),
    ),
    "past the other corner": (
        *(SQUARE, (3, 2.2 + math.sqrt(2), 45, -2, -1, 0), SQUARE, 1.2, CORNER_EDGE),
        *([(0, 0, 2, 0.2)], (90.0, 90.0)),
    ),
    "corner on corner": (
        *(SQUARE, (4, 4, 0, -1, -1, 0), SQUARE, 2.0, CORNER_CORNER),
        *([(0, 0, 1, 1.0), (1, 2, 0, 0.0)], (0.0, 90.0)),
    ),
    "turned corner on corner": (
        *(SQUARE, (1, 4, 45, 0, -1, 0), SQUARE, 3 - math.sqrt(2), CORNER_CORNER),
        *([(0, 0, 1, 1.0), (1, 2, 0, 0.0)], (45.0, 90.0)),
    ),
    "edge on edge": (
        *(SQUARE, (0.5, 3, 0, 0, -1, 0), SQUARE, 1.0, EDGE_EDGE),
        *([(0, 0, 2, 0.75), (1, 2, 0, 0.75)], (90.0, 90.0)),
    ),
    "parallel at the instant of the touch": (
        *(SQUARE, (0.5, 3, math.degrees(-0.5), 0, -1, 0.5), SQUARE, 1.0, EDGE_EDGE),
        *([(0, 0, 2, 0.75), (1, 2, 0, 0.75)], (90.0, 90.0)),
    ),
    "equal edges": (
        *(SQUARE, (0, 3, 0, 0, -1, 0), SQUARE, 1.0, EDGE_EDGE),
        *([(0, 0, 2, 1.0), (0, 1, 2, 0.0)], (90.0, 90.0)),
    ),
    "in touch from the start": (
        *(SQUARE, (-0.5, 2, 0, 0, 1, 0), SQUARE, 0.0, EDGE_EDGE),
        *([(0, 1, 2, 0.25), (1, 3, 0, 0.25)], (90.0, 90.0)),
    ),
}


def test_instant_kind_and_places_of_a_first_touch():
    ahead = np.array([0.7, -1.3, 0.0, 4.0, 2.5, 0.0])  # of a moving frame, and A for B
    for number, (name, (A, motion, B, time, kind, points, normals)) in enumerate(PLACES.items()):
        contact = contact_of(A, motion, B, AT_REST, size=(1.0, 1e6, 1e-6)[number % 3])
        assert contact.time == pytest.approx(time, abs=1e-13), name
        assert contact_of(B, ahead, A, motion + ahead).time == pytest.approx(time, abs=1e-13), name
        (touch,) = contact.touches
        assert touch.kind == kind, name
        assert [tuple(point[:3]) for point in touch.points] == [point[:3] for point in points], name
        assert [point.foot for point in touch.points] == pytest.approx([point[3] for point in points], abs=1e-9), name
        assert np.abs(np.degrees(touch.normals)) == pytest.approx(normals, abs=1e-9), name


# A goes into the notch of the L: what touches there at once
NOTCHES = {
    "a square": (SQUARE / 4, (1.75, 1.75, 0, -1, -1, 0), 0.5, [(EDGE_EDGE, 0.0), (EDGE_EDGE, 90.0)]),
    "a corner": (SQUARE / 4, (2.25, 2.25, 45, -1, -1, 0), None, [(CORNER_EDGE, 0.0), (CORNER_EDGE, 90.0)]),
    "a flat side": (SQUARE * (1.5, 0.25), (3, 3, -45, -1, -1, 0), None, [(CORNER_EDGE, 45.0), (CORNER_EDGE, 45.0)]),
}


@pytest.mark.parametrize("name", NOTCHES)
def test_all_that_touches_at_once_is_named(name):
    A, motion, time, touches = NOTCHES[name]
    contact = contact_of(A, motion, LEDGE, AT_REST)
    if time is not None:
        assert contact.time == pytest.approx(time, abs=1e-13)
    found = sorted((touch.kind, round(math.degrees(touch.normals[0]), 9)) for touch in contact.touches)
    assert found == touches


@pytest.mark.parametrize(
    ("motion", "until"),
    [((3, 3, 45, 0, -1.5, 0), 2.0), ((0.5, 3, 0, 0, -1, 0), 0.999), ((0, 3, 10, 0, 0, 7), 13.0)],
    ids=["past", "too early", "turns beside"],
)
def test_no_contact_until_then(motion, until):
    assert contact_of(SQUARE, motion, SQUARE, AT_REST, until=until) is None


@pytest.mark.parametrize("place", [(0.0, 0.0), (1.9, 1.9), (0.0, 1.999999)])
def test_polygons_that_overlap_are_refused(place):
    with pytest.raises(ValueError, match=r"^until: "):
        contact_of(SQUARE, (3, 3, 0, 0, 0, 0), SQUARE, AT_REST, until=0.0)
    with pytest.raises(ValueError, match=r"^polygons: must not overlap"):
        contact_of(SQUARE, (*place, 0, 0, 0, 0), SQUARE, AT_REST)
