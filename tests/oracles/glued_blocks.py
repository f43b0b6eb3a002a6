"""Blocks on springs at points, assembled in the unknowns of the blocks."""

import numpy as np


def glued(blocks, springs):
    """Return M and K of blocks on springs at points, (first, second or None, point, normal, shear) on level edges.

    Shear is along x and normal along y; of an upright edge the two are exchanged.
    """
    size = 6 * len(blocks)
    M, K = np.zeros((2, size, size))
    for i, block in enumerate(blocks):
        part = slice(6 * i, 6 * i + 6)
        M[part, part] = block.mass()
        K[part, part] = block.elastic()
    for first, second, point, normal, shear in springs:
        gap = np.zeros((2, size))
        gap[:, 6 * first : 6 * first + 6] = blocks[first].T(*point)
        if second is not None:
            gap[:, 6 * second : 6 * second + 6] = -blocks[second].T(*point)
        K += gap.T @ np.diag([shear, normal]) @ gap
    return M, K
