"""Motions on contacts that are found: the smallest cases that a wrong rule of contact throws off, walls and piles."""

import numpy as np
import pytest

from dda import ContactSprings, PlaneBlock, PlaneModel, Scheme, solve_plane

DENSITY = 2500.0
SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
DIAMOND = np.sqrt(2) * np.array([(0.0, 0.0), (0.5, 0.5), (0.0, 1.0), (-0.5, 0.5)])
LEDGE = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)])  # an L
MIRROR = np.array([-1.0, 1.0])


def box(x, y, width=1.0, height=1.0):
    return SQUARE * np.array([width, height]) + np.array([x, y])


def fixed(vertices):
    return PlaneBlock(vertices, DENSITY, fixed=True)


def moving(vertices, velocity=(0.0, 0.0), spin=0.0):
    return PlaneBlock(vertices, DENSITY, velocity=velocity, spin=spin)


def mirrored(block):
    """Return a block behind a mirror in x = 0."""
    vertices = (np.array(block.vertices) * MIRROR)[::-1]
    velocity = (-block.velocity[0], block.velocity[1])
    return PlaneBlock(vertices, DENSITY, fixed=block.fixed, velocity=velocity, spin=-block.spin)


def history(blocks, springs, steps, weight=True, step=1e-3):
    """Return a history by the scheme that loses energy in contact, delta = 1."""
    model = PlaneModel(blocks, found=springs, gravity=(0.0, -9.81 if weight else 0.0))
    result = solve_plane(model, Scheme(step=step, gg=1.0, alpha=0.5, delta=1.0), steps, compiled=False)
    assert (result.outcome, result.reached) == ("completed", steps)
    return result


def own_energy(result):
    return sum(result.energy[name] for name in ("kinetic", "strain", "springs", "load"))


# of each: polygons before a mirror or not, velocity of the last one; it flies without weight onto the others
THROWN = {
    "diamond beside a corner": ([box(-2, -1, 2, 1)], DIAMOND + np.array([-2e-4, 2.5e-3]), (0.0, -1.0), 12),
    "diamond past a corner": ([box(-2, -1, 2, 1)], DIAMOND + np.array([1e-3, 2e-3]), (0.0, -1.0), 12),
    "square into a ledge": ([LEDGE], box(1.1, 1.1, 0.7, 0.7), (-1.0, -1.0), 115),
    "diamond into a ledge": ([LEDGE], DIAMOND / 2 + np.array([1.4, 1.02]), (-1.0, -1.0), 60),
}


@pytest.mark.parametrize("name", THROWN)
def test_nothing_is_gained_beside_a_corner(name):
    others, outline, velocity, steps = THROWN[name]
    blocks = [*map(fixed, others), moving(outline, velocity)]
    result = history(blocks, ContactSprings(1e8), steps, weight=False)
    energy = own_energy(result)
    assert np.max(result.normal) > 0
    assert np.max(energy) <= energy[0] * (1 + 1e-12)
    assert np.max(np.abs(result.energy["balance"])) < 1e-12 * energy[0]
    turned = history([mirrored(block) for block in blocks], ContactSprings(1e8), steps, weight=False)
    expected = result.velocity[-1, -1, :3] * (-1, 1, -1)
    assert turned.velocity[-1, -1, :3] == pytest.approx(expected, abs=1e-9)


# the block is pressed W/p deep, and set down with twice that; each new corner starts so deep: within 2 (W/p)^2 p / m v
@pytest.mark.parametrize("stiffness", [1e8, 1e7])
def test_a_block_slides_over_a_flush_seam(stiffness):
    floors = [fixed(box(-2, -1, 2, 1)), fixed(box(0, -1, 2, 1))]
    result = history([*floors, moving(box(-1.05, 0), (2.0, 0.0))], ContactSprings(stiffness), 100)
    assert {contact.on for contact in result.contacts} >= {0, 1}
    deepest = 2 * DENSITY * 9.81 / stiffness
    assert np.max(np.abs(result.velocity[:, 2, 0] - 2.0)) < 2 * stiffness * deepest**2 / DENSITY / 2.0
    assert result.displacement[-1, 2, 0] == pytest.approx(0.2, abs=1e-3)


