"""Locked joints between blocks, and the gaps by which their springs are described.

A joint is a straight piece of boundary that two blocks share, with a normal and a shear spring at
each of its two ends. The gaps g = B D - G y of a system (y the displacement of what is fixed) are
chosen so that the spring energy g' kappa g / 2 has small blocks kappa that keep their digits:

- a joint whose two ends carry no other spring has the mean and the difference of its end gaps,
  in which kappa is diagonal and the zeros of a symmetric system are exact;
- where several springs meet in a point, the gaps are those of a spanning tree of the bodies that
  meet there, stiffest springs first; the springs that close a loop add to kappa and to no gap.

So there are as many gaps as there are independent relative motions: joints that close a loop
around a corner leave no force undetermined, however stiff they are.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from dda.model.arrays import Array, without_rounding
from dda.model.block import Block, displacement_rows
from dda.model.checks import check_positive

Point = tuple[float, float]
End = tuple[int, int]  # a joint, and which of its ends

FIXED = -1  # the body that all fixed parts form
_SAME_PLACE = 1e-9  # of the system's extent


@dataclass(frozen=True)
class Joint:
    """Locked springs at the two ends of a piece of boundary.

    Raises
    ------
    ValueError
        If a stiffness is not finite and positive, or the ends coincide.
    """

    first: int  # block on the left of the direction from start to end
    second: int  # block on the right, or FIXED
    start: Point  # [m]
    end: Point  # [m]
    normal: float  # stiffness of the normal spring at each end [N/m]
    shear: float  # stiffness of the shear spring at each end [N/m]

    def __post_init__(self) -> None:
        check_positive(normal=self.normal, shear=self.shear)
        if not math.dist(self.start, self.end) > 0:
            raise ValueError(f"end: must differ from start, got {self.end!r}")

    @cached_property
    def frame(self) -> Array:
        """Unit vectors from start to end, and from the second block to the first, a row each."""
        x, y = np.subtract(self.end, self.start) / math.dist(self.start, self.end)
        return np.array([[x, y], [-y, x]])

    @cached_property
    def stiffness(self) -> Array:
        """Matrix of the spring at one end, 2 x 2 in global directions [N/m]."""
        t, n = self.frame
        return self.normal * np.outer(n, n) + self.shear * np.outer(t, t)


class Gaps(NamedTuple):
    """Some gaps that share a block of kappa."""

    bodies: dict[int, Array]  # body -> rows of the gap by its six unknowns, or by (x, y) of what is fixed
    stiffness: Array  # kappa [N/m]


def gap_groups(blocks: Sequence[Block], joints: Sequence[Joint]) -> list[Gaps]:
    """Return the gaps of all joints in groups that do not share a spring."""
    springs = _springs_at_points(joints)
    busy = {spring for met in springs if len(met) > 1 for spring in met}
    groups = [_plain(blocks, joint) for j, joint in enumerate(joints) if not {(j, 0), (j, 1)} & busy]
    for met in springs:
        loaded_ends = [(j, e) for j, e in met if {(j, 0), (j, 1)} & busy]
        if loaded_ends:
            groups.append(_meeting(blocks, joints, loaded_ends))
    return groups


def _springs_at_points(joints: Sequence[Joint]) -> list[list[End]]:
    """Return the springs (joint, end) that share a point, a list for each point."""
    points = np.array([place for joint in joints for place in (joint.start, joint.end)]).reshape(-1, 2)
    if not len(points):
        return []
    slack = _SAME_PLACE * np.max(np.ptp(points, axis=0))
    places = np.zeros(points.shape, dtype=int)
    for axis, x in enumerate(points.T):
        order = np.argsort(x)
        places[order[1:], axis] = np.cumsum(np.diff(x[order]) > slack)
    springs_by_point: dict[tuple[int, int], list[End]] = {}
    for number, (i, j) in enumerate(places.tolist()):
        springs_by_point.setdefault((i, j), []).append((number // 2, number % 2))
    return list(springs_by_point.values())


def _plain(blocks: Sequence[Block], joint: Joint) -> Gaps:
    """Return the four gaps of a joint of its own: means (t, n) and differences (n, t) of its ends."""
    start = np.array(joint.start)
    end = np.array(joint.end)
    bodies = {}
    for body, sign in ((joint.first, 1.0), (joint.second, -1.0)):
        means = joint.frame @ _value(blocks, body, (start + end) / 2)
        differences = joint.frame[::-1] @ _gradient(body, end - start)
        bodies[body] = sign * np.vstack([means, differences])
    return Gaps(bodies, np.diag([2 * joint.shear, 2 * joint.normal, joint.normal / 2, joint.shear / 2]))


def _meeting(blocks: Sequence[Block], joints: Sequence[Joint], met: list[End]) -> Gaps:
    """Return the gaps where springs meet in a point: the vector across each branch of a spanning tree."""
    met = sorted(met, key=lambda s: -(joints[s[0]].normal + joints[s[0]].shear))
    springs = [joints[j] for j, _ in met]
    bodies = list(dict.fromkeys(body for joint in springs for body in (joint.first, joint.second)))
    ends = np.array([[(body == joint.first) - (body == joint.second) for body in bodies] for joint in springs], float)
    root = {body: body for body in bodies}
    tree = []
    for number, joint in enumerate(springs):
        first = root[joint.first]
        second = root[joint.second]
        if first != second:
            tree.append(number)
            root = {body: first if known == second else known for body, known in root.items()}
    branches = ends[tree]
    across = np.rint(ends @ np.linalg.pinv(branches))  # what each spring spans, by the branches: whole numbers
    kappa = np.einsum("si,sj,skl->ikjl", across, across, np.array([joint.stiffness for joint in springs]))
    point = np.array(springs[0].end if met[0][1] else springs[0].start)
    values = [_value(blocks, body, point) for body in bodies]
    rows = {
        body: (branches[:, c, None, None] * value).reshape(-1, value.shape[1])
        for c, (body, value) in enumerate(zip(bodies, values, strict=True))
    }
    return Gaps(rows, kappa.reshape(2 * len(tree), -1))


def _value(blocks: Sequence[Block], body: int, point: Array) -> Array:
    """Return the displacement of a body at a point by its unknowns, rounded zeros made exact."""
    if body == FIXED:
        return np.eye(2)
    block = blocks[body]
    x, y = without_rounding(point - np.array(block.section.centroid), np.ptp(block.corners, axis=0))
    return displacement_rows(x, y)


def _gradient(body: int, along: Array) -> Array:
    """Return the change of a body's displacement over a distance by its unknowns."""
    if body == FIXED:
        return np.zeros((2, 2))
    rows = displacement_rows(*along)
    rows[:, :2] = 0.0
    return rows


