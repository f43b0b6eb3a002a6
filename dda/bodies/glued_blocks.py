"""Blocks that are glued along the edges they share: loads on their outline, strains at rest, natural frequencies.

At rest a system that nothing holds is determined but for a rigid motion R c of the whole. With the condition
R' M D = 0 the equations of statics

    Ke D + B' lambda + M R mu = F,     B D - C lambda = 0,     R' M D = 0

have one solution; mu = (R' M R)^-1 R' F is the acceleration that a load without balance would give, and must be zero.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from time import perf_counter

import numpy as np

from dda.bodies.block_system import BlockSystem, Equations, SurfaceLoad
from dda.bodies.joints import FIXED, Joint, Point, common_part, shared_edges
from dda.bodies.locked_system import stepped
from dda.linear.answers import Mode, modes_of
from dda.model.arrays import Array
from dda.model.block import Block
from dda.model.checks import check_count
from dda.result.result import Result
from dda.scheme.newmark import Scheme

UNBALANCED = 1e-9  # of the sum of the loads' sizes: what rounding leaves of a balanced load
SAME_LINE = 1e-9  # of the extent: how far a point may lie beside a line
Piece = tuple[int, Point, Point]  # of the outline, with its block


@dataclass(frozen=True)
class Traction:
    """A uniform traction on what lies of the outline on a straight line from start to end."""

    start: Point  # [m]
    end: Point  # [m]
    traction: tuple[float, float]  # in x and y [Pa]


def glued_blocks(
    blocks: Sequence[Block],
    glue: float,
    clamps: Sequence[tuple[Point, Point]] = (),
    clamp_glue: float | None = None,
    tractions: Sequence[Traction] = (),
    stress: tuple[float, float, float] = (0.0, 0.0, 0.0),
    gravity: tuple[float, float] = (0.0, 0.0),
) -> BlockSystem:
    """Return blocks glued along all edges they share, under loads on their outline.

    Parameters
    ----------
    glue : float
        Stiffness of the normal and of the shear spring at each end of a shared edge [N/m].
    clamps : sequence of two points
        Lines on which edges are glued to what is fixed.
    clamp_glue : float, optional
        Stiffness of the springs there, without it that of the glue [N/m].
    stress : tuple of float
        s_xx, s_yy, s_xy, whose tractions s n act on all of the outline that is not clamped [Pa].
    gravity : tuple of float
        Acceleration in x and y [m/s^2].

    Raises
    ------
    ValueError
        If a clamp or a traction lies on no edge of the outline, or a stiffness is out of range.
    """
    stiffness = glue if clamp_glue is None else clamp_glue
    joints = shared_edges(blocks, glue, glue)
    outline = [*_outline(blocks, joints)]
    held = []
    for clamp in clamps:
        pieces = _on_line(outline, *clamp, "clamp")
        held += pieces
        joints += [Joint(block, FIXED, start, end, stiffness, stiffness) for block, start, end in pieces]
    loads = []
    for load in tractions:
        pieces = _on_line(outline, load.start, load.end, "load")
        loads += [SurfaceLoad(block, start, end, load.traction) for block, start, end in pieces]
    if any(stress):
        for block, start, end in outline:
            if (block, start, end) not in held:
                loads.append(SurfaceLoad(block, start, end, _traction_of(stress, start, end)))
    return BlockSystem(list(blocks), joints, loads=loads, gravity=gravity)


def _traction_of(stress: tuple[float, float, float], start: Point, end: Point) -> tuple[float, float]:
    """Return s n on an edge whose block lies at its left."""
    along = np.subtract(end, start)
    normal = np.array([along[1], -along[0]]) / np.hypot(*along)
    s_xx, s_yy, s_xy = stress
    x, y = np.array([[s_xx, s_xy], [s_xy, s_yy]]) @ normal
    return float(x), float(y)


def _outline(blocks: Sequence[Block], joints: Sequence[Joint]) -> Iterator[Piece]:
    """Yield the pieces of the blocks' edges that no joint lies on, each with its block at the left."""
    joined: dict[int, list[tuple[Point, Point]]] = {}
    for joint in joints:
        for body in (joint.first, joint.second):
            joined.setdefault(body, []).append((joint.start, joint.end))
    slack = SAME_LINE * np.max(np.ptp(np.vstack([block.corners for block in blocks]), axis=0))
    for number, block in enumerate(blocks):
        for index in range(len(block.corners)):
            start, end = (tuple(corner.tolist()) for corner in block.edge(index))
            parts = [common_part((start, end), piece, slack) for piece in joined.get(number, [])]
            covered = sorted((part for part in parts if part), key=lambda part: math.dist(part[0], start))
            place = start
            for low, high in [*covered, (end, place)]:
                if math.dist(low, start) - math.dist(place, start) > slack:
                    yield number, place, low
                place = max(place, high, key=lambda p: math.dist(p, start))


