"""One model by two bodies: a block in the plane that does not turn is the block on a base."""

import numpy as np
import pytest
from conftest import thinned

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

WIDTH, HEIGHT = 2.0, 1.5
CONSTANT, DISCOUNTED = Scheme(0.5, 1.0, 1.0, 1e-3), Scheme(0.5, 1.0, 0.98, 1e-3)
AVERAGE = Scheme(0.25, 0.5, 1.0, 3e-4, "consistent")
STIFF = {"stiffness": 1e11, "shear": 1e9, "friction": 0.5}
CASES = [  # each opens or closes but the first two, which are pressed
    (CONSTANT, 60, {"pressure": 5e6, "poisson": 0.1}),
    (DISCOUNTED, 200, {"pressure": 5e6, "poisson": 0.2, "shear": 4e8}),
    (AVERAGE, 200, {"gap": 0.01, "gravity": 9.81}),
    (AVERAGE, 60, {"velocity": -1.0, "poisson": 0.3, "shear": 1e9, "friction": 0.5}),
    (Scheme(0.5, 1.0, 1.0, 3e-4), 300, {"gap": 0.01, "velocity": -1.0, "gravity": 9.81, "poisson": 0.3} | STIFF),
    (
        named_scheme("chung-hulbert", step=3e-4, gg=1.0, rho_inf=0.5),
        100,
        {"gap": 0.01, "velocity": -1.0, "poisson": 0.3},
    ),
]


@pytest.mark.parametrize(("scheme", "steps", "data"), thinned(CASES[::-1], 6))
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