def common_part(edge: Sequence[Any], other: Sequence[Any], slack: float) -> tuple[Point, Point] | None:
    """Return the ends of what an edge shares with another one on its line, in its own direction.

    The other one may lie beside the line by `slack`; what is shorter is none [m].
    """
    start, end = (complex(*place) for place in edge)  # in the plane of complex numbers
    side = end - start
    along = [(complex(*place) - start) / side for place in other]  # of the edge from 0 to 1
    places = sorted((share.real, *place) for share, place in zip(along, other, strict=True))
    low = max(places[0], (0.0, *edge[0]))
    high = min(places[1], (1.0, *edge[1]))
    if max(abs(share.imag) for share in along) * abs(side) > slack or not (high[0] - low[0]) * abs(side) > slack:
        return None
    return low[1:], high[1:]


def shared_edges(blocks: Sequence[Block], normal: float, shear: float) -> list[Joint]:
    """Return a joint for every piece of boundary of positive length that two blocks share.

    Parameters
    ----------
    normal, shear : float
        Stiffness of the springs at each end [N/m].
    """
    outlines = [block.corners.tolist() for block in blocks]
    edges = [(i, edge) for i, ring in enumerate(outlines) for edge in zip(ring, ring[1:] + ring[:1], strict=True)]
    owners = np.array([owner for owner, _ in edges])
    ends = np.array([edge for _, edge in edges])
    extent = np.ptp(ends.reshape(-1, 2), axis=0)
    slack = _SAME_PLACE * np.max(extent)
    lows = ends.min(axis=1) - slack
    highs = ends.max(axis=1) + slack
    sweep = np.argmax(extent)  # along the longer side: only edges beside one another there can share anything
    order = np.argsort(lows[:, sweep], kind="stable")
    begins = lows[order, sweep]
    longest = np.max(highs[:, sweep] - lows[:, sweep])
    joints = []
    for (i, edge), low, high in zip(edges, lows, highs, strict=True):
        window = order[slice(*np.searchsorted(begins, (low[sweep] - longest, high[sweep])))]
        window = np.sort(window[owners[window] > i])
        beside = np.all((lows[window] <= high) & (highs[window] >= low), axis=1)
        for k in window[beside]:
            part = common_part(edge, edges[k][1], slack)
            if part is not None:
                joints.append(Joint(i, int(owners[k]), *part, normal, shear))
    return joints
