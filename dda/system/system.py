"""A system of blocks: any number of polygons, locked joints between them and to what is fixed.

The equations are M D'' + Ke D + B' lambda = F and lambda = kappa (B D - G y): blocks that know
nothing of each other, and the forces lambda of the joints, which are unknowns of their own. Block
stiffness and joint stiffness are never added, so that stiff joints cost no digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dda.model.arrays import Array, without_rounding
from dda.model.block import Block
from dda.model.load import BaseMotion, falling
from dda.one_block.gap_form import D_COLUMNS
from dda.system.joints import FIXED, Joint, gap_groups

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True)
class SurfaceLoad:
    """A uniform traction on a straight piece of a block's boundary, switched on at t = 0."""

    block: int
    start: tuple[float, float]  # [m]
    end: tuple[float, float]  # [m]
    traction: tuple[float, float]  # in x and y [Pa]


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
    observed: tuple[float, float] | None = None  # point whose displacement is reported, the mean where blocks meet [m]
    base_length: float = 1.0  # a, over which the supports' normal force is spread [m]
    loads: Sequence[SurfaceLoad] = ()
    gravity: float = 0.0  # downwards [m/s^2]
    motion: BaseMotion | None = None  # of all that is fixed
    base_normal: tuple[float, float] = (0.0, 1.0)  # unit normal of the supports, into the blocks
    slope: float = 0.0  # by which gravity is turned, to g (sin, -cos) [deg]

    def __post_init__(self) -> None:
        """Check that every block that is named exists."""
        joined = {b for joint in self.joints for b in (joint.first, joint.second) if b != FIXED}
        joined |= {load.block for load in self.loads}
        unknown = [b for b in joined if not 0 <= b < len(self.blocks)]
        if unknown:
            raise ValueError(f"joints: must name blocks from 0 to {len(self.blocks) - 1}, got {unknown[0]!r}")
        if self.observed is not None and not self.blocks_at(self.observed):
            raise ValueError(f"observed: must lie in a block, got {self.observed!r}")

    @cached_property
    def load_size(self) -> float:
        """Largest of the constant loads as a stress, 1 Pa where the base alone acts [Pa]."""
        weight = max(b.material.density * math.sqrt(b.section.area) for b in self.blocks) * abs(self.gravity)
        size = max([weight, *(math.hypot(*load.traction) for load in self.loads)])
        return 1.0 if size == 0 and self.motion is not None else size

    @cached_property
    def equations(self) -> Equations:
        """The equations in all six unknowns of every block that moves."""
        B, G, kappa, C = _springs(self.blocks, self.joints)
        size = self.load_size or 1.0
        return Equations(
            mass=np.array([_without_rounding(block.mass()) for block in self.blocks]),
            elastic=np.array([block.elastic() for block in self.blocks]),
            B=B,
            G=G if self.motion is not None else 0 * G,
            kappa=kappa,
            C=C,
            F=self._load() / size,
            observers=self._observers(),
            pressure=-(G @ np.array(self.base_normal)) / self.base_length,
            kept=np.arange(6 * len(self.blocks)),
        )

    @cached_property
    def reached(self) -> Equations:
        """The equations without the unknowns and gaps that no load can reach."""
        return self.equations.reduced()

    def _load(self) -> Array:
        """Return surface loads and weights, six for each block."""
        F = np.zeros((len(self.blocks), 6))
        for i, block in enumerate(self.blocks):
            F[i, :2] = block.material.density * block.section.area * self.gravity * np.array(falling(self.slope))
        for load in self.loads:
            block = self.blocks[load.block]
            acting = block.segment_load(np.array(load.start), np.array(load.end), load.traction)
            lever = np.minimum(_levers(block), 1.0)
            F[load.block] += without_rounding(acting, np.max(np.abs(acting)) * lever)
        return F.ravel()

    def blocks_at(self, point: tuple[float, float]) -> list[int]:
        """Return the numbers of the blocks that hold a point, their boundaries included."""
        return [i for i, block in enumerate(self.blocks) if _holds(block.corners, np.array(point))]

    def _observers(self) -> dict[str, Array]:
        """Return the rows of the displacements, rotation and strains at the observed point."""
        if self.observed is None:
            return {}
        rows = np.zeros((6, len(self.blocks), 6))
        numbers = self.blocks_at(self.observed)
        share = 1 / len(numbers)
        for i in numbers:
            block = self.blocks[i]
            rows[:2, i] = share * without_rounding(block.T(*self.observed), _levers(block))
            rows[2:, i, 2:] = share * np.eye(4)
        return dict(zip(D_COLUMNS, rows.reshape(6, -1), strict=True))


