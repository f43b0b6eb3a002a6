"""Contact that carries no tension, on the nodes of the base, in the Newmark step of the block without springs.

A1 = S^-1 (F - K D* + B' lambda) with the forces lambda = (N, T) of the nodes on the block, which are unknown: the free
block, lambda = 0, gives the gaps w_f and slips s_f at the end of the step, C = alpha dt^2 B S^-1 B' what forces add.
Where the base moves its own way is taken from gaps and slips. The laws of the nodes are those of `small`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import ufl
from petsc4py import PETSc

from .factor import Factor
from .model import BASE, COMM, Block, Inapplicable, Request, constant
from .small import Law, Small, Start

KEPT = 8  # lengths of step of which the matrices are kept
SHORTEST = 0.01  # of the step
COLUMNS = (
    "contact_pressure",
    "base_shear",
    "open_share",
    "largest_gap",
    "largest_penetration",
    "largest_slide",
    "solves",
    "cuts",
)


class Base:
    """The nodes of the base that bear springs, in their order along it and alike on every rank."""

    def __init__(self, block: Block, request: Request) -> None:
        self.normal = block.normal
        self.tangent = block.tangent
        self.block = block
        self.length = block.outline.side(0)[2]
        parts = COMM.allgather(self._owned(request))
        numbers, along, share = (np.concatenate([part[i] for part in parts]) for i in range(3))
        order = np.argsort(along)
        self.share = share[order]
        k, k_t = (2 * request[name] * self.share for name in ("stiffness", "shear_stiffness"))
        angle = request["friction"]
        tan = np.inf if angle is None else float(np.tan(np.radians(angle)))
        self.law = Law(k, k_t, tan, request["cohesion"] * self.length * self.share)
        self._places = (2 * numbers[order][:, None] + np.array([0, 1])).ravel().astype(np.int32)
        self._seen = PETSc.Vec().createSeq(len(self._places))
        rows = PETSc.IS().createGeneral(self._places, comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(block.K.createVecRight(), rows, self._seen, None)

    def _owned(self, request: Request) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Number, place along the base and share of it of each of this rank's nodes; the shares add up to one.

        The integral of a node's shape function over the base is its share of the length.
        """
        block = self.block
        owned = self.block.space.dofmap.index_map
        first, end = owned.local_range
        share = np.zeros(end - first)
        if request["foundation"] == "corner":
            for pair in block.corners():
                share[pair[0] // 2 - first] = 0.5
        elif request["foundation"] == "distributed":
            functional = ufl.dot(constant(block.mesh, self.normal), ufl.TestFunction(block.space))
            parts = block.vector(functional * block.ds(BASE)).array.reshape(-1, 2) @ self.normal
            share = np.where(parts > 1e-10 * self.length, parts / self.length, 0.0)
        else:
            raise Inapplicable(f"unilateral contact on a foundation {request['foundation']!r} is not in fenicsx")
        loaded = np.flatnonzero(share)
        places = block.space.tabulate_dof_coordinates()[: end - first, :2]
        return loaded + first, places[loaded] @ self.tangent, share[loaded]

    def moved(self, D: Any) -> tuple[np.ndarray, np.ndarray]:
        """Displacements of the nodes normal to the base and along it."""
        self._scatter.scatter(D, self._seen, mode=PETSc.ScatterMode.FORWARD)
        pairs = np.array(self._seen.array).reshape(-1, 2)
        return pairs @ self.normal, pairs @ self.tangent

    def load(self, N: np.ndarray, T: np.ndarray) -> Any:
        """B' (N, T)."""
        vector = self.block.K.createVecRight()
        if COMM.rank == 0:
            values = np.outer(N, self.normal) + np.outer(T, self.tangent)
            vector.setValues(self._places, values.ravel(), addv=PETSc.InsertMode.ADD_VALUES)
        vector.assemble()
        return vector


class Piece(NamedTuple):
    """What belongs to one length of step."""

    dt: float
    gg: float
    solve: Factor
    C: np.ndarray


class Opening:
    """The scheme on a base that carries no tension; a piece without a contact is repeated shorter, from its start."""

    def __init__(self, block: Block, request: Request) -> None:
        self.block = block
        self.request = request
        self.base = Base(block, request)
        self.alpha = request["alpha"]
        self.delta = request["delta"]
        self.sheared = request["shear_stiffness"] > 0
        self._pieces: dict[float, Piece] = {}
        self.nonzeros = 0
        self._piece(1.0)
        self.D, self.V, self.A = (block.K.createVecRight() for _ in range(3))
        self.V.array[:] = np.tile([0.0, request["velocity"]], len(self.V.array) // 2)
        if request["start"] == "consistent":
            self.A = Factor(block.M)(block.F)
        n = len(self.base.share)
        zero = np.zeros(n)
        gap = np.full(n, float(request["gap"]))
        self.contact = Start(gap, zero, zero, (gap == 0).astype(int), zero)
        self.N = self.T = zero
        self.time, displacement = 0.0, self._way(0.0)
        if np.any(displacement):
            raise ValueError(
                f"motion: must be zero at t = 0 where contact opens, got {displacement.tolist()} across and along"
            )

    def _way(self, time: float) -> np.ndarray:
        """Displacement of the base, normal to it and along it."""
        if self.request["record"] is None:
            return np.zeros(2)
        instants, *parts = self.request["record"]
        there = np.array([np.interp(time, instants, part) for part in parts])
        return np.array([self.base.normal @ there, self.base.tangent @ there])

    def _piece(self, share: float) -> Piece:
        """Matrices of a share of the step, made once."""
        if share not in self._pieces:
            if len(self._pieces) > KEPT:
                self._pieces = {1.0: self._pieces[1.0]}
            dt = share * self.request["step"]
            gg = self.request["gg"] ** share
            S = self.block.M.copy()
            S.axpy(self.alpha * dt**2, self.block.K, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
            self.nonzeros = int(S.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"])
            solve = Factor(S)
            n = len(self.base.share)
            units = np.eye(2 * n)[: 2 * n if self.sheared else n]
            answers = [np.concatenate(self.base.moved(solve(self.base.load(u[:n], u[n:])))) for u in units]
            C = self.alpha * dt**2 * np.array(answers)[:, : len(units)].T
            self._pieces[share] = Piece(dt, gg, solve, C)
        return self._pieces[share]

    def advance(self) -> tuple[list[float], str]:
        """Take one step; return the entries of `COLUMNS` and, where it cannot be taken, why not."""
        remainder = share = 1.0
        solves = cuts = 0
        while remainder > 0:
            used, failure = self._try(self._piece(share))
            solves += used
            if failure:
                cuts += 1
                if share <= SHORTEST:
                    return [], failure
                share = max(self.request["cut"] * share, SHORTEST)
                continue
            remainder = remainder - share if remainder - share > 1e-9 else 0.0
            share = min(share, remainder)
        gap = self.contact.gap
        length = self.base.length
        opened = float(self.base.share @ (gap > 0))
        sizes = [float(np.max(part, initial=0.0)) for part in (gap, -gap, np.abs(self.contact.slid))]
        return [self.N.sum() / length, self.T.sum() / length, opened, *sizes, float(solves), float(cuts)], ""

    def _try(self, piece: Piece) -> tuple[int, str]:
        """Take a piece of a step, or say why there is no contact at its end."""
        block = self.block
        alpha = self.alpha
        (dt, gg, solve, C) = piece
        ahead = self.D + gg * dt * self.V + dt**2 * (0.5 - alpha) * self.A
        residual = block.K.createVecRight()
        block.K.multAdd(-ahead, block.F, residual)
        w, s = self.base.moved(ahead + alpha * dt**2 * solve(residual))
        displacement = self._way(self.time + dt)
        small = Small(self.base.law, C, (w + self.request["gap"] - displacement[0], s - displacement[1]), self.contact)
        forces, count, failure = small.solve(self.request["solve_limit"])
        if forces is None:
            return count, failure
        A = solve(residual + self.base.load(forces.N, forces.T))
        self.D = ahead + alpha * dt**2 * A
        self.V = gg * self.V + dt * ((1 - self.delta) * self.A + self.delta * A)
        self.A = A
        self.N = forces.N
        self.T = forces.T
        self.contact = small.ended(forces, self.base.moved(self.D)[1] - displacement[1])
        self.time += dt
        return count, ""
