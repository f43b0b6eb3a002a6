"""Counted solutions with a factored matrix."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI
from petsc4py import PETSc


class Factor:
    """Counted solutions with a matrix that is factored once."""

    factorisations = 0
    solves = 0

    def __init__(self, matrix: Any) -> None:
        self.ksp = PETSc.KSP().create(MPI.COMM_WORLD)
        self.ksp.setOperators(matrix)
        self.ksp.setType("preonly")
        pc = self.ksp.getPC()
        pc.setType("lu")
        pc.setFactorSolverType("petsc" if MPI.COMM_WORLD.size == 1 else "mumps")
        self.ksp.setUp()
        self.matrix = matrix
        self.nonzeros = int(matrix.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"])
        Factor.factorisations += 1

    def __call__(self, right: Any) -> Any:
        """Solve for one right-hand side."""
        solution = self.matrix.createVecRight()
        self.ksp.solve(right, solution)
        Factor.solves += 1
        return solution
