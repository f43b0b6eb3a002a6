r"""The two-block model in contact-gap coordinates, in which the stiffness is diagonal.

In the frame of the base edge (x' along the edge from its middle, y' along the inward normal)
the affine displacement of the block is

    u' = U + y' (gxy - s) + x' ex,        v' = w + x' s + y' (e2 - c ex)

with U, w the mean tangential and normal stretch of the springs, s the difference of the normal
stretches over the base length a, and e2 = ey + c ex, c the free lateral contraction. Then

    2 energy = 2 ps U^2 + 2 pn w^2 + pn a^2 s^2 / 2 + (ps a^2 / 2 + A E') ex^2
             + A (lambda + 2 G) e2^2 + A G gxy^2,      E' = 4 G (lambda + G) / (lambda + 2 G),

a sum of squares with one product each: no digit of a stiff spring, nor of a nearly
incompressible material, is lost by subtraction, and the contact pressure is -2 pn w / a.
All displacements are measured from the base: a moving base adds its own, and loads the block
through the inertia alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dda.contact.springs import Contact, base_directions
from dda.model.arrays import Array, without_rounding
from dda.model.block import Block
from dda.model.load import Load, pressed_part
from dda.model.material import Material
from dda.model.polygon import AreaIntegrals, area_integrals

UNKNOWNS = ("U", "w", "s", "ex", "e2", "gxy")
COLUMNS = (
    "displacement",
    "contact_pressure",
    "horizontal_displacement",
    "rotation",
    "strain_x",
    "strain_y",
    "shear_strain",
)
D_COLUMNS = ("horizontal_displacement", "displacement", "rotation", "strain_x", "strain_y", "shear_strain")  # of D


@dataclass(frozen=True, eq=False)
class GapForm:
    """M (x + R y)'' + K x = F for a load of unit size and a base displacement y, K diagonal."""

    unknowns: tuple[str, ...]  # names of x; the stretches in m, the others without unit
    M: Array  # (n, n) inertia
    K: Array  # (n,) diagonal of the stiffness
    F: Array  # (n,) load, the largest of its stresses 1 Pa
    R: Array  # (n, 2) rigid translation by the base's displacement in x and y
    Q: Array  # (6, n): D = Q (x + R y)
    observers: dict[str, Array]  # column -> (n,) row

    def reduced(self) -> GapForm:
        """Return the form without the unknowns that the load cannot reach.

        They are found by connectivity: an unknown stays if it is loaded, or coupled by a
        structural non-zero of M to one that stays (K is diagonal and couples nothing).
        """
        return self.restricted(np.flatnonzero(self.reached_from((self.F != 0) | np.any(self.M @ self.R != 0, axis=1))))

    def reached_from(self, pushed: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return which unknowns move: the pushed ones and those that M couples to them, (n,)."""
        reached = pushed
        coupled = self.M != 0
        while np.any((grown := reached | coupled @ reached) != reached):
            reached = grown
        return reached

    def restricted(self, unknowns: NDArray[np.intp]) -> GapForm:
        """Return the form in the unknowns with the given indices."""
        return GapForm(
            tuple(self.unknowns[i] for i in unknowns),
            self.M[unknowns[:, None], unknowns],
            self.K[unknowns],
            self.F[unknowns],
            self.R[unknowns],
            self.Q[:, unknowns],
            {name: row[unknowns] for name, row in self.observers.items()},
        )


def gap_form(block: Block, contact: Contact, base: int, top: int, load: Load) -> GapForm:
    """Assemble the two-block model in contact-gap coordinates."""
    tangent, _, a = base_directions(block, base)
    start = block.edge(base)[0]
    local = _base_frame(block, tangent, start, a)
    integrals = _without_rounding(area_integrals(local))
    c = block.material.contraction
    weight = block.material.density * load.gravity
    Q = _to_block_unknowns(integrals, c, tangent)
    return GapForm(
        UNKNOWNS,
        block.material.density * _inertia(integrals, c),
        _stiffness(block.material, contact, integrals.area, a),
        _load(local, top, tangent, c, load) + _gravity(integrals, weight, load.falling, tangent, c),
        _translation(tangent, load),
        Q,
        _observers(Q, contact, a),
    )


def _base_frame(block: Block, tangent: Array, start: Array, a: float) -> Array:
    """Return the corners in the frame of the base edge, from its middle [m]."""
    tx, ty = tangent
    x, y = (block.corners - start).T
    return np.column_stack([(tx * x + ty * y) - a / 2, tx * y - ty * x])


def _without_rounding(i: AreaIntegrals) -> AreaIntegrals:
    """Return the integrals with the zeros of a symmetric shape made exact."""
    scales = np.sqrt([i.area * i.xx, i.xx * i.yy])
    x, xy = without_rounding([i.x, i.xy], scales).tolist()
    return replace(i, x=x, xy=xy)


