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

from dda.model.arrays import Array
from dda.model.block import Block
from dda.model.load import BaseMotion, falling
from dda.one_block.gap_form import D_COLUMNS
from dda.system.joints import FIXED, Joint, gap_groups

if TYPE_CHECKING:
    from scipy.sparse import csr_array

_ROUNDING = 64 * np.finfo(float).eps


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
    observed: tuple[float, float]  # point whose displacement is reported, the mean where blocks meet [m]
    base_length: float  # a, over which the supports' normal force is spread [m]
    loads: Sequence[SurfaceLoad] = ()
    gravity: float = 0.0  # downwards [m/s^2]
    motion: BaseMotion | None = None  # of all that is fixed
    fixed: frozenset[int] = frozenset()  # blocks that do not move by themselves
    base_normal: tuple[float, float] = (0.0, 1.0)  # unit normal of the supports, into the blocks
    slope: float = 0.0  # by which gravity is turned, to g (sin, -cos) [deg]

    def __post_init__(self) -> None:
        """Check that every block that is named exists."""
        joined = {b for joint in self.joints for b in (joint.first, joint.second) if b != FIXED}
        joined |= {load.block for load in self.loads} | set(self.fixed)
        unknown = [b for b in joined if not 0 <= b < len(self.blocks)]
        if unknown:
            raise ValueError(f"joints: must name blocks from 0 to {len(self.blocks) - 1}, got {unknown[0]!r}")
        if not self._blocks_at_point:
            raise ValueError(f"observed: must lie in a block that moves, got {self.observed!r}")

    @cached_property
    def load_size(self) -> float:
        """Largest of the constant loads as a stress, 1 Pa where the base alone acts [Pa]."""
        weight = max(b.material.density * math.sqrt(b.section.area) for b in self.blocks) * abs(self.gravity)
        size = max([weight, *(math.hypot(*load.traction) for load in self.loads)])
        return 1.0 if size == 0 and self.motion is not None else size

    @cached_property
    def equations(self) -> Equations:
        """The equations in all six unknowns of every block that moves."""
        moving = [i for i in range(len(self.blocks)) if i not in self.fixed]
        place = dict(zip(moving, range(len(moving)), strict=True)) | dict.fromkeys((*self.fixed, FIXED), FIXED)
        blocks = [self.blocks[i] for i in moving]
        joints = [replace(j, first=place[j.first], second=place[j.second]) for j in self.joints]
        joints = [j for j in joints if j.first != j.second]
        B, G, kappa, C = _springs(blocks, joints)
        size = self.load_size or 1.0
        return Equations(
            mass=np.array([_without_rounding(block.mass()) for block in blocks]).reshape(-1, 6, 6),
            elastic=np.array([block.elastic() for block in blocks]).reshape(-1, 6, 6),
            B=B,
            G=G if self.motion is not None else 0 * G,
            kappa=kappa,
            C=C,
            F=self._load(blocks, place) / size,
            observers=self._observers(len(blocks), place),
            pressure=-(G @ np.array(self.base_normal)) / self.base_length,
            kept=np.arange(6 * len(blocks)),
        )

    @cached_property
    def reached(self) -> Equations:
        """The equations without the unknowns and gaps that no load can reach."""
        return self.equations.reduced()

    def _load(self, blocks: Sequence[Block], place: dict[int, int]) -> Array:
        """Return surface loads and weights, six for each block."""
        F = np.zeros((len(blocks), 6))
        for i, block in enumerate(blocks):
            F[i, :2] = block.material.density * block.section.area * self.gravity * np.array(falling(self.slope))
        for load in self.loads:
            i = place[load.block]
            if i != FIXED:
                start, end = np.array(load.start), np.array(load.end)
                F[i] += _without_noise(blocks[i], blocks[i].segment_load(start, end, load.traction))
        return F.ravel()

    @cached_property
    def _blocks_at_point(self) -> list[int]:
        found = [i for i, block in enumerate(self.blocks) if _holds(block.corners, np.array(self.observed))]
        return [i for i in found if i not in self.fixed]

    def _observers(self, count: int, place: dict[int, int]) -> dict[str, Array]:
        """Return the rows of the displacements, rotation and strains at the observed point."""
        rows = np.zeros((6, count, 6))
        share = 1 / len(self._blocks_at_point)
        for i in self._blocks_at_point:
            rows[:2, place[i]] = share * _without_noise(self.blocks[i], self.blocks[i].T(*self.observed))
            rows[2:, place[i], 2:] = share * np.eye(4)
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
        full = _sparse_blocks(matrices)
        return full if len(self.kept) == full.shape[0] else full[self.kept][:, self.kept]

    @cached_property
    def at_rest(self) -> Callable[[Array, Array], tuple[Array, Array]]:
        """The solver (F, g) -> (D, lambda) of Ke D + B' lambda = F, B D - C lambda = g, factorised once."""
        return saddle(self.blockwise(self.elastic), self.B, self.C, float(np.max(np.abs(self.elastic))))

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
        nothing, none = np.zeros(len(self.F)), np.zeros(len(self.pressure))
        by_D = [self.observers.get(name, nothing) for name in columns]
        by_force = [self.pressure if name == "contact_pressure" else none for name in columns]
        shape = len(columns), len(self.F)
        return np.array(by_D).reshape(shape), np.array(by_force).reshape(len(columns), len(self.pressure))


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
    from scipy.sparse import coo_array, csr_array

    groups = gap_groups(blocks, joints)
    total = sum(len(group.stiffness) for group in groups)
    G, entries, first = np.zeros((total, 2)), [], 0
    for group in groups:
        last = first + len(group.stiffness)
        for body, rows in group.bodies.items():
            if body == FIXED:
                G[first:last] -= rows
            else:
                i, k = np.nonzero(rows)
                entries.append((rows[i, k], first + i, 6 * body + k))
        first = last
    data, i, k = (np.concatenate(part) for part in zip(*entries, strict=True)) if entries else np.zeros((3, 0), int)
    B = csr_array(coo_array((data, (i, k)), shape=(total, 6 * len(blocks))))
    if not groups:
        empty = csr_array((0, 0))
        return B, G, empty, empty
    stiffness = [group.stiffness for group in groups]
    return B, G, _block_diagonal(stiffness), _block_diagonal(_inverses_of(stiffness))


