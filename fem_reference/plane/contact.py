"""Contacts of bodies in the plane: springs over patches of their outlines, as rows of `fem_reference.contact.law`.

A corner spring p of a block on another one has no limit of fine elements. Here it is spread evenly over a patch, a
straight piece of the outline of its body, and acts there on the body below that has the same piece, a gap along the
normal away. Its points are those of a Gauss rule between all corners of the elements of both sides; a point with the
share c of the patch has the springs c p and c p_s, the cohesion c c_p, and the law of a corner. The normal stays that
of t = 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, eye_array, vstack

from fem_reference.contact.system import ContactRows, opening_rows, point_rows
from fem_reference.mesh import elasticity
from fem_reference.mesh.mesh import facets_along
from fem_reference.plane.body import Point
from fem_reference.plane.elements import BodyElements
from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.problem import Array

UNIT = 1e-9
"""Difference of a normal's length from one that a file's digits may leave."""


@dataclass(frozen=True)
class PatchContact:
    """A spring of a body on another one or on the fixed base, over a patch of its outline.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    first: int  # number of the body
    second: int | None  # of the body that it is on, None: the base
    start: Point  # of the patch on the outline of the first body [m]
    end: Point  # where it is the start the spring acts at a point, which has no limit of fine elements
    normal: tuple[float, float]  # unit vector out of the second body
    stiffness: float  # normal stiffness p of the whole patch [N/m]
    shear_stiffness: float = 0.0  # p_s [N/m]
    friction: float | None = None  # tangent of the angle [-]; None: it never slips
    cohesion: float = 0.0  # shear force that the whole closed patch bears without pressure [N]
    bonded: bool = False  # whether it never opens
    gap: float = 0.0  # at t = 0, along the normal, negative where the springs begin compressed [m]

    def __post_init__(self) -> None:
        require_numbers(self, ("stiffness",), ("shear_stiffness", "friction", "cohesion"))
        unit = abs(math.hypot(*self.normal) - 1) <= UNIT
        require(unit, "normal", "must be a unit vector", self.normal)
        require(self.second != self.first, "second", "must differ from first", self.second)
        require(self.friction is not None or not self.cohesion, "cohesion", "goes with friction", self.cohesion)
        require(not self.gap or not self.bonded, "gap", "must be zero of a bonded contact", self.gap)

    def rows(self, share: Array) -> ContactRows:
        """Rows of its points with their shares: normal ones, and where it has springs of shear those of these."""
        cohesion = self.cohesion * share
        return point_rows(self.stiffness * share, self.shear_stiffness * share, self.friction, cohesion, self.bonded)


@dataclass(frozen=True)
class ContactPoints:
    """The points of all contacts as rows, those of a contact one after the other."""

    B: csr_array  # displacements relative to the second body, out of it and clockwise of that, (rows, unknowns)
    rows: ContactRows
    gap: Array  # at t = 0, zero of shear [m], shape (rows,)
    ground: Array  # displacement of the base's side for a unit of the base's in x and in y, shape (rows, 2)
    share: Array  # of its contact [-], shape (rows,)
    normal: Array  # one where a row is a normal one of a contact, shape (rows, contacts)
    shear: Array  # one where it is one of shear

    @property
    def all_closed(self) -> NDArray[np.bool_]:
        """Each row closed and sticking, shape (rows,)."""
        return np.ones(len(self.gap), dtype=bool)