def test_a_wall_without_gaps_stands():
    rows = 3
    bricks = [fixed(box(-1, -1, 6, 1))]
    for row in range(rows):
        bricks += [moving(box(column + 0.5 * (row % 2), row)) for column in range(3)]
    springs = ContactSprings(1e8, 4e7, friction=0.6)
    result = history(bricks, springs, 60)
    weight = rows * DENSITY * 9.81
    assert np.max(np.abs(result.displacement)) < 4 * rows * weight / 1e8  # each joint under all that lies on it, twice
    assert np.median(result.solves[2:]) <= 4  # one in each of two to four rounds
    assert np.sum(result.cuts) == 0


def pile(count, seed):
    """Return polygons above the floor of a box."""
    random = np.random.default_rng(seed)
    width = int(np.ceil(np.sqrt(count)))
    blocks = [
        fixed(box(-1, -1, 1.3 * width + 2, 1)),
        fixed(box(-1, 0, 1, 3 * width)),
        fixed(box(1.3 * width, 0, 1, 3 * width)),
    ]
    for number in range(count):
        n = random.integers(3, 8)
        angles = 2 * np.pi / n * (np.arange(n) + np.sort(random.uniform(0, 0.8, n)))
        ring = 0.5 * np.column_stack([np.cos(angles), np.sin(angles)])
        place = np.array([0.65 + 1.3 * (number % width), 0.52 + 1.05 * (number // width)])
        blocks.append(moving(ring + place, velocity=tuple(random.normal(0, 0.5, 2)), spin=random.normal()))
    return blocks


@pytest.mark.parametrize(
    ("count", "steps"), [(5, 250), pytest.param(12, 800, marks=pytest.mark.long)], ids=["few", "many"]
)
def test_polygons_dropped_in_a_box_keep_their_accounts(count, steps):
    stiffness = 1e8
    result = history(pile(count, 3), ContactSprings(stiffness, 4e7, friction=0.5), steps)
    energy = own_energy(result)
    given = result.energy["kinetic"][0] + DENSITY * 9.81 * count * 2 * np.sqrt(count)  # weight over the box's height
    assert np.max(energy) <= energy[0] + 1e-3 * given
    assert np.max(np.abs(result.energy["balance"])) < 1e-10 * given
    assert len(result.contacts) > count
    speed = np.max(np.abs(result.velocity[..., :2]))
    mass = DENSITY * 0.5**2 * np.pi
    deepest = 2 * count * mass * 9.81 / stiffness + 2 * speed * np.sqrt(mass / stiffness)  # of weight and of impact
    assert np.nanmin(np.where(result.normal > 0, result.gap, 0.0)) > -deepest
    assert np.all(result.centroid[:, 3:, 1] > 0)


def test_a_mirrored_and_shifted_pile_is_the_same_before_chaos():
    springs = ContactSprings(1e8, 4e7, friction=0.5)
    blocks = pile(4, 5)
    result = history(blocks, springs, 120)
    behind = history([mirrored(block) for block in blocks], springs, 120)
    shift = np.array([8.0, -4.0])
    away = [
        PlaneBlock(block.vertices + shift, DENSITY, fixed=block.fixed, velocity=block.velocity, spin=block.spin)
        for block in blocks
    ]
    shifted = history(away, springs, 120)
    assert len(result.contacts) > 1
    assert behind.displacement * MIRROR == pytest.approx(result.displacement, abs=1e-9)
    assert shifted.displacement == pytest.approx(result.displacement, abs=1e-9)


def test_two_free_blocks_keep_their_momentum():
    blocks = [moving(box(0, 0)), moving(DIAMOND + np.array([0.3, 1.01]), (0.2, -1.0), 0.5)]
    result = history(blocks, ContactSprings(1e8, 4e7, friction=0.3), 60, weight=False)
    scale = DENSITY * 1.0
    assert np.max(result.normal) > 0
    assert np.max(np.abs(result.momentum - result.momentum[0])) < 1e-9 * scale
