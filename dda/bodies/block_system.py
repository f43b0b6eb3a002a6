"""A system of blocks: any number of polygons, locked joints between them and to what is fixed.

The equations are z'' + k z + B' lambda = F and lambda = kappa (B z - G y): blocks that know nothing of each other, each
in its own free modes, and the forces lambda of the joints, which are unknowns of their own. Block stiffness and joint
stiffness are never added, so that stiff joints cost no digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from dda.bodies.gap_form import D_COLUMNS, free_block
from dda.bodies.joints import FIXED, Joint, Point, gap_groups
from dda.linear import elimination
from dda.linear.krylov import amplitudes
from dda.model.arrays import Array, ArrayPair, Columns, without_rounding
from dda.model.block import Block, displacement_rows
from dda.model.load import BaseMotion, directions_of
from dda.result.result import COLUMNS
from dda.scheme.harmonic import Complex, answering
from dda.scheme.newmark import Scheme

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True)
class SurfaceLoad:
    """A uniform traction on a straight piece of a block's boundary, switched on at t = 0."""

    block: int
    start: Point  # [m]
    end: Point  # [m]
    traction: Point  # in x and y [Pa]


@dataclass(frozen=True, eq=False)
class BlockSystem:
    """Blocks, joints and loads.

    Raises
    ------
    ValueError
        If a joint or a load names a block that does not exist, or the observed point lies in no block.
    """

    blocks: Sequence[Block]
    joints: Sequence[Joint]
    observed: Point | None = None  # point whose displacement is reported, the mean where blocks meet [m]
    base_length: float = 1.0  # a, over which the supports' normal force is spread [m]
    loads: Sequence[SurfaceLoad] = ()
    gravity: Point = (0.0, 0.0)  # acceleration in x and y [m/s^2]
    motion: BaseMotion | None = None  # of all that is fixed
    base_normal: Point = (0.0, 1.0)  # unit normal of the supports, into the blocks

    def __post_init__(self) -> None:
        joined = {b for joint in self.joints for b in (joint.first, joint.second) if b != FIXED}
        joined |= {load.block for load in self.loads}
        unknown = [b for b in joined if not 0 <= b < len(self.blocks)]
        if unknown:
            raise ValueError(f"joints: must name blocks from 0 to {len(self.blocks) - 1}, got {unknown[0]!r}")
        if self.observed is not None and not self.blocks_at(self.observed):
            raise ValueError(f"observed: must lie in a block, got {self.observed!r}")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all columns: with an observed point those of one block."""
        return COLUMNS if self.observed is not None else ("contact_pressure",)

    @property
    def moving(self) -> Array:
        """Whether what is fixed moves in x and in y, 1 or 0 each."""
        return directions_of(self.motion)

    @cached_property
    def load_size(self) -> float:
        """Largest of the constant loads as a stress, 1 Pa where the base alone acts [Pa]."""
        weight = max(b.material.density * math.sqrt(b.section.area) for b in self.blocks) * math.hypot(*self.gravity)
        size = max([weight, *(math.hypot(*load.traction) for load in self.loads)])
        return 1.0 if size == 0 and self.motion is not None else size

    @cached_property
    def equations(self) -> Equations:
        """The equations in all six modes of every block that moves."""
        k, modes, rigid = zip(*(_free_block(block) for block in self.blocks), strict=True)
        shapes = _block_diagonal(modes)
        B, G, kappa, C = _springs(self.blocks, self.joints)
        observers = {}
        if self.observed is not None:
            observers = dict(zip(D_COLUMNS, self.rows_at(self.observed) @ shapes, strict=True))
        return Equations(
            k=np.concatenate(k),
            shapes=shapes,
            rigid=np.concatenate(rigid),
            scale=float(np.max(k)),
            B=(B @ shapes).tocsr(),
            G=G if self.motion is not None else 0 * G,
            kappa=kappa,
            C=C,
            F=shapes.T @ self._load() / (self.load_size or 1.0),
            inertia=np.concatenate(rigid) @ np.array([*(self.moving if np.any(self.moving) else (0.0, 1.0)), 0.0]),
            observers=observers,
            pressure=-(G @ np.array(self.base_normal)) / self.base_length,
        )

    @cached_property
    def reached(self) -> Equations:
        """The equations without the modes and gaps that no load can reach."""
        return self.equations.reduced()

    def _load(self) -> Array:
        """Return surface loads and weights, six for each block."""
        F = np.zeros((len(self.blocks), 6))
        for i, block in enumerate(self.blocks):
            F[i, :2] = block.total_mass * np.array(self.gravity)
        for load in self.loads:
            block = self.blocks[load.block]
            acting = block.segment_load(np.array(load.start), np.array(load.end), load.traction)
            lever = np.minimum(_levers(block), 1.0)
            F[load.block] += without_rounding(acting, np.max(np.abs(acting)) * lever)
        return F.ravel()

    def blocks_at(self, point: Point) -> list[int]:
        """Return the numbers of the blocks that hold a point, their boundaries included."""
        return [i for i, block in enumerate(self.blocks) if _holds(block.corners, np.array(point))]

    def rows_at(self, point: Point) -> Array:
        """Return the rows of displacements, rotation and strains at a point, the mean where blocks meet, (6, 6 blocks).

        A ValueError if no block holds it.
        """
        rows = np.zeros((6, len(self.blocks), 6))
        numbers = self.blocks_at(point)
        if not numbers:
            raise ValueError(f"point: must lie in a block, got {point!r}")
        for i in numbers:
            block = self.blocks[i]
            rows[:2, i] = without_rounding(block.T(*point), _levers(block)) / len(numbers)
            rows[2:, i, 2:] = np.eye(4) / len(numbers)
        return rows.reshape(6, -1)


@dataclass(frozen=True, eq=False)
class Equations:
    """z'' + k z + B' lambda = F, B z - C lambda = G y in the free modes of the blocks, D = shapes z; C = kappa^-1.

    The load is of unit size. At rest the equations have the matrix `saddle` for z and for lambda over `scale`.
    """

    k: Array  # (modes,) [1/s^2]
    shapes: csr_array  # (6 blocks, modes)
    rigid: Array  # (modes, 3) momentum of unit velocities in x and y, and of a unit turn of everything
    scale: float  # largest k of all modes
    B: csr_array  # (gaps, modes)
    G: Array  # (gaps, 2)
    kappa: csr_array  # (gaps, gaps) [N/m]
    C: csr_array  # (gaps, gaps) [m/N]
    F: Array  # (modes,)
    inertia: Array  # (modes,) load of a unit acceleration of the base, or upwards
    observers: Columns  # column -> (modes,) row
    pressure: Array  # (gaps,) row of the contact pressure by lambda [1/m]

    @cached_property
    def saddle(self) -> csr_array:
        """The matrix of the equations at rest, in moduli near one."""
        from scipy.sparse import block_array, diags_array

        return block_array([[diags_array(self.k / self.scale), self.B.T], [self.B, -self.scale * self.C]], format="csr")

    @cached_property
    def _factor(self) -> Callable[[Array], Array]:
        return factor(self.saddle, definite=False)

    def at_rest(self, F: Array, g: Array) -> ArrayPair:
        """Return z and lambda of k z + B' lambda = F, B z - C lambda = g; the matrix is factorised once."""
        solution = self._factor(np.concatenate([F / self.scale, g]))
        return solution[: len(F)], self.scale * solution[len(F) :]

    def at_base(self, F: Array, base: Array) -> ArrayPair:
        """Return z and lambda at rest, where what is fixed has moved by (x, y) [m]."""
        return self.at_rest(F, self.G @ base)

    def pushed(self, size: float) -> Array:
        """Return the load that shares refer to: the constant one, else the inertia."""
        return self.F if np.any(self.F) else self.inertia

    def steady(
        self, rows: ArrayPair, F: Array, base: Array, scheme: Scheme, frequencies: ArrayLike, exact: bool
    ) -> Complex:
        """Return what rows observe of a steady vibration, (rows, frequencies)."""
        W2, factor = answering(scheme, frequencies, exact)
        return np.asarray(amplitudes(self, rows, F, self.G @ base, W2) * factor)

    def lowest(self, count: int) -> tuple[Array, Array, Array]:
        """Return the lowest w^2, their normalised shapes and the joint forces of the shapes.

        K^-1 is applied by the saddle-point solver, so that stiff joints cost no digits.
        """
        from scipy.linalg import eigh
        from scipy.sparse.linalg import LinearOperator, eigsh

        n = len(self.k)
        still = np.zeros(len(self.pressure))

        def flexibility(right: Array) -> Array:
            return self.at_rest(np.ravel(right), still)[0]

        if n <= elimination.DENSE or count >= n - 1:
            values, shapes = eigh(np.array([flexibility(unit) for unit in np.eye(n)]))
        else:
            start = np.random.default_rng(0).standard_normal(n)
            values, shapes = eigsh(LinearOperator((n, n), matvec=flexibility, dtype=float), count, v0=start)
        order = np.argsort(-values)[:count]
        squares = 1 / values[order]
        shapes = shapes[:, order]
        forces = [self.at_rest(w2 * phi, still)[1] for w2, phi in zip(squares, shapes.T, strict=True)]
        return squares, shapes, np.array(forces).T

    def largest(self) -> float:
        """Return the highest natural frequency, joints included [rad/s]."""
        from scipy.sparse import diags_array

        K = diags_array(self.k) + self.B.T @ self.kappa @ self.B
        return elimination.largest_frequency(K.tocsr())

    def reduced(self) -> Equations:
        """Return the equations without the modes and gaps that no load can reach.

        Reach is the connectivity of the structural non-zeros of B and kappa.
        """
        from scipy.sparse import block_array
        from scipy.sparse.csgraph import connected_components

        pattern = block_array([[None, abs(self.B).T], [abs(self.B), abs(self.kappa)]], format="csr")
        _, label = connected_components(pattern, directed=False)
        loaded = np.concatenate([self.F != 0, np.any(self.G != 0, axis=1)])
        reached = np.isin(label, label[loaded])
        if reached.all() or not loaded.any():
            return self
        modes = reached[: len(self.k)]
        gaps = reached[len(self.k) :]
        return replace(
            self,
            k=self.k[modes],
            shapes=self.shapes[:, modes],
            rigid=self.rigid[modes],
            B=self.B[gaps][:, modes],
            G=self.G[gaps],
            kappa=self.kappa[gaps][:, gaps],
            C=self.C[gaps][:, gaps],
            F=self.F[modes],
            inertia=self.inertia[modes],
            observers={name: row[modes] for name, row in self.observers.items()},
            pressure=self.pressure[gaps],
        )

    def rows(self, columns: Sequence[str]) -> ArrayPair:
        """Return the rows of some columns by z and by lambda."""
        by_modes = np.zeros((len(columns), len(self.k)))
        by_force = np.zeros((len(columns), len(self.pressure)))
        for i, name in enumerate(columns):
            if name == "contact_pressure":
                by_force[i] = self.pressure
            else:
                by_modes[i] = self.observers[name]
        return by_modes, by_force


