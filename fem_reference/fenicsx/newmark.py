"""The Newmark scheme on locked springs.

Solved for the displacement, S = M + alpha dt^2 K factored once:

    D* = D + gg dt V + dt^2 (1/2 - alpha) A,  D1 = D + S^-1 [M (D* - D) + alpha dt^2 (F - K D)],
    A1 = (D1 - D*) / (alpha dt^2), or M^-1 (F - K D1) for alpha = 0,  V1 = gg V + dt ((1 - delta) A + delta A1).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from petsc4py import PETSc

from .factor import Factor
from .model import Elements, Request


def effective(body: Elements, request: Request) -> Factor:
    """Factor S."""
    S = body.M.copy()
    S.axpy(request["alpha"] * request["step"] ** 2, body.K, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
    return Factor(S)


def start(body: Elements, request: Request, solve: Factor) -> Any:
    """Acceleration at t = 0."""
    if request["start"] == "consistent":
        return (Factor(body.M) if request["alpha"] > 0 else solve)(body.load(at(request, 0)))
    return body.K.createVecRight()


def at(request: Request, step: int) -> Any:
    """Displacement (x, y) of the base at the end of a step."""
    return request["moved"][step] if request["moved"] else (0.0, 0.0)


def steps(body: Elements, request: Request, solve: Factor, A: Any) -> Iterator[Any]:
    """Yield the displacement after each step from the acceleration at t = 0."""
    dt = request["step"]
    gg = request["gg"]
    alpha = request["alpha"]
    delta = request["delta"]
    D, V, residual = (body.K.createVecRight() for _ in range(3))
    for step in range(1, request["steps"] + 1):
        F = body.load(at(request, step))
        body.K.multAdd(-D, F, residual)
        ahead = gg * dt * V + dt**2 * (0.5 - alpha) * A  # D* - D
        increment = solve(body.M * ahead + alpha * dt**2 * residual)
        D = D + increment
        A0 = A
        if alpha > 0:
            A = (increment - ahead) / (alpha * dt**2)
        else:
            body.K.multAdd(-D, F, residual)
            A = solve(residual)
        V = gg * V + dt * ((1 - delta) * A0 + delta * A)
        yield D
