"""Elements of one strain on springs at points and glued blocks: two codes, one model, the same steps."""

import numpy as np
import pytest
from skfem import MeshTri

import dda
import fem_reference
from dda.bodies.glued_blocks import GluedBlocks, Traction, glued_blocks
from dda.model.block import Block
from fem_reference import PatchContact, PlaneBody, PlaneModel

GLUE, WEIGHT, RIGHT = 1e11, (0.0, -9.81), ((2.0, 0.0), (2.0, 1.0))
CORNERS = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0))
MIDDLE = (1.1, 0.45)
TRIANGLES = [(CORNERS[i], CORNERS[(i + 1) % 4], MIDDLE) for i in range(4)]
PUSH = (1e6, -2e5)


def elements():
    """A triangle each, glued at both ends of the sides that they share, the left one to the base."""
    bodies = []
    contacts = []
    for number, triangle in enumerate(TRIANGLES):
        mesh = MeshTri(np.array(triangle).T, np.array([[0, 1, 2]]).T)
        loads = ((RIGHT, PUSH),) if number == 1 else ()
        bodies.append(PlaneBody((), 2700.0, 1e9, 0.25, gravity=WEIGHT, tractions=loads, degree=1, mesh=mesh))
        corner = np.array(triangle[1])
        along = (np.array(MIDDLE) - corner) / np.hypot(*(np.array(MIDDLE) - corner))
        for place in triangle[1:]:
            normal = (-along[1], along[0])
            contacts.append(PatchContact(number, (number + 1) % 4, place, place, normal, GLUE, GLUE, bonded=True))
    for place in TRIANGLES[3][:2]:
        contacts.append(PatchContact(3, None, place, place, (1.0, 0.0), GLUE, GLUE, bonded=True))
    return PlaneModel(bodies, contacts)


@pytest.mark.parametrize(("alpha", "delta", "gg"), [(0.5, 1.0, 1.0), (0.25, 0.5, 0.99)])
def test_linear_triangles_on_points_are_glued_blocks(alpha, delta, gg):
    material = dda.Material(density=2700.0, young=1e9, poisson=0.25)
    blocks = [Block(np.array(triangle), material) for triangle in TRIANGLES]
    loads = [Traction(*RIGHT, PUSH)]
    glued = GluedBlocks(glued_blocks(blocks, GLUE, [(CORNERS[0], CORNERS[3])], tractions=loads, gravity=WEIGHT))
    model = elements()
    strains = np.vstack([model.means(body)[3:] for body in range(4)]) @ model.rest
    assert strains == pytest.approx(glued.strains.ravel(), rel=1e-11)
    numbers = (alpha, delta, gg, 1e-4)
    steps = glued.history(dda.Scheme(*numbers), 500, glued.observer(*RIGHT)).columns
    found = model.history(fem_reference.Scheme(*numbers), 500, model.observer(*RIGHT, 1)).columns
    for name, values in steps.items():
        assert np.abs(found[name] - values).max() < 1e-13 * np.abs(values).max()
    theirs = [mode.frequency for mode in glued.modes(dda.Scheme(*numbers), 4)]
    assert [mode.frequency for mode in model.modes(fem_reference.Scheme(*numbers), 4)] == pytest.approx(
        theirs, rel=1e-11
    )
