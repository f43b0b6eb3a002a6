"""Contacts that are found in a step: which corner on which edge, what they go on from, and the parts of outlines."""

import numpy as np
import pytest

from dda.contact.rows import INSIDE, LOWER, TOO_DEEP, TOO_MANY
from dda.model.polygon import section
from dda.plane.bodies import as_complex
from dda.plane.detect import detection_of, find_contacts, keep_contacts
from dda.plane.polygons import convex_parts, turns_of

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
DIAMOND = np.array([(0.0, 0.0), (0.5, 0.5), (0.0, 1.0), (-0.5, 0.5)])
LEDGE = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)])  # an L
COMB = np.array([(0, 0), (5, 0), (5, 2), (4, 2), (4, 1), (3, 1), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)], float)
SPIRAL = np.array([(0, 0), (4, 0), (4, 3), (1, 3), (1, 2), (3, 2), (3, 1), (0, 1)], float)
BOTTOM, RIGHT, TOP, LEFT = range(4)


def at(polygon, x, y):
    """Return a polygon moved."""
    return polygon + np.array([x, y])


def places(polygons, pairs):
    """Return the places of all corners, sorted."""
    return sorted(tuple(polygons[block][corner]) for block, corner, _, _ in pairs)


class Scene:
    """Blocks of which the first is fixed, and all others move alike in a step."""

    def __init__(self, polygons, most=100):
        self.polygons = [np.array(polygon, dtype=float) for polygon in polygons]
        moves = [number > 0 for number in range(len(polygons))]
        law = np.zeros((len(polygons), len(polygons)), dtype=int)
        size = min(np.sqrt(section(polygon).area) for polygon in self.polygons[1:])
        self.detection = detection_of([as_complex(polygon) for polygon in self.polygons], moves, law, most, size)

    def step(self, way=(0.0, 0.0), now=None):
        """Return the contacts (block, corner, on, edge) of a step from `now`, without contact by `way`."""
        detection = self.detection
        detection.corners.now[:] = as_complex(np.vstack(self.polygons if now is None else now))
        detection.corners.then[:] = detection.corners.now
        detection.corners.then[detection.moves[detection.corners.block] != 0] += complex(*way)
        self.count = find_contacts(detection)
        return self.named(detection.contacts, self.count)

    def named(self, contacts, count):
        corners = self.detection.corners
        pairs = []
        for corner, edge in zip(contacts.corner[:count], contacts.edge[:count], strict=True):
            own = int(corners.block[corner]), int(corner - corners.start[corner])
            pairs.append((*own, int(corners.block[edge]), int(edge - corners.start[edge])))
        return pairs

    def press(self, *forces):
        """Accept the step, with a force of each contact; those without one are open."""
        states = [INSIDE if force > 0 else LOWER for force in forces]
        keep_contacts(self.detection, forces, states, 0)


NARROW = np.array([(0.0, 0.0), (0.94, 0.34), (0.34, 0.94)])
STEEP = np.array([(0.0, 0.0), (1.0, 0.2), (0.6, 1.1), (-0.4, 0.9)])

