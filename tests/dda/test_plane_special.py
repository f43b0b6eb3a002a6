"""One model by two bodies: a block in the plane that does not turn, or hardly strains, is the block on a base."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.contact_bodies import random_rolling, with_law

from dda import (
    Block,
    ContactSprings,
    CornerOnEdge,
    Material,
    PlaneBlock,
    PlaneLoad,
    PlaneModel,
    Scheme,
    Unilateral,
    UnilateralModel,
    named_scheme,
    solve_plane,
    solve_unilateral,
)
from dda.bodies.turning_body import turned

WIDTH, HEIGHT = 2.0, 1.5
CONSTANT, DISCOUNTED = Scheme(0.5, 1.0, 1.0, 1e-3), Scheme(0.5, 1.0, 0.98, 1e-3)
AVERAGE = Scheme(0.25, 0.5, 1.0, 3e-4, "consistent")
STIFF = {"stiffness": 1e11, "shear": 1e9, "friction": 0.5}
CASES = [  # each opens or closes but the first two, which are pressed
    (CONSTANT, 200, {"pressure": 5e6}),
    (DISCOUNTED, 200, {"pressure": 5e6, "poisson": 0.2, "shear": 4e8}),
    (AVERAGE, 200, {"gap": 0.01, "gravity": 9.81}),
    (AVERAGE, 60, {"velocity": -1.0, "poisson": 0.3, "shear": 1e9, "friction": 0.5}),
    (Scheme(0.5, 1.0, 1.0, 3e-4), 300, {"gap": 0.01, "velocity": -1.0, "gravity": 9.81, "poisson": 0.3} | STIFF),
    (
        named_scheme("chung-hulbert", step=3e-4, gg=1.0, rho_inf=0.5),
        200,
        {"gap": 0.01, "velocity": -1.0, "poisson": 0.3},
    ),
]


@pytest.mark.parametrize(("scheme", "steps", "data"), CASES)
def test_a_block_that_does_not_turn_is_the_block_on_a_base(scheme, steps, data):
    values = {"poisson": 0.0, "stiffness": 1e9, "shear": 0.0, "friction": None, "gap": 0.0} | data
    poisson, p, shear, friction, gap = (values[key] for key in ("poisson", "stiffness", "shear", "friction", "gap"))
    pressure, gravity, velocity = (data.get(key, 0.0) for key in ("pressure", "gravity", "velocity"))
    block = Block.rectangle(WIDTH, HEIGHT, Material(2700.0, 1e9, poisson))
    law = Unilateral(p, shear, gap=gap, friction=friction)
    special = solve_unilateral(UnilateralModel(block, law, pressure, gravity=gravity, velocity=velocity), scheme, steps)

    corners = block.corners + np.array([0.0, gap])
    floor = PlaneBlock([(-5, -1), (9, -1), (9, 0), (-5, 0)], 2700.0, fixed=True)
    moving = PlaneBlock(corners, 2700.0, 1e9, poisson, velocity=(0.0, velocity))
    springs = ContactSprings(p, shear, friction)
    stated = [CornerOnEdge(1, corner, 0, 2, springs) for corner in (0, 1)]
    load = PlaneLoad(1, (0.0, -pressure), edge=(tuple(corners[2]), tuple(corners[3])))
    model = PlaneModel([floor, moving], stated, loads=[load], gravity=(0.0, -gravity))
    plane = solve_plane(model, scheme, steps, compiled=False)

    assert special.outcome == plane.outcome == "completed"
    way = special.columns["displacement"]
    assert np.max(np.abs(plane.centroid[1:, 1, 1] - plane.centroid[0, 1, 1] - way)) < 1e-12 * np.max(np.abs(way))
    largest = np.max(special.normal)
    for values_of, in_plane in ((special.normal, plane.normal), (special.shear, plane.shear)):
        assert np.max(np.abs(in_plane[1:] - np.transpose(values_of))) < 1e-12 * largest


TURNING = [CONSTANT, Scheme(0.25, 0.5, 0.99, 2e-3), named_scheme("composite", step=2e-3, gg=1.0)]


@pytest.mark.parametrize("scheme", TURNING, ids=["constant", "average", "composite"])
@pytest.mark.parametrize("seed", [1, 2, 8, 9])
def test_a_stiff_block_that_turns_over_a_base_is_the_one_in_the_plane(seed, scheme):
    given, _ = random_rolling(seed)
    block = Block(given.block.corners, replace(given.block.material, young=1e15))
    model = with_law(replace(given, block=block), gap=given.contact.gap / 100)
    special = solve_unilateral(model, scheme, 150)

    centre, turn = special.motion.c[0], turned(model.tilt)
    outline = centre + model.body.xi @ turn.T
    rock, law = model.block.material, model.contact
    velocity = tuple(model.body.to_base @ model.velocity)
    moving = PlaneBlock(outline, rock.density, rock.young, rock.poisson, velocity=velocity, spin=model.spin)
    floor = PlaneBlock([(-200, -1), (200, -1), (200, 0), (-200, 0)], 1.0, fixed=True)
    springs = ContactSprings(law.stiffness, law.shear, law.friction, law.cohesion)
    stated = [CornerOnEdge(1, corner, 0, 2, springs) for corner in range(len(outline))]
    loads = [
        PlaneLoad(1, tuple(force), place=tuple(centre + turn @ place)) for place, force in zip(*model.dead, strict=True)
    ]
    plane = solve_plane(PlaneModel([floor, moving], stated, loads=loads, gravity=tuple(model.weight)), scheme, 150)

    assert special.outcome == plane.outcome == "completed" and np.any(special.normal > 0)
    # Masses and levers of the plane are those of the strained outline: a frequency w is off by that strain, and after a
    # time T the motion by w T of it. The fastest is rocking on the springs of two corners, w^2 <= 6 k/m of a rectangle.
    turns = np.sqrt(6 * law.stiffness / model.block.total_mass) * 150 * scheme.step
    share = turns * np.max(np.abs(plane.strain))
    assert share < 1e-6
    assert np.max(np.abs(plane.centroid[:, 1] - special.motion.c)) < share
    assert np.max(np.abs(plane.angle[:, 1] - special.motion.r)) < share
    for of_plane, own in ((plane.normal, special.normal), (plane.shear, special.shear)):
        assert np.max(np.abs(of_plane[1:] - own.T)) < share * np.max(special.normal)