def points_of(contacts: Sequence[PatchContact], bodies: Sequence[BodyElements], first: Sequence[int]) -> ContactPoints:
    """Return the points of contacts.

    Parameters
    ----------
    bodies, first
        The bodies, and the number of the first unknown of each; at the end the number of all.

    Raises
    ------
    ValueError
        A patch does not lie on the outlines of its bodies, or there is no such body.
    """
    B = [csr_array((0, first[-1]))]
    rows = [opening_rows(np.zeros(0))]
    gap = [np.zeros(0)]
    ground = [np.zeros((0, 2))]
    shares = [np.zeros(0)]
    normal = np.zeros((0, len(contacts)))
    shear = np.zeros((0, len(contacts)))
    for number, contact in enumerate(contacts):
        x_rows, y_rows, share = _relative(contact, bodies, first)
        law = contact.rows(share)
        law.partner[:] += len(normal)
        n = np.array(contact.normal)
        is_shear = np.arange(len(law.partner)) >= len(share)
        for direction in (n, np.array([n[1], -n[0]]))[: 1 + is_shear.any()]:
            B.append(csr_array(direction[0] * x_rows + direction[1] * y_rows))
            ground.append(np.tile(direction * (contact.second is None), (len(share), 1)))
            shares.append(share)
        rows.append(law)
        gap.append(np.where(is_shear, 0.0, contact.gap))
        unit = np.eye(len(contacts))[number]
        normal = np.vstack([normal, np.outer(~is_shear, unit)])
        shear = np.vstack([shear, np.outer(is_shear, unit)])
    return ContactPoints(
        B=csr_array(vstack(B)),
        rows=ContactRows(*(np.concatenate(parts) for parts in zip(*rows, strict=True))),
        gap=np.concatenate(gap),
        ground=np.concatenate(ground),
        share=np.concatenate(shares),
        normal=normal,
        shear=shear,
    )


def _relative(
    contact: PatchContact, bodies: Sequence[BodyElements], first: Sequence[int]
) -> tuple[csr_array, csr_array, Array]:
    """Rows of the displacements of a patch's points relative to the second body, and the points' shares."""
    sides = [(contact.first, 1.0, np.zeros(2))]
    if contact.second is not None:
        sides.append((contact.second, -1.0, -contact.gap * np.array(contact.normal)))
    for number, _, _ in sides:
        require(0 <= number < len(bodies), "contact", f"must be of bodies 0 to {len(bodies) - 1}", number)
    meshes = [(bodies[number], shift) for number, _, shift in sides]
    rules = _rules(contact, meshes)
    x_rows = csr_array((len(rules[0].weights), first[-1]))
    y_rows = x_rows
    for (number, sign, _), rule in zip(sides, rules, strict=True):
        body = bodies[number]
        u, v = elasticity.values(body.basis, rule)
        place = csr_array(eye_array(len(body.free), first[-1], k=first[number]))
        x_rows = x_rows + sign * (u[:, body.free] @ place)
        y_rows = y_rows + sign * (v[:, body.free] @ place)
    weights = rules[0].weights
    return x_rows, y_rows, weights / weights.sum()


def _rules(contact: PatchContact, meshes: Sequence[tuple[BodyElements, Array]]) -> list[elasticity.Rule]:
    """The same points on each side of a contact, whose outline lies shifted, in their order along it."""
    start = np.array(contact.start, float)
    end = np.array(contact.end, float)
    if contact.start == contact.end:
        return [elasticity.point_rule(body.basis, start + shift) for body, shift in meshes]
    length = float(np.hypot(*(end - start)))
    slack = max(body.body.slack for body, _ in meshes)
    edges = [facets_along(body.mesh, start + shift, end + shift, slack) for body, shift in meshes]
    places = np.sort(np.concatenate([[0.0, length], *(np.ravel(ends) for _, ends in edges)]))
    inner = places[(places > slack) & (places < length - slack)]
    breaks = np.array([0.0, *inner[np.diff(inner, prepend=0.0) > slack], length])
    order = max(body.body.degree for body, _ in meshes) + 1
    rules = []
    for (body, shift), (facets, _) in zip(meshes, edges, strict=True):
        tangent = (end - start) / length
        rule = elasticity.edge_rule(body.mesh, facets, start + shift, tangent, [*pairwise(breaks)], order)
        rules.append(elasticity.in_order(body.basis, rule, tangent)[0])
    return rules