# of each: polygons, way of the step without contact, and contacts (block, corner, on, edge)
SITUATIONS = {
    "a square above a floor": ([SQUARE * 4 - (1, 4), SQUARE], (0, -0.01), [(1, 0, 0, TOP), (1, 1, 0, TOP)]),
    "too far above it": ([SQUARE * 4 - (1, 4), at(SQUARE, 0, 0.03)], (0, -0.005), []),
    "a step from too far": ([SQUARE * 4 - (1, 4), at(SQUARE, 0, 0.03)], (0, -0.02), [(1, 0, 0, TOP), (1, 1, 0, TOP)]),
    "a corner alone": ([SQUARE * 4 - (1, 4), STEEP], (0, -0.01), [(1, 0, 0, TOP)]),
    "half over an edge": ([SQUARE - (0.5, 1), SQUARE], (0, -0.01), [(1, 0, 0, TOP), (0, 2, 1, BOTTOM)]),
    "equal squares": ([SQUARE - (0, 1), SQUARE], (0, -0.01), [(1, 0, 0, TOP), (1, 1, 0, TOP)]),
    "a diamond within a corner": ([SQUARE - (1, 1), at(DIAMOND, -0.001, 5e-4)], (0, -1e-3), [(1, 0, 0, TOP)]),
    "a diamond outside of a corner": ([SQUARE - (1, 1), at(DIAMOND, 0.001, 2e-3)], (0, -6e-3), [(0, 2, 1, 3)]),
    "beside a corner, from the right": ([SQUARE - (1, 1), at(DIAMOND, 0.502, -0.6)], (-4e-3, 0), [(1, 3, 0, RIGHT)]),
    "beside a side, past its corner": (
        *([SQUARE - (1, 1), at(SQUARE, 0.004, 0.004)], (0, -0.01)),
        *([(1, 0, 0, RIGHT), (0, 2, 1, LEFT)],),
    ),
    "into a notch": (
        [LEDGE, at(SQUARE, 1.01, 1.01)],
        (-0.02, -0.02),
        [(1, 0, 0, 2), (0, 2, 1, BOTTOM), (1, 0, 0, 3), (0, 4, 1, LEFT)],
    ),
    "on the step of an L": ([LEDGE, at(SQUARE, 1.5, 1)], (0, -0.01), [(0, 2, 1, BOTTOM), (1, 0, 0, 2)]),
    "on the foot of an L": ([LEDGE, SQUARE / 2 - (0, 0.5)], (0, 0.01), [(1, 2, 0, 0), (1, 3, 0, 0)]),
    "an L on a floor": ([SQUARE * 4 - (1, 4), LEDGE], (0, -0.01), [(1, 0, 0, TOP), (1, 1, 0, TOP)]),
    "an L upside down": (
        *([SQUARE * 4 - (1, 4), LEDGE[::-1] * (1, -1) + (0, 2)], (0, -0.01)),
        *([(1, 0, 0, TOP), (1, 1, 0, TOP)],),
    ),
    "a tip into a notch": (
        *([LEDGE, at(NARROW, 1.0003, 1.0003)], (-7e-4, -7e-4)),
        *([(1, 0, 0, 2), (1, 0, 0, 3)],),
    ),
    "pressed into a notch": (
        *([LEDGE, at(SQUARE / 4, 1 - 1e-6, 1 - 1e-6)], (-1e-5, -1e-5)),
        *([(1, 0, 0, 2), (1, 1, 0, 2), (1, 0, 0, 3), (1, 3, 0, 3)],),
    ),
    "past a wall into a notch": (
        *([LEDGE, at(NARROW, 1.001, 1.003)], (-2e-3, -4.5e-3)),
        *([(1, 0, 0, 2), (1, 0, 0, 3)],),
    ),
    "straight corners are none": (
        *([np.array([(-1, -1), (0.5, -1), (2, -1), (2, 0), (0.5, 0), (-1, 0)]), SQUARE], (0, -0.01)),
        *([(1, 0, 0, 3), (1, 1, 0, 3)],),
    ),
}


def test_corners_and_edges_of_a_step():
    """In any size, far away, and in a mirror."""
    for number, (name, (polygons, way, pairs)) in enumerate(SITUATIONS.items()):
        size = (1.0, 1e3, 1e-3)[number % 3]
        scene = Scene([size * np.array(polygon) for polygon in polygons])
        assert sorted(scene.step(size * np.array(way))) == sorted(pairs), name
        far = [at(np.array(polygon), 2.0**13, -(2.0**12)) for polygon in polygons]
        assert sorted(Scene(far).step(way)) == sorted(pairs), name
        size = (1e-3, 1.0, 1e3)[number % 3]
        mirrored = [size * np.array(polygon)[::-1] * (-1, 1) for polygon in polygons]
        sizes = [len(polygon) for polygon in polygons]
        swapped = [
            (block, sizes[block] - 1 - corner, on, (sizes[on] - 2 - edge) % sizes[on])
            for block, corner, on, edge in pairs
        ]
        found = Scene(mirrored).step(size * np.array(way) * (-1, 1))
        # of corners that coincide either may be the one: they are compared by their places
        assert np.array(places(mirrored, found)) == pytest.approx(np.array(places(mirrored, swapped))), name


def test_a_pressed_edge_stays_however_near_another_one_is():
    floor = SQUARE - (1, 1)
    scene = Scene([floor, at(DIAMOND, -1e-3, 5e-4)])
    assert scene.step((0, -1e-3)) == [(1, 0, 0, TOP)]
    scene.press(1.0)
    deep = [floor, at(DIAMOND, -1e-3, -5e-3)]  # five times as deep under the top as it lies within the side
    assert scene.step((0, -1e-3), deep) == [(1, 0, 0, TOP)]
    assert scene.detection.contacts.same[0] == 1
    scene = Scene([floor, at(DIAMOND, -1e-3, 5e-4)])
    scene.step((0, -1e-3))
    scene.press(0.0)
    assert scene.step((0, -1e-3), deep) == [(0, 2, 1, 3)]  # the least way out, through which it did not come


