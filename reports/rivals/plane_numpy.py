"""Rival of `dda`'s blocks in the plane: the loop that one writes with numpy, rigid polygons on springs where they meet.

Every corner is held against every edge near it, of each other block against the edge that it is least behind; the
states of all contacts are set at once until none changes, with one dense solve of all blocks each time. Directions are
those of the start of a step, and displacements of corners linear in it.
"""

from collections.abc import Sequence

import numpy as np

MOST_SOLVES = 40
SAME = 1e-9  # m, within which two corners are one


def history(
    outlines: Sequence[np.ndarray],
    held: Sequence[bool],
    steps: int,
    dt: float,
    p: float,
    shear: float,
    friction: float,
    velocity: np.ndarray | None = None,
    gg: float = 1.0,
    density: float = 2500.0,
    gravity: float = 9.81,
    reach: float = 0.05,
) -> np.ndarray:
    """Return the displacement of every centroid at the last step [m], by constant acceleration.

    Parameters
    ----------
    outlines
        Corners of each block at t = 0, counter-clockwise [m].
    held
        Which of them do not move.
    velocity
        At t = 0 of each: of its centroid and its spin, (b, 3).
    gg
        Discount of the velocity in each step.
    reach
        Distance within which a corner is looked at [m].
    """
    b = len(outlines)
    shapes = [polygon(outline) for outline in outlines]
    centroid = np.array([shape[1] for shape in shapes])
    mass = density * np.array([[area, area, inertia] for area, _, inertia in shapes])
    block = np.repeat(np.arange(b), [len(outline) for outline in outlines])
    first = np.cumsum([0, *(len(outline) for outline in outlines)])
    follows = np.arange(len(block)) + 1
    follows[first[1:] - 1] = first[:-1]
    arms = np.vstack(outlines) - centroid[block]
    free = ~np.repeat(np.array(held), 3)
    q = np.zeros((b, 3))
    v = np.zeros((b, 3)) if velocity is None else np.array(velocity)
    weight = mass * np.array([0.0, -gravity, 0.0])
    stretch: dict[tuple[int, int], tuple[bool, float]] = {}
    for _ in range(steps):
        v = gg * v
        cos, sin = np.cos(q[block, 2]), np.sin(q[block, 2])
        turned = np.column_stack([cos * arms[:, 0] - sin * arms[:, 1], sin * arms[:, 0] + cos * arms[:, 1]])
        corners = centroid[block] + q[block, :2] + turned
        pairs = near(corners, block, follows, held, reach)
        i, j = block[pairs[:, 0]], block[pairs[:, 1]]
        a = corners[pairs[:, 1]]
        along = corners[follows[pairs[:, 1]]] - a
        along /= np.hypot(*along.T)[:, None]
        normal = np.column_stack([along[:, 1], -along[:, 0]])
        tangent = np.column_stack([normal[:, 1], -normal[:, 0]])
        gap = np.sum((corners[pairs[:, 0]] - a) * normal, axis=1)
        n = len(pairs)
        rows = np.zeros((2 * n, 3 * b))
        place = corners[pairs[:, 0]]
        for number, direction in ((0, normal), (n, tangent)):
            for sign, body in ((1.0, i), (-1.0, j)):
                arm = place - centroid[body] - q[body, :2]
                turn = arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]
                for axis, part in enumerate((direction[:, 0], direction[:, 1], turn)):
                    rows[number + np.arange(n), 3 * body + axis] = sign * part
        keys = [tuple(pair) for pair in pairs.tolist()]
        old = [stretch.get(key, (False, 0.0)) for key in keys]
        closed = np.array([state for state, _ in old], dtype=bool)
        start = np.array([way for _, way in old])
        slips = np.zeros(n)
        for _ in range(MOST_SOLVES):
            push = np.zeros((2 * n, 3 * b))  # what forces lose with the blocks' displacements
            constant = np.zeros(2 * n)
            on, stuck = np.flatnonzero(closed), np.flatnonzero(closed & (slips == 0))
            sliding = np.flatnonzero(closed & (slips != 0))
            push[on] = p * rows[on]
            push[n + stuck] = shear * rows[n + stuck]
            push[n + sliding] = slips[sliding, None] * friction * p * rows[sliding]
            constant[on] = -p * gap[on]
            constant[n + stuck] = -shear * start[stuck]
            constant[n + sliding] = -slips[sliding] * friction * p * gap[sliding]
            K = np.diag(2 * mass.ravel() / dt**2) + rows.T @ push
            right = weight.ravel() + 2 * (mass * v).ravel() / dt + rows.T @ constant
            D = np.zeros(3 * b)
            D[free] = np.linalg.solve(K[np.ix_(free, free)], right[free])
            ways = rows @ D
            force = constant - push @ D
            now = gap + ways[:n] < 0
            limit = friction * np.maximum(force[:n], 0.0)
            way = np.where(closed & (slips == 0) & (np.abs(force[n:]) > limit * (1 + 1e-9)), np.sign(force[n:]), slips)
            way = np.where(closed & (slips * ways[n:] > 0), 0.0, way)
            way = np.where(now & closed, way, 0.0)
            if np.array_equal(now, closed) and np.array_equal(way, slips):
                break
            closed, slips = now, way
        kept = np.where(slips == 0, start + ways[n:], -force[n:] / shear)
        stretch = {key: (True, kept[k]) for k, key in enumerate(keys) if closed[k]}
        change = D.reshape(b, 3)
        q = q + change
        v = np.where(free.reshape(b, 3), 2 * change / dt - v, 0.0)
    return q[:, :2]


def polygon(outline: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Return area, centroid and second polar moment about it."""
    origin = np.mean(outline, axis=0)
    a = outline - origin
    c = np.roll(a, -1, axis=0)
    cross = a[:, 0] * c[:, 1] - c[:, 0] * a[:, 1]
    area = np.sum(cross) / 2
    centre = cross @ (a + c) / (6 * area)
    moment = np.sum(cross * np.sum(a * a + a * c + c * c, axis=1)) / 12
    return area, origin + centre, moment - area * centre @ centre


def near(corners: np.ndarray, block: np.ndarray, follows: np.ndarray, held: Sequence[bool], reach: float) -> np.ndarray:
    """Return corners and edges that may touch, (n, 2): of each corner in each other block the edge least behind."""
    along = corners[follows] - corners
    length = np.hypot(*along.T)
    along = along / length[:, None]
    to = corners[:, None] - corners[None]
    gaps = to[..., 0] * along[:, 1] - to[..., 1] * along[:, 0]
    feet = np.sum(to * along, axis=2)
    fixed = np.asarray(held)[block]
    apart = (block[:, None] != block[None]) & ~(fixed[:, None] & fixed[None])
    inside = (feet > SAME) & (feet < length - SAME)
    # of corners that coincide that of the block behind is taken
    inside |= (np.abs(feet) <= SAME) | (np.abs(feet - length) <= SAME) & (block[:, None] > block[None])
    good = apart & inside & (np.abs(gaps) < reach)
    found: dict[tuple[int, int], tuple[float, int]] = {}
    for corner, edge in np.argwhere(good).tolist():
        key = corner, int(block[edge])
        best = found.get(key)
        if best is None or abs(gaps[corner, edge]) < best[0]:
            found[key] = (abs(gaps[corner, edge]), edge)
    return np.array([(corner, edge) for (corner, _), (_, edge) in found.items()], dtype=int).reshape(-1, 2)
