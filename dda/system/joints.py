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
from typing import NamedTuple

import numpy as np

from dda.model.arrays import Array, without_rounding
from dda.model.block import Block, displacement_rows
from dda.model.checks import check_positive

Point = tuple[float, float]

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
        """Check the ranges."""
        check_positive(normal=self.normal, shear=self.shear)
        if not math.dist(self.start, self.end) > 0:
            raise ValueError(f"end: must differ from start, got {self.end!r}")

    @cached_property
    def tangent(self) -> Array:
        """Unit direction from start to end."""
        t: Array = np.subtract(self.end, self.start) / math.dist(self.start, self.end)
        return t

    @cached_property
    def stiffness(self) -> Array:
        """Matrix of the spring at one end, 2 x 2 in global directions [N/m]."""
        t = self.tangent
        n = np.array([-t[1], t[0]])
        k: Array = self.normal * np.outer(n, n) + self.shear * np.outer(t, t)
        return k


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


def _springs_at_points(joints: Sequence[Joint]) -> list[list[tuple[int, int]]]:
    """Return the springs (joint, end) that share a point, a list for each point."""
    points = np.array([place for joint in joints for place in (joint.start, joint.end)]).reshape(-1, 2)
    if not len(points):
        return []
    cell = _SAME_PLACE * float(np.max(np.ptp(points, axis=0)))
    labels = _labels(points - points.min(axis=0), 4 * cell)
    springs_by_point: dict[int, list[tuple[int, int]]] = {}
    for number, label in enumerate(labels):
        springs_by_point.setdefault(label, []).append((number // 2, number % 2))
    return list(springs_by_point.values())


def _labels(points: Array, cell: float) -> list[int]:
    """Return a number for each point, equal where points lie within a quarter of a cell of each other."""
    label_of_point: dict[tuple[int, int], int] = {}
    labels = []
    for number, (x, y) in enumerate((points / cell).tolist()):
        corners = {(math.floor(x + a), math.floor(y + b)) for a in (-0.25, 0.25) for b in (-0.25, 0.25)}
        label = next((label_of_point[corner] for corner in corners if corner in label_of_point), number)
        label_of_point.update(dict.fromkeys(corners, label))
        labels.append(label)
    return labels


def _plain(blocks: Sequence[Block], joint: Joint) -> Gaps:
    """Return the four gaps of a joint of its own: means (t, n) and differences (n, t) of its ends."""
    start = np.array(joint.start)
    end = np.array(joint.end)
    t = joint.tangent
    n = np.array([-t[1], t[0]])
    bodies = {}
    for body, sign in ((joint.first, 1.0), (joint.second, -1.0)):
        mean = _value(blocks, body, (start + end) / 2)
        difference = _gradient(body, end - start)
        bodies[body] = sign * np.array([t @ mean, n @ mean, n @ difference, t @ difference])
    kn = joint.normal
    ks = joint.shear
    return Gaps(bodies, np.diag([2 * ks, 2 * kn, kn / 2, ks / 2]))


def _meeting(blocks: Sequence[Block], joints: Sequence[Joint], met: list[tuple[int, int]]) -> Gaps:
    """Return the gaps where springs meet in a point: the vector across each branch of a spanning tree."""
    met = sorted(met, key=lambda s: -(joints[s[0]].normal + joints[s[0]].shear))
    paths: dict[int, tuple[int, Array]] = {}  # body -> (root of its tree, sum of gaps from the root to it)
    tree: list[tuple[int, int]] = []
    most = len(met)
    for j, _ in met:
        a = joints[j].first
        b = joints[j].second
        (root_a, path_a), (root_b, path_b) = (paths.setdefault(x, (x, np.zeros(most))) for x in (a, b))
        if root_a == root_b:
            continue
        # d_a - d_b is the new gap: every body of b's tree is reached from a's root now.
        shift = path_a - path_b - np.eye(most)[len(tree)]
        paths |= {x: (root_a, path + shift) for x, (root, path) in paths.items() if root == root_b}
        tree.append((a, b))
    size = len(tree)
    kappa = np.zeros((2 * size, 2 * size))
    for j, _ in met:
        across = (paths[joints[j].first][1] - paths[joints[j].second][1])[:size]
        pairs = np.outer(across, across)[:, None, :, None] * joints[j].stiffness[:, None, :]  # what np.kron multiplies
        kappa += pairs.reshape(kappa.shape)
    joint = joints[met[0][0]]
    end = met[0][1]
    point = np.array(joint.end if end else joint.start)
    bodies: dict[int, Array] = {}
    for branch, (a, b) in enumerate(tree):
        for body, sign in ((a, 1.0), (b, -1.0)):
            value = _value(blocks, body, point)
            rows = bodies.setdefault(body, np.zeros((2 * size, value.shape[1])))
            rows[2 * branch : 2 * branch + 2] += sign * value
    return Gaps(bodies, kappa)


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


def shared_edges(blocks: Sequence[Block], normal: float, shear: float) -> list[Joint]:
    """Return a joint for every piece of boundary of positive length that two blocks share.

    Parameters
    ----------
    normal, shear : float
        Stiffness of the springs at each end [N/m].
    """
    edges = [(i, *block.edge(e)) for i, block in enumerate(blocks) for e in range(len(block.corners))]
    starts, ends = (np.array([edge[k] for edge in edges]) for k in (1, 2))
    owners = np.array([edge[0] for edge in edges])
    slack = _SAME_PLACE * float(np.max(np.ptp(np.vstack([starts, ends]), axis=0)))
    joints = []
    for i, a, b in edges:
        length = float(np.hypot(*(b - a)))
        t = (b - a) / length
        n = np.array([-t[1], t[0]])
        near = (owners > i) & (np.maximum(abs((starts - a) @ n), abs((ends - a) @ n)) <= slack)
        for k in np.flatnonzero(near):
            low, high = sorted(((starts[k] - a) @ t, (ends[k] - a) @ t))
            low = max(low, 0.0)
            high = min(high, length)
            if high - low > slack:
                first, last = (tuple(float(v) for v in a + s * t) for s in (low, high))
                joints.append(Joint(i, int(owners[k]), first, last, normal, shear))  # type: ignore[arg-type]
    return joints