def _inertia(i: AreaIntegrals, c: float) -> Array:
    """Return the inertia matrix over density: integrals of the products of the base functions.

    The base functions of (U, w, s, ex, e2, gxy) are (1, 0), (0, 1), (-y', x'), (x', -c y'),
    (0, y') and (y', 0).
    """
    upper = np.array(
        [
            [i.area, 0.0, -i.y, i.x, 0.0, i.y],
            [0.0, i.area, i.x, -c * i.y, i.y, 0.0],
            [0.0, 0.0, i.xx + i.yy, -(1 + c) * i.xy, i.xy, -i.yy],
            [0.0, 0.0, 0.0, i.xx + c * c * i.yy, -c * i.yy, i.xy],
            [0.0, 0.0, 0.0, 0.0, i.yy, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, i.yy],
        ]
    )
    full: Array = upper + np.triu(upper, 1).T
    return full


def _stiffness(material: Material, contact: Contact, area: float, a: float) -> Array:
    """Return the diagonal of the stiffness in (U, w, s, ex, e2, gxy)."""
    pn = contact.normal
    ps = contact.shear
    return np.array(
        [
            2 * ps,
            2 * pn,
            pn * a * a / 2,
            ps * a * a / 2 + area * material.free_modulus,
            area * material.constrained_modulus,
            area * material.shear_modulus,
        ]
    )


def _load(local: Array, top: int, tangent: Array, c: float, load: Load) -> Array:
    """Return the load on the top edge: pressure in global -y, traction in global +x."""
    ends = local[top], local[(top + 1) % len(local)]
    turned = np.array([[tangent[0], -tangent[1]], [tangent[1], tangent[0]]])  # global from local
    start, end = (turned @ point for point in ends)
    pressed = pressed_part(start, end, load.eccentricity)
    part = ends if load.eccentricity == 0 else tuple(turned.T @ point for point in pressed)
    extent = np.max(np.abs(local), axis=0)
    down = -turned[1]
    right = turned[0]
    return _edge(part, extent, load.pressure * down, c) + _edge(ends, extent, load.traction * right, c)


def _edge(ends: tuple[Array, ...], extent: Array, traction: Array, c: float) -> Array:
    """Return the load of a uniform traction (local directions) on a straight part of the outline."""
    x, y = without_rounding((ends[0] + ends[1]) / 2, extent)
    force = float(np.hypot(*(ends[1] - ends[0]))) * traction
    return _loads(1.0, x, y, force, c)


def _gravity(i: AreaIntegrals, weight: float, falling: tuple[float, float], tangent: Array, c: float) -> Array:
    """Return the load of a weight per area [N/m^3] in the direction `falling`."""
    right, up = falling
    along = weight * (right * tangent[0] + up * tangent[1])
    across = weight * (up * tangent[0] - right * tangent[1])
    return _loads(i.area, i.x, i.y, (along, across), c)


def _loads(size: float, x: float, y: float, force: Sequence[float] | Array, c: float) -> Array:
    """Return the load of a force by the integrals of 1, x' and y' over what it acts on."""
    fx, fy = force
    return np.array([size * fx, size * fy, x * fy - y * fx, x * fx - c * y * fy, y * fy, y * fx]) + 0.0


def _translation(tangent: Array, load: Load) -> Array:
    """Return x of the rigid translation by 1 m in x and in y, zero where the base does not move so."""
    R = np.zeros((6, 2))
    if load.motion is not None:
        tx, ty = tangent
        R[:2] = np.array([[tx, ty], [-ty, tx]]) * np.any(np.asarray(load.motion.displacement) != 0, axis=0)
    return R


def _to_block_unknowns(i: AreaIntegrals, c: float, tangent: Array) -> Array:
    """Return the 6 x 6 matrix Q of D = Q x, D in global directions about the centroid."""
    X = i.x / i.area
    Y = i.y / i.area
    tx, ty = tangent
    u = np.array([1.0, 0.0, -Y, X, 0.0, Y])
    v = np.array([0.0, 1.0, X, -c * Y, Y, 0.0])
    ex = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    ey = np.array([0.0, 0.0, 0.0, -c, 1.0, 0.0])
    g = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    r = np.array([0.0, 0.0, 1.0, 0.0, 0.0, -0.5])
    return np.array(
        [
            tx * u - ty * v,
            ty * u + tx * v,
            r,
            tx * tx * ex + ty * ty * ey - tx * ty * g,
            ty * ty * ex + tx * tx * ey + tx * ty * g,
            2 * tx * ty * (ex - ey) + (tx - ty) * (tx + ty) * g,
        ]
    )


def _observers(Q: Array, contact: Contact, a: float) -> dict[str, Array]:
    """Return the row of every column: the block's unknowns and -2 pn w / a."""
    rows = dict(zip(D_COLUMNS, Q, strict=True))
    rows["contact_pressure"] = np.array([0.0, -2 * contact.normal / a, 0.0, 0.0, 0.0, 0.0])
    return {name: rows[name] for name in COLUMNS}
