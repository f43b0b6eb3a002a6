"""Motions on contacts that are found: the smallest cases that a wrong rule of contact throws off, walls and piles."""

import numpy as np
import pytest
from conftest import thinned
from oracles.plane_scenes import GRAVITY, moved, rectangle

from dda import (
    BaseMotion,
    ContactSprings,
    CornerOnEdge,
    EdgeBond,
    PlaneBlock,
    PlaneLoad,
    PlaneModel,
    Scheme,
    named_scheme,
    solve_plane,
)
from dda.plane import solution

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


def model_of(blocks, springs, weight=True):
    return PlaneModel(blocks, found=springs, gravity=(0.0, -9.81 if weight else 0.0))


def history(model, steps, gg=1.0, every=1, compiled=False):
    """Return a history by the scheme that loses energy in contact, delta = 1."""
    scheme = Scheme(step=1e-3, gg=gg, alpha=0.5, delta=1.0)
    result = solve_plane(model, scheme, steps, every=every, compiled=compiled)
    assert (result.outcome, result.reached) == ("completed", steps)
    return result


def own_energy(result):
    return sum(result.energy[name] for name in ("kinetic", "strain", "springs", "load"))


# of each: polygons before a mirror or not, velocity of the last one; it flies without weight onto the others
THROWN = {
    "diamond beside a corner": ([box(-2, -1, 2, 1)], DIAMOND + np.array([-2e-4, 2.5e-3]), (0.0, -1.0), 12),
    "diamond past a corner": ([box(-2, -1, 2, 1)], DIAMOND + np.array([1e-3, 2e-3]), (0.0, -1.0), 12),
    "square into a ledge": ([LEDGE], box(1.03, 1.03, 0.7, 0.7), (-1.0, -1.0), 45),
    "diamond into a ledge": ([LEDGE], DIAMOND / 2 + np.array([1.4, 1.02]), (-1.0, -1.0), 60),
}


@pytest.mark.parametrize("name", thinned(THROWN, 2))
def test_nothing_is_gained_beside_a_corner(name):
    others, outline, velocity, steps = THROWN[name]
    model = model_of([*map(fixed, others), moving(outline, velocity)], ContactSprings(1e8), weight=False)
    result = history(model, steps)
    energy = own_energy(result)
    assert np.max(result.normal) > 0
    assert np.max(energy) <= energy[0] * (1 + 1e-12)
    assert np.max(np.abs(result.energy["balance"])) < 1e-12 * energy[0]
    turned = history(moved(model, np.diag(MIRROR), 0), steps)
    expected = result.velocity[-1, -1, :3] * (-1, 1, -1)
    assert turned.velocity[-1, -1, :3] == pytest.approx(expected, abs=1e-9)


