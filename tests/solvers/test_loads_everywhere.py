"""Loads in every place and of either sign: upright edges, outlines that begin elsewhere, weight and records alone.

Each expectation is statics, a symmetry or the superposition of a linear model.
"""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.elements import make

import dda
import fem_reference
from dda.bodies.joints import gap_groups
from fem_reference.mesh import elasticity
from fem_reference.mesh.model import assemble

A, P, Q = 2.0, 1e9, 5e6
SQUARE = ((0.0, 0.0), (A, 0.0), (A, A), (0.0, A))


@pytest.mark.parametrize(
    ("side", "e", "foundation"),
    thinned(itertools.product([1, 3], [0.0, 0.3, -0.3], ["block", "sub-blocks", "corner"]), 5),
)
def test_a_side_wall_can_be_loaded(side, e, foundation):
    """A vertical pressure and a horizontal traction on a wall of a rigid block: force, moment over p a^2 / 2.

    The eccentricity of the pressed part runs towards +y on an upright edge, so it moves no vertical force's lever.
    """
    tau, x = 4e5, A / 2 if side == 1 else -A / 2
    moment = -Q * (A - 2 * abs(e)) * x - tau * A * (A / 2)
    if foundation == "corner":
        problem = make(poisson=0.2, elements=2, foundation="corner", top=side)
        stiff = replace(problem, young=1e16, eccentricity=e, traction=tau)
        static = fem_reference.static(stiff)
    else:
        block = dda.Block(SQUARE, dda.Material(2700.0, 1e16, 0.2))
        model = dda.TwoBlockModel(block, dda.Contact(P), Q, top=side, eccentricity=e, traction=tau)
        cut = dda.subdivided(model, 1, 3, 1e20)
        static = dda.static(model) if foundation == "block" else dda.static(cut)
    rotation = moment / (P * A * A / 2)
    assert static["rotation"] == pytest.approx(rotation, rel=2e-6)  # E / p = 1e7 of rigidity
    assert static["displacement"] == pytest.approx(-Q * (A - 2 * abs(e)) / (2 * P), rel=2e-6)
    assert static["horizontal_displacement"] == pytest.approx(tau * A / (2 * P) - A / 2 * rotation, rel=2e-6)


@pytest.mark.parametrize("elements", thinned([1, 2, 3], 5))
@pytest.mark.parametrize("cells", ["quadrilaterals", "triangles"])
@pytest.mark.parametrize("degree", [1, 2])
def test_the_rotation_of_the_middle_is_the_mean_over_the_elements_that_meet_there(elements, cells, degree):
    """With u = -3e-3 y, v = 5e-3 x it turns by 4e-3 whether one, two, four or six elements meet in the middle."""
    assembled = assemble(make(elements=elements, degree=degree, cells=cells))
    x, y = assembled.basis.doflocs
    D = np.where(elasticity.components(assembled.basis) == 0, -3e-3 * y, 5e-3 * x)
    assert assembled.observers["rotation"] @ D == pytest.approx(4e-3, rel=1e-12)


@pytest.mark.parametrize(("off", "met"), [(0.0, True), (3e-10, True), (1e-6, False)])
def test_joints_whose_ends_differ_by_rounding_meet(off, met):
    """Two joints end to end: a shared point makes one group of gaps of it, apart they are two plain joints."""
    material = dda.Material(2700.0, 1e9, 0.0)
    rows = [[[0, 0], [2, 0], [2, 1], [0, 1]], [[0, 1], [1, 1], [1, 2], [0, 2]], [[1, 1], [2, 1], [2, 2], [1, 2]]]
    blocks = [dda.Block(corners, material) for corners in rows]
    joints = [dda.Joint(1, 0, (0, 1), (1, 1), 1e9, 1e9), dda.Joint(2, 0, (1 + off, 1), (2, 1), 1e9, 1e9)]
    assert len(gap_groups(blocks, joints)) == (3 if met else 2)