@dataclass(frozen=True, eq=False)
class Equations:
    """M D'' + Ke D + B' lambda = F, B D - C lambda = G y, for a load of unit size; C = kappa^-1."""

    mass: Array  # (blocks, 6, 6)
    elastic: Array  # (blocks, 6, 6) [N/m, N, N m]
    B: csr_array  # (gaps, unknowns)
    G: Array  # (gaps, 2)
    kappa: csr_array  # (gaps, gaps) [N/m]
    C: csr_array  # (gaps, gaps) [m/N]
    F: Array  # (unknowns,)
    observers: dict[str, Array]  # column -> (unknowns,) row
    pressure: Array  # (gaps,) row of the contact pressure by lambda [1/m]
    kept: NDArray[np.intp]  # unknowns, numbered 6 block + component

    def blockwise(self, matrices: Array) -> csr_array:
        """Return a matrix of 6 x 6 blocks as a sparse one in the kept unknowns."""
        from scipy.sparse import csr_array

        block, i, k = np.nonzero(matrices)
        size = 6 * len(matrices)
        full = csr_array((matrices[block, i, k], (6 * block + i, 6 * block + k)), shape=(size, size))
        return full if len(self.kept) == size else full[self.kept][:, self.kept]

    @cached_property
    def at_rest(self) -> Callable[[Array, Array], tuple[Array, Array]]:
        """The solver (F, g) -> (D, lambda) of Ke D + B' lambda = F, B D - C lambda = g, factorised once."""
        return saddle(self.blockwise(self.elastic), self.B, self.C, modulus_of(self))

    def reduced(self) -> Equations:
        """Return the equations without the unknowns and gaps that no load can reach.

        Reach is the connectivity of the structural non-zeros of M, Ke, B and kappa.
        """
        from scipy.sparse import block_array
        from scipy.sparse.csgraph import connected_components

        own = abs(self.blockwise(self.mass)) + abs(self.blockwise(self.elastic))
        pattern = block_array([[own, abs(self.B).T], [abs(self.B), abs(self.kappa)]], format="csr")
        _, label = connected_components(pattern, directed=False)
        loaded = np.concatenate([self.F != 0, np.any(self.G != 0, axis=1)])
        reached = np.isin(label, label[loaded])
        n = len(self.F)
        return self if reached.all() or not loaded.any() else self._restricted(reached[:n], reached[n:])

    def _restricted(self, unknowns: NDArray[np.bool_], gaps: NDArray[np.bool_]) -> Equations:
        return replace(
            self,
            B=self.B[gaps][:, unknowns],
            G=self.G[gaps],
            kappa=self.kappa[gaps][:, gaps],
            C=self.C[gaps][:, gaps],
            F=self.F[unknowns],
            observers={name: row[unknowns] for name, row in self.observers.items()},
            pressure=self.pressure[gaps],
            kept=self.kept[unknowns],
        )

    def rows(self, columns: Sequence[str]) -> tuple[Array, Array]:
        """Return the rows of some columns by D and by lambda."""
        by_D = np.zeros((len(columns), len(self.F)))
        by_force = np.zeros((len(columns), len(self.pressure)))
        for i, name in enumerate(columns):
            if name == "contact_pressure":
                by_force[i] = self.pressure
            else:
                by_D[i] = self.observers[name]
        return by_D, by_force


def modulus_of(equations: Equations) -> float:
    """Return the largest modulus, by which forces are scaled to the size of displacements."""
    return float(np.max(np.abs(equations.elastic)))


@dataclass
class Factor:
    """A factorised sparse symmetric matrix and its size."""

    solve: Callable[[Array], Array]
    nonzeros: int