def _on_line(outline: Sequence[Piece], start: Point, end: Point, what: str) -> list[Piece]:
    """Return what lies of the outline between two points of a line."""
    length = math.dist(start, end)
    if not length > 0:
        raise ValueError(f"{what}: must have two ends, got {start!r} and {end!r}")
    parts = [(block, common_part((low, high), (start, end), SAME_LINE * length)) for block, low, high in outline]
    pieces = [(block, *part) for block, part in parts if part is not None]
    if not pieces:
        raise ValueError(f"{what}: must lie on the outline, got {start!r} to {end!r}")
    return pieces


class GluedBlocks:
    """What blocks that `glued_blocks` returns answer: at rest, by modes, step by step."""

    def __init__(self, system: BlockSystem) -> None:
        self.system = system
        self.held = any(FIXED in (joint.first, joint.second) for joint in system.joints)
        self.statics = system.equations if self.held else _without_rigid_motion(system)

    @cached_property
    def rest(self) -> Array:
        """Displacements of the blocks at rest under the constant loads, (blocks, 6).

        A ValueError if nothing holds them and the loads have a resultant.
        """
        equations = self.statics
        z, force = equations.at_rest(equations.F, np.zeros(len(equations.pressure)))
        if not self.held:
            inertia = equations.B.T[:, -3:] @ force[-3:]
            if np.max(np.abs(inertia)) > UNBALANCED * np.sum(np.abs(equations.F)):
                raise ValueError("load: must be in balance where nothing is clamped, got a resultant")
        return np.asarray(equations.shapes @ (z * self.system.load_size)).reshape(-1, 6)

    @property
    def strains(self) -> Array:
        """Strains e_x, e_y and g_xy of every block at rest, (blocks, 3); errors as `rest`."""
        return self.rest[:, 3:]

    def observer(self, start: Point, end: Point) -> Array:
        """Return the rows of the mean displacement in x and y of a part of the outline, or of a point, (2, 6 blocks).

        A block of one strain moves its edges linearly: the mean is that of the middle. A ValueError if nothing lies
        there.
        """
        if start == end:
            return self.system.rows_at(start)[:2]
        blocks = self.system.blocks
        rows = np.zeros((2, len(blocks), 6))
        between = [joint for joint in self.system.joints if FIXED not in (joint.first, joint.second)]
        length = math.dist(start, end)
        for number, first, last in _on_line([*_outline(blocks, between)], start, end, "edge"):
            share = math.dist(first, last) / length
            rows[:, number] += share * blocks[number].T(*(np.add(first, last) / 2))
        return rows.reshape(2, -1)

    def modes(self, scheme: Scheme, count: int) -> tuple[Mode, ...]:
        """Return the lowest modes that are no rigid motion, in rising order, their shares of the static response."""
        equations = self.statics
        squares, shapes, _ = equations.lowest(count)
        z, _ = equations.at_rest(equations.F, np.zeros(len(equations.pressure)))
        shares = (shapes.T @ equations.F) ** 2 / (squares * (equations.F @ z))
        return modes_of(scheme, np.sqrt(squares), shares, 0 * shares)

    def history(self, scheme: Scheme, steps: int, rows: Array) -> Result:
        """Return what some rows observe of the blocks from rest, at each step.

        Parameters
        ----------
        rows : (columns, 6 blocks) array
            As `observer` returns them; the columns of the result are named by their numbers.
        """
        check_count(steps=steps)
        began = perf_counter()
        equations = self.system.equations
        none = np.zeros((len(rows), len(equations.pressure)))
        names = [str(number) for number in range(len(rows))]
        return stepped(self.system, equations, scheme, steps, names, (rows @ equations.shapes, none), began)


def _without_rigid_motion(system: BlockSystem) -> Equations:
    """Return a free system's equations with the condition R' M D = 0."""
    from scipy.sparse import block_diag, csr_array, vstack

    equations = system.equations
    momentum = equations.rigid / np.max(equations.rigid)  # rows of the size of the others
    return replace(
        equations,
        B=csr_array(vstack([equations.B, csr_array(momentum.T)])),
        C=csr_array(block_diag([equations.C, csr_array((3, 3))])),
        pressure=np.concatenate([equations.pressure, np.zeros(3)]),
    )
