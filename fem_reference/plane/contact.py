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
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, eye_array, vstack

from fem_reference.contact.system import ContactRows, opening_rows, point_rows
from fem_reference.mesh import elasticity
from fem_reference.mesh.mesh import facets_along
from fem_reference.plane.body import Point
from fem_reference.plane.elements import BodyElements
from fem_reference.problem.checks import require, require_numbers
from fem_reference.problem.problem import Array, Flags

UNIT = 1e-9
"""Difference of a normal's length from one that a file's digits may leave."""


@dataclass(frozen=True)
class PatchContact:
    """A spring of a body on another one or on the fixed base, over a patch of its outline."""

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


class ContactPoints(NamedTuple):
    """The points of all contacts as rows, those of a contact one after the other."""

    B: csr_array  # displacements relative to the second body, out of it and clockwise of that, (rows, unknowns)
    rows: ContactRows
    gap: Array  # at t = 0, zero of shear [m], shape (rows,)
    ground: Array  # displacement of the base's side for a unit of the base's in x and in y, shape (rows, 2)
    share: Array  # of its contact [-], shape (rows,)
    normal: Array  # one where a row is a normal one of a contact, shape (rows, contacts)
    shear: Array  # one where it is one of shear

    @property
    def all_closed(self) -> Flags:
        """Each row closed and sticking, shape (rows,)."""
        return np.ones(len(self.gap), dtype=bool)


def points_of(contacts: Sequence[PatchContact], bodies: Sequence[BodyElements], first: Sequence[int]) -> ContactPoints:
    """The points of contacts of bodies; `first` are the numbers of their first unknowns, and that of all at the end.

    A patch off the outlines of its bodies, or without such a body, is a `ValueError`.
    """
    size = first[-1]
    none = np.zeros(0)
    each = np.zeros((0, len(contacts)))
    pieces = [ContactPoints(csr_array((0, size)), opening_rows(none), none, np.zeros((0, 2)), none, each, each)]
    rows_before = 0
    for contact, unit in zip(contacts, np.eye(len(contacts)), strict=True):
        u, v, share = _relative(contact, bodies, first)
        rows = contact.rows(share)
        rows.partner[:] += rows_before
        rows_before += len(rows.partner)
        sides = len(rows.partner) // len(share)
        is_shear = np.repeat([False, True][:sides], len(share))
        n_x, n_y = contact.normal
        directions = [(n_x, n_y), (n_y, -n_x)][:sides]
        piece = ContactPoints(
            B=csr_array(vstack([x * u + y * v for x, y in directions])),
            rows=rows,
            gap=np.where(is_shear, 0.0, contact.gap),
            ground=np.repeat(directions, len(share), axis=0) * (contact.second is None),
            share=np.tile(share, sides),
            normal=np.outer(~is_shear, unit),
            shear=np.outer(is_shear, unit),
        )
        pieces.append(piece)
    B, laws, *arrays = zip(*pieces, strict=True)
    rows = ContactRows(*(np.concatenate(parts) for parts in zip(*laws, strict=True)))
    return ContactPoints(csr_array(vstack(B)), rows, *(np.concatenate(parts) for parts in arrays))


def _relative(
    contact: PatchContact, bodies: Sequence[BodyElements], first: Sequence[int]
) -> tuple[csr_array, csr_array, Array]:
    """Rows of the displacements of a patch's points relative to the second body, and the points' shares."""
    sides = [(contact.first, np.zeros(2))]
    if contact.second is not None:
        sides.append((contact.second, -contact.gap * np.array(contact.normal)))
    for number, _ in sides:
        require(0 <= number < len(bodies), "contact", f"must be of bodies 0 to {len(bodies) - 1}", number)
    rules = _rules(contact, [(bodies[number], shift) for number, shift in sides])
    weights = rules[0].weights
    rows = [csr_array((len(weights), first[-1]))] * 2
    for (number, _), rule, sign in zip(sides, rules, (1.0, -1.0), strict=False):
        body = bodies[number]
        place = csr_array(eye_array(len(body.free), first[-1], k=first[number]))
        of_body = elasticity.values(body.basis, rule)
        rows = [row + sign * (part[:, body.free] @ place) for row, part in zip(rows, of_body, strict=True)]
    return rows[0], rows[1], weights / weights.sum()


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
    quadrature = elasticity.gauss(max(body.body.degree for body, _ in meshes))
    rules = []
    for (body, shift), (facets, _) in zip(meshes, edges, strict=True):
        tangent = (end - start) / length
        rule = elasticity.edge_rule(body.mesh, facets, start + shift, tangent, [*pairwise(breaks)], quadrature)
        rules.append(elasticity.in_order(body.basis, rule, tangent)[0])
    return rules