def factor(matrix: csr_array, definite: bool = True) -> Factor:
    """Factorise a matrix; a definite one keeps its diagonal pivots and its symmetric fill-in."""
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    options: dict[str, Any] = {
        "permc_spec": "MMD_AT_PLUS_A",
        "diag_pivot_thresh": 0.0,
        "options": {"SymmetricMode": True},
    }
    lu = splu(csc_array(matrix), **(options if definite else {}))
    return Factor(lu.solve, int(matrix.nnz))


def saddle(Ke: csr_array, B: csr_array, C: csr_array, modulus: float) -> Callable[[Array, Array], tuple[Array, Array]]:
    """Return the solver of Ke D + B' lambda = F, B D - C lambda = g, in moduli near one.

    Parameters
    ----------
    modulus : float
        Size of the entries of Ke, by which forces are scaled.
    """
    from scipy.sparse import block_array

    lu = factor(block_array([[Ke / modulus, B.T], [B, -modulus * C]], format="csr"), definite=False)
    n = Ke.shape[0]

    def solve(F: Array, g: Array) -> tuple[Array, Array]:
        solution = lu.solve(np.concatenate([F / modulus, g]))
        return solution[:n], modulus * solution[n:]

    return solve


def _springs(blocks: Sequence[Block], joints: Sequence[Joint]) -> tuple[csr_array, Array, csr_array, csr_array]:
    """Return B, G, kappa and its inverse."""
    from scipy.sparse import csr_array

    groups = gap_groups(blocks, joints)
    total = sum(len(group.stiffness) for group in groups)
    G = np.zeros((total, 2))
    entries: list[tuple[Array, NDArray[np.intp], NDArray[np.intp]]] = []
    first = 0
    for group in groups:
        last = first + len(group.stiffness)
        for body, rows in group.bodies.items():
            if body == FIXED:
                G[first:last] -= rows
            else:
                i, k = np.nonzero(rows)
                entries.append((rows[i, k], first + i, 6 * body + k))
        first = last
    if not groups:
        return csr_array((0, 6 * len(blocks))), G, csr_array((0, 0)), csr_array((0, 0))
    data, i, k = (np.concatenate(part) for part in zip(*entries, strict=True))
    B = csr_array((data, (i, k)), shape=(total, 6 * len(blocks)))
    stiffness = [group.stiffness for group in groups]
    return B, G, _block_diagonal(stiffness), _block_diagonal([inverses(kappa[None])[0] for kappa in stiffness])


def _block_diagonal(blocks: Sequence[Array]) -> csr_array:
    """Return the matrix with square blocks on its diagonal, without their zeros."""
    from scipy.sparse import block_diag, coo_array, csr_array

    return csr_array(block_diag([coo_array(block) for block in blocks]))  # whose zeros are not stored


def inverses(matrices: Array) -> Array:
    """Return the inverses of positive definite matrices, scaled so that widely spread diagonals keep their digits."""
    root = np.sqrt(np.einsum("nii->ni", matrices))
    scale = root[:, :, None] * root[:, None, :]
    return np.asarray(np.linalg.inv(matrices / scale) / scale)


def _without_rounding(M: Array) -> Array:
    """Return a positive definite matrix with the zeros of a symmetric shape made exact."""
    root = np.sqrt(np.diag(M))
    return without_rounding(M, np.outer(root, root))


def _levers(block: Block) -> Array:
    """Return the size of the displacement of a block's points by its unknowns, by which a symmetric place has zeros."""
    return np.array([1.0, 1.0, *[float(np.max(np.ptp(block.corners, axis=0)))] * 4])


def _holds(corners: Array, point: Array) -> bool:
    """Tell whether a polygon holds a point, its boundary included."""
    slack = 1e-9 * float(np.max(np.ptp(corners, axis=0)))
    a = corners - point
    b = np.roll(corners, -1, axis=0) - point
    side = b - a
    along = np.clip(-np.sum(a * side, axis=1) / np.sum(side * side, axis=1), 0, 1)
    if np.min(np.hypot(*(a + along[:, None] * side).T)) <= slack:
        return True
    turn = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], np.sum(a * b, axis=1))
    return bool(abs(np.sum(turn)) > math.pi)
