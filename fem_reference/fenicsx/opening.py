"""Contact that carries no tension, on the nodes of the base, in the Newmark step of the block without springs.

A1 = S^-1 (F - K D* + B' lambda) with the forces lambda = (N, T) of the nodes on the block, which are unknown: the free
block, lambda = 0, gives the gaps w_f and slips s_f at the end of the step, C = alpha dt^2 B S^-1 B' what forces add.
Then each node is open, N = T = 0 and w >= 0, or closed,

    N + k w = 0,  N >= 0,     T + k_t phi (s - r) = 0,

with r the slip at which its shear spring is unstrained. For a node that closes in the step that is the slip where its
gap, taken as straight in time, is zero: phi = w1 / (w1 - w0) with r the slip at the start; phi = 1 otherwise.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import ufl
from petsc4py import PETSc

from .model import BASE, COMM, Block, Inapplicable, Request, constant
from .newmark import Factor

TRIED = 8  # nodes of which all states are tried
SWEEPS = 200  # corrections of the crossings for given states
SHORTEST = 0.01  # of the step
NONE, SEVERAL = "no consistent contact state", "several consistent contact states"
COLUMNS = ("contact_pressure", "base_shear", "open_share", "largest_gap", "largest_penetration", "solves", "cuts")


class Base:
    """The nodes of the base that bear springs, in their order along it and alike on every rank."""

    def __init__(self, block: Block, request: Request) -> None:
        self.normal, self.tangent = block.normal, block.tangent
        self.block, self.length = block, block.outline.side(0)[2]
        found = COMM.allgather(self._owned(request))
        numbers, along, share = (np.concatenate([part[i] for part in found]) for i in range(3))
        order = np.argsort(along)
        self.share = share[order]
        self.k, self.k_t = (2 * request[name] * self.share for name in ("stiffness", "shear_stiffness"))
        self._places = (2 * numbers[order][:, None] + np.array([0, 1])).ravel().astype(np.int32)
        self._seen = PETSc.Vec().createSeq(len(self._places))
        rows = PETSc.IS().createGeneral(self._places, comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(block.K.createVecRight(), rows, self._seen, None)

    def _owned(self, request: Request) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Number, place along the base and share of it of each of this rank's nodes; the shares add up to one.

        The integral of a node's shape function over the base is its share of the length.
        """
        block, owned = self.block, self.block.space.dofmap.index_map
        first, end = owned.local_range
        share = np.zeros(end - first)
        if request["foundation"] == "corner":
            for pair in block._corners():
                share[pair[0] // 2 - first] = 0.5
        elif request["foundation"] == "distributed":
            way = ufl.dot(constant(block.mesh, self.normal), ufl.TestFunction(block.space))
            parts = block._vector(way * block.ds(BASE)).array.reshape(-1, 2) @ self.normal
            share = np.where(parts > 1e-10 * self.length, parts / self.length, 0.0)
        else:
            raise Inapplicable(f"unilateral contact on a foundation {request['foundation']!r} is not in fenicsx")
        kept = np.flatnonzero(share)
        places = block.space.tabulate_dof_coordinates()[: end - first, :2]
        return kept + first, places[kept] @ self.tangent, share[kept]

    def moved(self, D: Any) -> tuple[np.ndarray, np.ndarray]:
        """Displacements of the nodes normal to the base and along it."""
        self._scatter.scatter(D, self._seen, mode=PETSc.ScatterMode.FORWARD)
        pairs = np.array(self._seen.array).reshape(-1, 2)
        return pairs @ self.normal, pairs @ self.tangent

    def load(self, N: np.ndarray, T: np.ndarray) -> Any:
        """B' (N, T)."""
        found = self.block.K.createVecRight()
        if COMM.rank == 0:
            values = np.outer(N, self.normal) + np.outer(T, self.tangent)
            found.setValues(self._places, values.ravel(), addv=PETSc.InsertMode.ADD_VALUES)
        found.assemble()
        return found


class Forces(NamedTuple):
    """Forces and gaps for given states of the nodes."""

    N: np.ndarray
    T: np.ndarray
    w: np.ndarray
    closed: np.ndarray
    settled: bool = True

    def wanted(self) -> np.ndarray:
        """States that the forces and gaps ask for."""
        return np.asarray(np.where(self.closed, self.N >= 0, self.w < 0))


class Small:
    """The small problem of one step."""

    def __init__(self, base: Base, C: np.ndarray, free: tuple[np.ndarray, np.ndarray], start: dict[str, Any]) -> None:
        self.base, self.C, (self.w, self.s), self.start = base, C, free, start
        self.n = len(base.share)
        self.glued = len(C) > self.n

    def forces(self, closed: np.ndarray) -> Forces:
        """Forces of given states, with the crossings that they bring about."""
        closing = closed & ~self.start["closed"] if self.glued else np.zeros(self.n, bool)
        phi, relax, least = np.where(closing, 0.5, 1.0), 1.0, np.inf
        for _ in range(SWEEPS):
            found = self._linear(closed, phi)
            depth = np.maximum(found.N, 0.0) / self.base.k
            way = depth + np.maximum(self.start["gap"], 0.0)
            miss = np.where(closing, np.divide(depth, way, out=np.ones(self.n), where=way > 0) - phi, 0.0)
            worst = float(np.abs(miss).max())
            if worst < 1e-13:
                return found
            relax, least = (relax, worst) if worst < least else (relax / 2, least)
            phi = phi + relax * miss
        return found._replace(settled=False)

    def _linear(self, closed: np.ndarray, phi: np.ndarray) -> Forces:
        """Solve (1 + k C) lambda = -k (w_f, phi (s_f - r)) on the closed nodes."""
        k, free, on = self.base.k, self.w, closed
        if self.glued:
            k = np.concatenate([k, self.base.k_t * phi])
            free, on = np.concatenate([free, self.s - self.start["reference"]]), np.concatenate([closed, closed])
        found = np.zeros(2 * self.n)
        rows = np.flatnonzero(on)
        matrix = np.eye(len(rows)) + k[rows, None] * self.C[np.ix_(rows, rows)]
        found[rows] = np.linalg.solve(matrix, -k[rows] * free[rows])
        gaps = self.w + self.C[: self.n] @ found[: len(self.C)]
        return Forces(found[: self.n], found[self.n :], gaps, closed)

    def solve(self, limit: int) -> tuple[Forces | None, int, str]:
        """Forces of consistent states, solutions used, and why there are none."""
        closed = self.start["closed"]
        for count in range(1, limit + 1):
            found = self.forces(closed)
            wanted = found.wanted()
            if found.settled and np.array_equal(wanted, closed):
                return found, count, ""
            closed = wanted
        if not self.glued:
            return self._least_index(closed), limit + 1, ""
        if self.n > TRIED:
            return None, limit, NONE
        states = list(self._consistent())
        return (states[0] if len(states) == 1 else None), limit + 1, SEVERAL if states else NONE

    def _least_index(self, closed: np.ndarray) -> Forces:
        """Change the first node that is wrong until none is, which ends for any such problem (Murty, 1974)."""
        closed = closed.copy()
        while True:
            found = self.forces(closed)
            wrong = np.flatnonzero(found.wanted() != closed)
            if not len(wrong):
                return found
            closed = closed.copy()
            closed[wrong[0]] = not closed[wrong[0]]

    def _consistent(self) -> Iterator[Forces]:
        for choice in itertools.product((False, True), repeat=self.n):
            found = self.forces(np.array(choice))
            if found.settled and np.array_equal(found.wanted(), choice):
                yield found


class Piece(NamedTuple):
    """What belongs to one length of step."""

    dt: float
    gg: float
    solve: Factor
    C: np.ndarray


class Opening:
    """The scheme on a base that carries no tension; a piece without a contact is repeated shorter, from its start."""

    def __init__(self, block: Block, request: Request) -> None:
        self.block, self.request, self.base = block, request, Base(block, request)
        self.alpha, self.delta = request["alpha"], request["delta"]
        self.glued = request["shear_stiffness"] > 0
        self._pieces: dict[float, Piece] = {}
        self.nonzeros = 0
        self._piece(1.0)
        self.D, self.V, self.A = (block.K.createVecRight() for _ in range(3))
        self.V.array[:] = np.tile([0.0, request["velocity"]], len(self.V.array) // 2)
        if request["start"] == "consistent":
            self.A = Factor(block.M)(block.F)
        n = len(self.base.share)
        zero, gap = np.zeros(n), np.full(n, float(request["gap"]))
        self.contact = {"gap": gap, "reference": zero, "slip": zero, "closed": gap == 0}
        self.N = self.T = zero

    def _piece(self, share: float) -> Piece:
        """Matrices of a share of the step, made once."""
        if share not in self._pieces:
            if len(self._pieces) > TRIED:
                self._pieces = {1.0: self._pieces[1.0]}
            dt, gg = share * self.request["step"], self.request["gg"] ** share
            S = self.block.M.copy()
            S.axpy(self.alpha * dt**2, self.block.K, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            self.nonzeros = int(S.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"])
            solve, n = Factor(S), len(self.base.share)
            units = np.eye(2 * n)[: 2 * n if self.glued else n]
            answers = [np.concatenate(self.base.moved(solve(self.base.load(u[:n], u[n:])))) for u in units]
            C = self.alpha * dt**2 * np.array(answers)[:, : len(units)].T
            self._pieces[share] = Piece(dt, gg, solve, C)
        return self._pieces[share]

    def advance(self) -> tuple[list[float], str]:
        """Take one step; return the entries of `COLUMNS` and, where it cannot be taken, why not."""
        left = share = 1.0
        solves = cuts = 0
        while left > 0:
            used, failure = self._try(self._piece(share))
            solves += used
            if failure:
                cuts += 1
                if share <= SHORTEST:
                    return [], failure
                share = max(self.request["cut"] * share, SHORTEST)
                continue
            left = left - share if left - share > 1e-9 else 0.0
            share = min(share, left)
        gap, length = self.contact["gap"], self.base.length
        opened = float(self.base.share @ (gap > 0))
        sizes = (float(np.max(gap, initial=0.0)), float(np.max(-gap, initial=0.0)))
        return [self.N.sum() / length, self.T.sum() / length, opened, *sizes, float(solves), float(cuts)], ""

    def _try(self, piece: Piece) -> tuple[int, str]:
        """Take a piece of a step, or say why there is no contact at its end."""
        block, alpha, (dt, gg, solve, C) = self.block, self.alpha, piece
        ahead = self.D + gg * dt * self.V + dt**2 * (0.5 - alpha) * self.A
        residual = block.K.createVecRight()
        block.K.multAdd(-ahead, block.F, residual)
        w, s = self.base.moved(ahead + alpha * dt**2 * solve(residual))
        small = Small(self.base, C, (w + self.request["gap"], s), self.contact)
        found, count, failure = small.solve(self.request["solve_limit"])
        if found is None:
            return count, failure
        A = solve(residual + self.base.load(found.N, found.T))
        self.D = ahead + alpha * dt**2 * A
        self.V = gg * self.V + dt * ((1 - self.delta) * self.A + self.delta * A)
        self.A, self.N, self.T = A, found.N, found.T
        slip = self.base.moved(self.D)[1]
        crossing = slip + np.divide(found.T, self.base.k_t, out=np.zeros_like(slip), where=self.base.k_t > 0)
        held = np.where(self.contact["closed"], self.contact["reference"], crossing)
        reference = np.where(found.closed, held, slip)
        gap = np.where(found.closed, -found.N / self.base.k, found.w)
        self.contact = {"gap": gap, "reference": reference, "slip": slip, "closed": found.closed}
        return count, ""