def factor(matrix: csr_array, definite: bool = True) -> Callable[[Array], Array]:
    """Return the solver of a sparse symmetric matrix; a definite one keeps diagonal pivots and symmetric fill-in."""
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    options: dict[str, Any] = {
        "permc_spec": "MMD_AT_PLUS_A",
        "diag_pivot_thresh": 0.0,
        "options": {"SymmetricMode": True},
    }
    solve: Callable[[Array], Array] = splu(csc_array(matrix), **(options if definite else {})).solve
    return solve


def _free_block(block: Block) -> tuple[Array, Array, Array]:
    """Return k and shapes of a block in its free modes, and their momentum in rigid motions of everything."""
    mass = _without_rounding(block.mass())
    k, shapes = free_block(mass, block)
    motions = np.eye(6, 3)
    motions[:2] = displacement_rows(*block.section.centroid)[:, :3]
    return k, shapes, shapes.T @ mass @ motions


def _springs(blocks: Sequence[Block], joints: Sequence[Joint]) -> tuple[csr_array, Array, csr_array, csr_array]:
    """Return B by the unknowns of the blocks, G, kappa and its inverse."""
    from scipy.sparse import csr_array

    groups = gap_groups(blocks, joints)
    firsts = np.cumsum([0, *(len(group.stiffness) for group in groups)])
    G = np.zeros((firsts[-1], 2))
    data = [np.zeros(0)]
    places = [np.zeros((2, 0), dtype=int)]
    for first, group in zip(firsts.tolist(), groups, strict=False):
        for body, rows in group.bodies.items():
            if body == FIXED:
                G[first : first + len(rows)] -= rows
            else:
                place = np.array(np.nonzero(rows))
                data.append(rows[*place])
                places.append(np.add(place, [[first], [6 * body]]))
    B = csr_array((np.concatenate(data), np.concatenate(places, axis=1)), shape=(len(G), 6 * len(blocks)))
    stiffness = [group.stiffness for group in groups]
    return B, G, _block_diagonal(stiffness), _block_diagonal([_inverse(kappa) for kappa in stiffness])