def pile():
    """Return a hundred polygons above the floor of a box."""
    random = np.random.default_rng(3)
    width = 10
    blocks = [
        fixed(box(-1, -1, 1.3 * width + 2, 1)),
        fixed(box(-1, 0, 1, 3 * width)),
        fixed(box(1.3 * width, 0, 1, 3 * width)),
    ]
    for number in range(100):
        n = random.integers(3, 8)
        angles = 2 * np.pi / n * (np.arange(n) + np.sort(random.uniform(0, 0.8, n)))
        ring = 0.5 * np.column_stack([np.cos(angles), np.sin(angles)])
        place = np.array([0.65 + 1.3 * (number % width), 0.52 + 1.05 * (number // width)])
        blocks.append(moving(ring + place, velocity=tuple(random.normal(0, 0.5, 2)), spin=random.normal()))
    return blocks


@pytest.mark.long
def test_polygons_dropped_in_a_box_keep_their_accounts():
    stiffness = 1e8
    blocks = pile()
    springs = ContactSprings(stiffness, 4e7, friction=0.5)
    result = history(model_of(blocks, springs), 5000, gg=0.999, every=10, compiled=True)
    energy = own_energy(result)
    given = result.energy["kinetic"][0] - np.min(result.energy["load"])
    assert np.max(np.diff(energy)) <= 1e-12 * given
    assert np.max(np.abs(result.energy["balance"])) < 1e-10 * given
    assert len(result.contacts) > 100
    masses = np.array([block.density * block.block.section.area for block in blocks[3:]])
    speed = np.max(np.hypot(*np.moveaxis(result.velocity[..., :2], -1, 0)))
    weight = 9.81 * np.sum(masses)
    deepest = weight / stiffness + speed * np.sqrt(np.max(masses) / stiffness)  # of weight and of impact
    assert np.nanmin(np.where(result.normal > 0, result.gap, 0.0)) > -deepest
    wide = 13.0
    x, y = np.moveaxis(result.centroid[:, 3:], -1, 0)
    assert np.all((x > 0) & (x < wide) & (y > 0))  # nothing is lost
    assert result.energy["kinetic"][-1] < 1e-5 * np.max(result.energy["kinetic"])


def crowd():
    """Return blocks under all that a scene may have: laws by pairs, stated contact, glue, loads, a driven wall."""
    motion = BaseMotion([0.0, 0.008, 0.02, 0.1], [[0.0, 0.0], [-0.01, 0.002], [-0.03, 0.0], [-0.02, -0.004]])
    blocks = [
        fixed(rectangle(-5, -1, 12, 1)),
        PlaneBlock(rectangle(3.004, 0, 1, 2), 2700.0, motion=motion),
        PlaneBlock(rectangle(0, 0.0005, 2, 1), 2500.0, 1e8, 0.2, velocity=(0.5, -0.3), spin=-0.03),
        PlaneBlock(rectangle(2.001, 0, 1, 0.8), 2600.0, velocity=(-0.3, -0.4)),
        PlaneBlock([(0.5, 1.001), (1.6, 1.002), (1.0, 1.8)], 2400.0, 2e8, 0.3, velocity=(-1.0, -0.5)),
        PlaneBlock(rectangle(2.001, 0.8, 1, 0.5), 2300.0, 1e8, 0.1, spin=0.1),
    ]
    rough = ContactSprings(2e8, 1e8, 0.4)
    strong = ContactSprings(3e8, 2e8, 0.2, cohesion=3e3, tension=2e3)
    laws = {(3, 1): None, (1, 0): ContactSprings(1e8), (3, 0): strong, (5, 0): ContactSprings(1e8, 5e7), (5, 1): strong}
    loads = [
        PlaneLoad(2, (3e4, -1e4), edge=((1.5, 1.0005), (0.2, 1.0005)), ramp=0.02),
        PlaneLoad(4, (2e3, 500.0)),
        PlaneLoad(5, (-1e4, 2e4), place=(2.7, 1.2), ramp=0.01),
    ]
    stated = [CornerOnEdge(4, 0, 2, 2, ContactSprings(2e8, 1e8, 0.3, cohesion=2e3, tension=6e3))]
    bonds = [EdgeBond(3, 5, (2.001, 0.8), (3.001, 0.8), 1e9, 5e8)]
    return PlaneModel(
        blocks, stated, bonds, loads, (0.5, -GRAVITY), found=lambda i, j: laws.get((max(i, j), min(i, j)), rough)
    )


@pytest.mark.parametrize(
    ("scheme", "dense"),
    [
        (Scheme(0.3025, 0.6, 0.98, 2e-3, "consistent"), solution.DENSE),
        (named_scheme("composite", step=2e-3, gg=0.99), 0),
    ],
    ids=["few", "many"],
)
def test_a_crowd_of_blocks_keeps_its_accounts_and_moves_as_it_did(scheme, dense, monkeypatch, held):
    monkeypatch.setattr(solution, "DENSE", dense)
    result = solve_plane(crowd(), scheme, 7, every=3, compiled=False)
    assert result.outcome == "completed" and set(result.state.ravel()) == {-2, 0, 1, 2}
    assert np.abs(result.energy["balance"]).max() < 1e-12 * result.energy["kinetic"].max()
    held(f"crowd by {scheme.name}", result)


@pytest.mark.long
def test_a_wall_that_lands_on_stiff_springs_has_states_in_every_step():
    places = [(k + 0.25 * (row % 2), 0.5 * row) for row in range(6) for k in range(6)]
    bricks = [PlaneBlock(rectangle(x, y, 1, 0.5), 2500.0) for x, y in places]
    ground = PlaneBlock(rectangle(-1, -1, 9, 1), 2500.0, fixed=True)
    model = PlaneModel([ground, *bricks], gravity=(0.0, -9.81), found=ContactSprings(1e11, 4e10, 0.5))
    result = solve_plane(model, Scheme(0.25, 0.5, 1.0, 1e-3, "consistent"), 5, compiled=False)
    assert not result.cuts.any()
    assert result.normal[3:].sum(axis=1) == pytest.approx([144193.2498, 1839256.5815, 2977094.9564], rel=1e-7)
