"""Rigid polygons by other programs: parts, mass and inertia, what is refused, and the shape of an answer."""

import numpy as np
import pytest
from peers import box2d, mujoco, pymunk
from peers.bodies import bodies_of, friction_between

from validation.models.plane.blocks import centroid, second_moments
from validation.models.plane.tables import PlaneSection
from validation.scenes.outline import area
from validation.scenes.scene import load_scene


@pytest.mark.parametrize("name", ["wedges", "columns", "touch-pentagon"])
def test_bodies_have_the_mass_the_inertia_and_the_outline_of_their_blocks(name):
    scene = load_scene(f"rigid-{name}")
    for body, block in zip(bodies_of(scene), scene.table(PlaneSection).assembly.blocks, strict=True):
        assert body.mass == pytest.approx(block.density * area(block.vertices))
        assert body.inertia == pytest.approx(block.density * np.trace(second_moments(block.vertices)))
        turn = np.array([[np.cos(body.angle), np.sin(body.angle)], [-np.sin(body.angle), np.cos(body.angle)]])
        assert body.corners @ turn + body.place == pytest.approx(np.array(block.vertices))
        assert sum(area(tuple(part)) for part in body.parts) == pytest.approx(area(block.vertices))
        middles = [np.array(centroid(tuple(part))) * area(tuple(part)) for part in body.parts]
        assert sum(middles) == pytest.approx(np.zeros(2), abs=1e-9 * area(block.vertices))
        assert all(np.all(turned(part) >= 0) for part in body.parts)


def turned(part):
    """Return by how much an outline turns at each corner: nowhere inwards where it is convex."""
    along = np.roll(part, -1, axis=0) - part
    following = np.roll(along, -1, axis=0)
    return along[:, 0] * following[:, 1] - along[:, 1] * following[:, 0]


def test_friction_is_that_of_the_pair():
    scene = load_scene("rigid-pushing")
    pairs = [friction_between(scene, *pair) for pair in ((0, 1), (0, 2), (1, 2))]
    assert pairs == pytest.approx([np.tan(np.radians(15)), np.tan(np.radians(25)), 0.0])


@pytest.mark.parametrize("name", ["spinning", "truss"])
@pytest.mark.parametrize("solver", [pymunk.Pymunk, box2d.Box2D, mujoco.MuJoCo])
def test_what_is_no_rigid_polygon_is_refused(solver, name):
    with pytest.raises(NotImplementedError, match=r"touch|young|friction"):
        solver().solve(load_scene(f"rigid-{name}"))