def _block_diagonal(blocks: Sequence[Array]) -> csr_array:
    """Return the matrix with blocks on its diagonal, without their zeros."""
    from scipy.sparse import block_diag, csr_array

    return block_diag([csr_array((0, 0)), *map(csr_array, blocks)], format="csr")


def _inverse(matrix: Array) -> Array:
    """Return the inverse of a positive definite matrix, scaled so that a widely spread diagonal keeps its digits."""
    root = np.sqrt(np.diag(matrix))
    scale = np.outer(root, root)
    return np.asarray(np.linalg.inv(matrix / scale) / scale)


def _without_rounding(M: Array) -> Array:
    """Return a positive definite matrix with the zeros of a symmetric shape made exact."""
    root = np.sqrt(np.diag(M))
    return without_rounding(M, np.outer(root, root))


def _levers(block: Block) -> Array:
    """Return the size of the displacement of a block's points by its unknowns, by which a symmetric place has zeros."""
    return np.array([1.0, 1.0, *[np.max(np.ptp(block.corners, axis=0))] * 4])


def _holds(corners: Array, point: Array) -> bool:
    """Tell whether a polygon holds a point, its boundary included."""
    slack = 1e-9 * np.max(np.ptp(corners, axis=0))
    start = (corners - point) @ np.array([1, 1j])  # in the plane of complex numbers
    end = np.roll(start, -1)
    side = end - start
    along = np.clip(-(start / side).real, 0, 1)
    if np.min(np.abs(start + along * side)) <= slack:
        return True
    return bool(abs(np.sum(np.angle(end / start))) > math.pi)
