"""The Newmark scheme on locked springs."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

from .factor import Factor
from .model import Elements, Request


class Newmark:
    """The scheme solved for the displacement, S = M + alpha dt^2 K factored once.

    D* = D + gg dt V + dt^2 (1/2 - alpha) A,  D1 = D + S^-1 [M (D* - D) + alpha dt^2 (F - K D)],
    A1 = (D1 - D*) / (alpha dt^2), or M^-1 (F - K D1) for alpha = 0,  V1 = gg V + dt ((1 - delta) A + delta A1).
    """

    def __init__(self, block: Elements, request: Request) -> None:
        self.M = block.M
        self.K = block.K
        self.moved = request["moved"]
        self.load = block.load
        self.step = 0
        self.F = self.load(self.moved[0] if self.moved else (0.0, 0.0))
        self.dt = request["step"]
        self.gg = request["gg"]
        self.alpha = request["alpha"]
        self.delta = request["delta"]
        S = self.M.copy()
        S.axpy(self.alpha * self.dt**2, self.K, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self.solve = Factor(S)
        self.nonzeros = int(S.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"])
        self.D, self.V, self.A = (self.K.createVecRight() for _ in range(3))
        if request["start"] == "consistent":
            self.A = (Factor(self.M) if self.alpha > 0 else self.solve)(self.F)

    def _residual(self) -> Any:
        r = self.K.createVecRight()
        self.K.multAdd(-self.D, self.F, r)
        return r

    def advance(self) -> Any:
        """Take one step and return the displacement."""
        dt = self.dt
        alpha = self.alpha
        A = self.A
        if self.moved:
            self.step += 1
            self.F = self.load(self.moved[self.step])
        ahead = self.gg * dt * self.V + dt**2 * (0.5 - alpha) * A  # D* - D
        increment = self.solve(self.M * ahead + alpha * dt**2 * self._residual())
        self.D = self.D + increment
        self.A = (increment - ahead) / (alpha * dt**2) if alpha > 0 else self.solve(self._residual())
        self.V = self.gg * self.V + dt * ((1 - self.delta) * A + self.delta * self.A)
        return self.D