def test_a_corner_on_another_edge_goes_on_from_the_nearest_contact():
    """A blunt tip, pressed at both its corners, goes over a ridge, where it leans to the other side."""
    ridge = np.array([(-1.0, -1.0), (2.0, -1.0), (2.0, -0.01), (0.5, 0.0), (-1.0, -0.01)])
    tip = np.array([(0.0, 0.0), (4e-4, 0.0), (0.6, 1.0), (-0.6, 1.0)])
    slope = np.arctan(0.01 / 1.5)
    before, after = (tip @ [[np.cos(t), np.sin(t)], [-np.sin(t), np.cos(t)]] for t in (-slope, 3 * slope))
    scene = Scene([ridge, at(before, 0.8, -0.002)])
    assert scene.step((0, -1e-3)) == [(1, 0, 0, 2), (1, 1, 0, 2)]
    scene.press(1.0, 1.0)
    assert scene.step((0, -1e-3), [ridge, at(after, 0.3, 1e-5 - 0.01 / 7.5)]) == [(1, 0, 0, 3), (1, 1, 0, 3)]
    assert scene.detection.contacts.origin[:2].tolist() == [0, 1]


def test_of_two_edges_that_are_pressed_that_with_the_greater_force_stays():
    floor = SQUARE - (0.5, 1)
    pairs = [(1, 0, 0, TOP), (0, 2, 1, BOTTOM)]
    for forces, found in (((3.0, 1.0), pairs), ((1.0, 3.0), pairs[::-1])):
        scene = Scene([floor, SQUARE])
        assert scene.step((0, -0.01)) == pairs
        scene.press(*forces)
        assert scene.step((0, -1e-3), [floor, SQUARE - (0, 1e-5)]) == found


@pytest.mark.parametrize(("ahead", "sunk"), [(-1e-3, 1e-12), (-1e-12, 5e-3), (0.0, 1e-6), (1e-12, 3e-4), (1e-3, 1e-6)])
def test_a_block_slides_over_a_flush_seam(ahead, sunk):
    floors = [SQUARE * 2 - (2, 2), SQUARE * 2 - (0, 2)]
    scene = Scene([*floors, SQUARE - (1 - ahead, sunk)])
    scene.detection.moves[1] = 0
    scene.detection.law[:] = [-1, -1, 0, -1, -1, 0, 0, 0, -1]
    scene.step((0.0, -1e-3), [*floors, SQUARE - (1.1, -1e-12)])
    scene.press(*[1.0] * scene.count)
    found = scene.step((2e-3, 0.0))
    scene.press(*[1e-9 if sunk < 1e-9 else 1e3] * len(found))
    found = scene.step((2e-3, 0.0), [*floors, SQUARE - (1 - ahead - 2e-3, sunk)])
    assert {pair[2:] for pair in found} <= {(0, TOP), (1, TOP), (2, BOTTOM)}
    assert {pair[:2] for pair in found} >= {(2, 0), (2, 1)}


def test_a_force_has_one_heir():
    scene = Scene([LEDGE, at(SQUARE / 4, 1.03, 1.0)])
    assert scene.step((0, -1e-3)) == [(1, 0, 0, 2), (1, 1, 0, 2)]
    scene.press(1.0, 1.0)
    found = scene.step((0, -1e-3), [LEDGE, at(SQUARE / 4, 1.001, 1.0)])
    origins = dict(zip(found, scene.detection.contacts.origin[: scene.count].tolist(), strict=True))
    assert origins == {(1, 0, 0, 2): 0, (1, 1, 0, 2): 1, (1, 0, 0, 3): -1, (1, 3, 0, 3): -1}


def test_what_a_contact_knew_goes_on_at_its_place_under_another_name():
    floor = SQUARE - (1, 1)
    scene = Scene([floor, at(DIAMOND, -1e-4, -1e-5)])
    assert scene.step((2e-4, -1e-4)) == [(1, 0, 0, TOP)]
    scene.press(1.0)
    # past the corner of the floor, that is now on the diamond's edge, and deeper in this step
    assert scene.step((2e-4, -1e-3), [floor, at(DIAMOND, 1e-4, -1e-5)]) == [(0, 2, 1, 3)]
    assert (scene.detection.contacts.origin[0], scene.detection.contacts.same[0]) == (0, 0)