def _block_diagonal(blocks: Sequence[Array]) -> csr_array:
    """Return the matrix with square blocks on its diagonal, without their zeros."""
    from scipy.sparse import block_diag, coo_array, csr_array

    return csr_array(block_diag([coo_array(block) for block in blocks]))  # whose zeros are not stored


def _inverses_of(matrices: Sequence[Array]) -> list[Array]:
    """Return the inverses of positive definite matrices of several sizes, all of one size at a time."""
    found: dict[int, Array] = {}
    for size in {len(matrix) for matrix in matrices}:
        same = [n for n, matrix in enumerate(matrices) if len(matrix) == size]
        found |= dict(zip(same, inverses(np.array([matrices[n] for n in same])), strict=True))
    return [found[n] for n in range(len(matrices))]


def inverses(matrices: Array) -> Array:
    """Return the inverses of positive definite matrices, scaled so that widely spread diagonals keep their digits."""
    root = np.sqrt(np.einsum("nii->ni", matrices))
    scale = root[:, :, None] * root[:, None, :]
    inverse: Array = np.linalg.inv(matrices / scale) / scale
    return inverse


def _sparse_blocks(matrices: Array) -> csr_array:
    from scipy.sparse import coo_array, csr_array

    block, i, k = np.nonzero(matrices)
    size = 6 * len(matrices)
    return csr_array(coo_array((matrices[block, i, k], (6 * block + i, 6 * block + k)), shape=(size, size)))


def _without_rounding(M: Array) -> Array:
    """Return a positive definite matrix with the zeros of a symmetric shape made exact."""
    root = np.sqrt(np.diag(M))
    cleaned: Array = np.where(abs(M) <= _ROUNDING * np.outer(root, root), 0.0, M)
    return cleaned


def _without_noise(block: Block, rows: Array) -> Array:
    """Return rows by the unknowns with the zeros of a symmetric place made exact: a lever is never that short."""
    lever = np.array([1.0, 1.0, *[float(np.max(np.ptp(block.corners, axis=0)))] * 4])
    size = np.max(np.abs(rows), initial=0.0) if rows.ndim == 1 else 1.0
    scale = size * (lever if rows.ndim == 2 else np.minimum(lever, 1.0))
    cleaned: Array = np.where(abs(rows) <= _ROUNDING * scale, 0.0, rows)
    return cleaned


def _holds(corners: Array, point: Array) -> bool:
    """Tell whether a polygon holds a point, its boundary included."""
    slack = 1e-9 * float(np.max(np.ptp(corners, axis=0)))
    a, b = corners - point, np.roll(corners, -1, axis=0) - point
    side = b - a
    along = np.clip(-np.sum(a * side, axis=1) / np.sum(side * side, axis=1), 0, 1)
    if np.min(np.hypot(*(a + along[:, None] * side).T)) <= slack:
        return True
    turn = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], np.sum(a * b, axis=1))
    return bool(abs(np.sum(turn)) > math.pi)
