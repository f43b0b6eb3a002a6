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
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dda.contact.springs import Contact, base_axes
from dda.linear.natural_modes import free_modes, graded_modes
from dda.model.arrays import Array, ArrayPair, Columns, without_rounding
from dda.model.block import Block
from dda.model.load import Load, directions_of, pressed_part
from dda.model.material import Material
from dda.model.polygon import AreaIntegrals, area_integrals
from dda.scheme.harmonic import Complex, answering, staged_amplitude
from dda.scheme.newmark import Scheme

UNKNOWNS = ("U", "w", "s", "ex", "e2", "gxy")
D_COLUMNS = ("horizontal_displacement", "displacement", "rotation", "strain_x", "strain_y", "shear_strain")  # of D


@dataclass(frozen=True, eq=False)
class ModalForm:
    """The model in its own modes, x = shapes z: (z + translation y)'' + w^2 z = load, of unit size."""

    frequencies: Array  # (n,) w [rad/s]
    shapes: Array  # (n, n) mass-normalised, one column a mode
    load: Array  # (n,) shapes' F
    translation: Array  # (n, 2) shapes' M R


@dataclass(frozen=True, eq=False)
class GapForm:
    """M (x + R y)'' + K x = F for a load of unit size and a base displacement y, K diagonal."""

    unknowns: tuple[str, ...]  # names of x; the stretches in m, the others without unit
    M: Array  # (n, n) inertia
    K: Array  # (n,) diagonal of the stiffness
    F: Array  # (n,) load, the largest of its stresses 1 Pa
    R: Array  # (n, 2) rigid translation by the base's displacement in x and y; zero where it does not move so
    observers: Columns  # column -> (n,) row over x, of the unknowns D over x + R y
    corners: Array  # (2, n, 2) displacements along and away from the base, of its corners M and N

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

    @cached_property
    def modal(self) -> ModalForm:
        """The form in its own modes."""
        return modal_form(self)

    def rows(self, columns: Sequence[str]) -> ArrayPair:
        """Return the rows of some columns by x and by the displacement of the base in x and y."""
        own = {"horizontal_displacement": [1.0, 0.0], "displacement": [0.0, 1.0]}
        by_base = [own.get(name, [0.0, 0.0]) for name in columns]
        return np.array([self.observers[name] for name in columns]), np.array(by_base)

    def at_base(self, F: Array, base: Array) -> ArrayPair:
        """Return x at rest under a load, and the displacement of the base."""
        return F / self.K, base

    def pushed(self, size: float) -> Array:
        """Return the load, or where the base alone acts the inertia M R of its unit acceleration."""
        inertia = np.sum(self.M @ self.R, axis=1)
        return inertia if size == 0 and np.any(inertia) else self.F

    def lowest(self, count: int) -> tuple[Array, Array, Array]:
        """Return w^2 and shapes of all modes, whose base rests."""
        frequencies = self.modal.frequencies
        return frequencies**2, self.modal.shapes, np.zeros((2, len(frequencies)))

    def largest(self) -> float:
        """Return the highest natural frequency [rad/s]."""
        return float(np.max(self.modal.frequencies))

    def steady(
        self, rows: ArrayPair, F: Array, base: Array, scheme: Scheme, frequencies: ArrayLike, exact: bool
    ) -> Complex:
        """Return what rows observe of a steady vibration, mode by mode, (rows, frequencies)."""
        modal = self.modal
        load = modal.shapes.T @ F
        carried = modal.translation @ base
        if len(scheme.stages) > 1 and not exact:
            omega = 2 * np.pi * np.atleast_1d(frequencies)
            squares = (scheme.step * modal.frequencies) ** 2
            parts = zip(squares.tolist(), (scheme.step**2 * load).tolist(), carried.tolist(), strict=True)
            x = np.array([staged_amplitude(scheme, omega, *part) for part in parts])
        else:
            W2, factor = answering(scheme, frequencies, exact)
            apart = modal.frequencies[:, None] ** 2 - W2
            x = load[:, None] / apart * factor + carried[:, None] * (W2 / apart)
        return np.asarray(rows[0] @ modal.shapes @ x + (rows[1] @ base)[:, None])

    def restricted(self, unknowns: NDArray[np.intp]) -> GapForm:
        """Return the form in the unknowns with the given indices."""
        return GapForm(
            tuple(self.unknowns[i] for i in unknowns),
            self.M[unknowns[:, None], unknowns],
            self.K[unknowns],
            self.F[unknowns],
            self.R[unknowns],
            {name: row[unknowns] for name, row in self.observers.items()},
            self.corners[:, unknowns],
        )


def modal_form(form: GapForm) -> ModalForm:
    """Solve K phi = w^2 M phi."""
    frequencies, shapes = graded_modes(form.M, form.K)
    return ModalForm(frequencies, shapes, shapes.T @ form.F, shapes.T @ form.M @ form.R)