def test_more_contacts_than_there_is_room_for():
    Scene([SQUARE * 4 - (1, 4), SQUARE], most=2).step((0, -0.01))
    few = Scene([SQUARE * 4 - (1, 4), SQUARE], most=1)
    few.step((0, -0.01))
    assert few.count == -TOO_MANY


@pytest.mark.parametrize(
    ("depths", "pressed", "deep"),
    [
        ((0.019,), 0, False),  # of the size of the smallest block, at t = 0
        ((0.021,), 0, True),
        ((-0.01, 0.1), 0, False),  # the step brought it
        ((0.009, 0.009), 0, True),  # it was inside, and nothing held it
        ((0.009, 0.0095), 1, False),
        ((-0.01, 0.1, 0.19), 1, False),
        ((-0.01, 0.26), 0, True),  # a step that brings it through a block
    ],
)
def test_a_corner_deeper_than_a_step_can_bring_it(depths, pressed, deep):
    floor = 80 * SQUARE - (20, 80)
    scene = Scene([floor, 20 * STEEP])
    for number, depth in enumerate(depths):
        if number > 0:
            scene.press(*[float(pressed)] * scene.count)
        found = scene.step((0, -0.4), [floor, 20 * STEEP - (0, 20 * depth)])
    assert (scene.count == -TOO_DEEP) == deep
    if deep:  # and which corner on which edge
        assert scene.named(scene.detection.contacts, 1) == [(1, 0, 0, TOP)]
        assert scene.detection.contacts.gap[0] == pytest.approx(-20 * depths[-1])
    else:
        assert (1, 0, 0, TOP) in found


def random_scene(seed):
    random = np.random.default_rng(seed)
    box = np.array([(-1, -1), (4, -1), (4, 6), (3, 6), (3, 0), (0, 0), (0, 6), (-1, 6)], float)
    polygons = [box]
    for row in range(3):
        for column in range(3):
            angles = np.sort(random.uniform(0, 2 * np.pi / 6, 6)) + np.arange(6) * 2 * np.pi / 6
            ring = 0.505 * np.column_stack([np.cos(angles), np.sin(angles)])
            polygons.append(at(ring, column + 0.5, row + 0.5))
    return Scene(polygons, most=1000)


def test_the_sweep_misses_no_pair(held):
    scene = random_scene(0)
    found = set(scene.step((0.003, -0.004)))
    by_pairs = set()
    for i, own in enumerate(scene.polygons):
        for j, other in enumerate(scene.polygons[i + 1 :], i + 1):
            pair = as_complex(own), as_complex(other)
            two = detection_of(pair, [i > 0, True], np.zeros((2, 2), dtype=int), 40, scene.detection.size)
            for corners, start in ((slice(0, len(own)), i), (slice(len(own), None), j)):
                two.corners.then[corners] += (0.003 - 0.004j) * (start > 0)
            count = find_contacts(two)
            part = Scene.__new__(Scene)
            part.detection = two
            by_pairs |= {((i, j)[a], b, (i, j)[c], d) for a, b, c, d in part.named(two.contacts, count)}
    assert found == by_pairs
    assert len(found) > 5
    random = np.random.default_rng(1)
    for _ in range(2):  # pressed or not, they move on
        scene.press(*random.uniform(-1.0, 2.0, scene.count))
        scene.polygons[1:] = [at(one, *random.uniform(-4e-3, 4e-3, 2)) for one in scene.polygons[1:]]
        scene.step(random.uniform(-5e-3, 5e-3, 2))
    held("heap", {name: values[: scene.count] for name, values in scene.detection.contacts._asdict().items()})


# least number of convex parts with cuts between corners only
@pytest.mark.parametrize(("outline", "least"), [(SQUARE, 1), (LEDGE, 2), (COMB, 5), (SPIRAL, 3)])
def test_convex_parts_of_an_outline(outline, least):
    size = 1e3
    parts = convex_parts(as_complex(size * outline))
    assert least <= len(parts) <= least + 1
    assert sum(section(size * outline[part]).area for part in parts) == pytest.approx(
        section(size * outline).area, rel=1e-14
    )
    assert min(min(turns_of(as_complex(outline), part)) for part in parts) > 0
    edges = [(part[number - 1], part[number]) for part in parts for number in range(len(part))]
    assert len(set(edges)) == len(edges)
    assert all(edge in edges for edge in zip(range(len(outline)), [*range(1, len(outline)), 0], strict=True))
