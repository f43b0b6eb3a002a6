"""Models of blocks in the plane that several tests step."""

import math

import numpy as np

from dda import ContactSprings, CornerOnEdge, PlaneBlock, PlaneModel, Scheme, named_scheme

GRAVITY = 9.81
AVERAGE = (0.25, 0.5, 1.0)
CONSTANT = (0.5, 1.0, 1.0)


def scheme(numbers, step):
    return Scheme(*numbers, step, "consistent")


SCHEMES = {
    "average": scheme(AVERAGE, 1e-3),
    "constant": scheme(CONSTANT, 1e-3),
    "chung-hulbert": named_scheme("chung-hulbert", step=1e-3, rho_inf=0.8),
    "composite": named_scheme("composite", step=1e-3),
    "leapfrog": named_scheme("leapfrog", step=1e-3),
}


def rectangle(x, y, width, height):
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)], dtype=float)


def floor(length=60.0):
    return PlaneBlock(rectangle(-length / 3, -1.0, length, 1.0), 2700.0, fixed=True, name="floor")


def slope(upper_friction, lower_friction, stiffness=1e9):
    """Two blocks side by side on a slope, in axes along it and away from it; the upper one pushes the lower."""
    angle = math.radians(25)
    corners = []
    for block, friction in ((1, upper_friction), (2, lower_friction)):
        springs = ContactSprings(stiffness, stiffness, friction)
        corners += [CornerOnEdge(block, corner, 0, 2, springs) for corner in (0, 1)]
    corners += [CornerOnEdge(1, corner, 2, 3, ContactSprings(stiffness)) for corner in (1, 2)]
    blocks = [floor(), PlaneBlock(rectangle(0, 0, 2, 1), 2700.0), PlaneBlock(rectangle(2, 0, 2, 1), 2700.0)]
    return PlaneModel(blocks, corners, gravity=(GRAVITY * math.sin(angle), -GRAVITY * math.cos(angle)))


def moved(model, frame, shift):
    """Return a model in other axes, turned or mirrored by a matrix and shifted."""
    flips = np.linalg.det(frame) < 0
    blocks = []
    for block in model.blocks:
        vertices = np.asarray(block.vertices) @ frame.T + shift
        blocks.append(
            PlaneBlock(
                vertices[::-1] if flips else vertices,
                block.density,
                block.young,
                block.poisson,
                fixed=block.fixed,
                velocity=tuple(frame @ block.velocity),
                spin=-block.spin if flips else block.spin,
            )
        )
    contacts = []
    for contact in model.contacts:
        corner = contact.corner
        edge = contact.edge
        if flips:
            corner = len(model.blocks[contact.block].vertices) - 1 - corner
            edge = (len(model.blocks[contact.on].vertices) - 2 - edge) % len(model.blocks[contact.on].vertices)
        contacts.append(CornerOnEdge(contact.block, corner, contact.on, edge, contact.springs))
    return PlaneModel(blocks, contacts, gravity=tuple(frame @ model.gravity), found=model.found)