def gap_form(block: Block, contact: Contact, base: int, top: int, load: Load) -> GapForm:
    """Assemble the two-block model in contact-gap coordinates."""
    start, end = block.edge(base)
    a = float(np.hypot(*(end - start)))
    axes = base_axes(block, base)
    local = (block.corners - start) @ axes.T - np.array([a / 2, 0.0])
    moments = _moments(area_integrals(local))
    moves = _moves(block.material.contraction)
    rho = block.material.density
    along, away = moves
    weight = rho * (axes @ load.acceleration)
    return GapForm(
        UNKNOWNS,
        rho * (along @ moments @ along.T + away @ moments @ away.T),
        _stiffness(block.material, contact, block.section.area, a),
        _load(local, top, axes, moves, load) + weight @ (moves @ moments[0]) + 0.0,
        np.eye(6, 2) @ (axes * directions_of(load.motion)),
        _observers(_to_block_unknowns(moves, moments[0] / moments[0, 0], axes), contact, a),
        moves @ np.array([[1.0, 1.0], [-a / 2, a / 2], [0.0, 0.0]]),
    )


def _moves(c: float) -> Array:
    """Return the displacements along and away from the base by the unknowns, (2, 6, 3): weights of 1, x' and y'."""
    along = [[1, 0, 0], [0, 0, 0], [0, 0, -1], [0, 1, 0], [0, 0, 0], [0, 0, 1]]
    away = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, -c], [0, 0, 1], [0, 0, 0]]
    return np.array([along, away], dtype=float)


def _moments(i: AreaIntegrals) -> Array:
    """Return the integrals of the products of 1, x' and y', (3, 3), with the zeros of a symmetric shape made exact."""
    x, xy = without_rounding([i.x, i.xy], np.sqrt([i.area * i.xx, i.xx * i.yy])).tolist()
    return np.array([[i.area, x, i.y], [x, i.xx, xy], [i.y, xy, i.yy]])


def free_block(M: Array, block: Block) -> ArrayPair:
    """Return w^2 and shapes, one column a mode, of a block that nothing holds, by its inertia M in its six unknowns.

    In ex, e2 = ey + c ex and gxy, c the free lateral contraction, its stiffness is a diagonal.
    """
    own = np.eye(6)
    own[4, 3] = -block.material.contraction
    k, shapes = free_modes(own.T @ M @ own, elastic_stiffness(block.material, block.section.area))
    return k, own @ shapes


def elastic_stiffness(material: Material, area: float) -> Array:
    """Return the diagonal of a block's own stiffness in (U, w, s, ex, e2, gxy)."""
    return area * np.array([0.0, 0.0, 0.0, material.free_modulus, material.constrained_modulus, material.shear_modulus])


def _stiffness(material: Material, contact: Contact, area: float, a: float) -> Array:
    """Return the diagonal of the stiffness in (U, w, s, ex, e2, gxy)."""
    pn = contact.normal
    ps = contact.shear
    return np.array([2 * ps, 2 * pn, pn * a * a / 2, ps * a * a / 2, 0.0, 0.0]) + elastic_stiffness(material, area)


def _load(local: Array, top: int, axes: Array, moves: Array, load: Load) -> Array:
    """Return the load on the top edge: pressure in global -y, traction in global +x."""
    ends = np.array([local[top], local[(top + 1) % len(local)]])
    pressed = ends
    if load.eccentricity != 0:
        start, end = ends @ axes
        pressed = np.array(pressed_part(start, end, load.eccentricity)) @ axes.T
    extent = np.max(np.abs(local), axis=0)
    right, up = axes.T
    return _edge(pressed, extent, -load.pressure * up, moves) + _edge(ends, extent, load.traction * right, moves)


def _edge(ends: Array, extent: Array, traction: Array, moves: Array) -> Array:
    """Return the load of a uniform traction (local directions) on a straight part of the outline."""
    middle = without_rounding((ends[0] + ends[1]) / 2, extent)
    force = np.hypot(*(ends[1] - ends[0])) * traction
    return np.asarray(force @ (moves @ np.array([1.0, *middle])))


def _to_block_unknowns(moves: Array, centroid: Array, axes: Array) -> Array:
    """Return the 6 x 6 matrix Q of D = Q x, D in global directions about the centroid (1, x', y')."""
    slope = moves[:, :, 1:]
    rotation = (slope[1, :, 0] - slope[0, :, 1]) / 2
    strain = np.einsum("ka,kil,lb->abi", axes, (slope + slope.transpose(2, 1, 0)) / 2, axes)
    return np.array([*(axes.T @ (moves @ centroid)), rotation, strain[0, 0], strain[1, 1], 2 * strain[0, 1]])


def _observers(Q: Array, contact: Contact, a: float) -> Columns:
    """Return the row of every column: the block's unknowns and -2 pn w / a."""
    pressure = np.array([0.0, -2 * contact.normal / a, 0.0, 0.0, 0.0, 0.0])
    return dict(zip((*D_COLUMNS, "contact_pressure"), (*Q, pressure), strict=True))
