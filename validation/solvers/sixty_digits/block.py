r"""The two-block model in sixty-digit arithmetic, by another route than the package's.

The matrices are those of (v, ex, ey) about the centroid, since a pressure on all of the top of an upright rectangle
moves no other unknown, built from the doubles of the scene in ball arithmetic (python-flint). A step is given by its
trace and its determinant, which like all of the scheme are matrices in X = dt^2 M^-1 K:

    D(n+1) = trace D(n) - det D(n-1) + (1 + gg) / 2 (1 + alpha X)^-1 dt^2 M^-1 F,    H = X (1 + alpha X)^-1
    trace = 1 - H/2 + gg (1 - delta H),    det = gg (1 + (1/2 - delta) H)

from the second step on; the first two come from the scheme's own definition, equations (6) and (7).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat, ctx

from validation.scenes.scene import Scene
from validation.theory import statics

DIGITS = 60
WORKING = 120  # digits carried: thirty decades of stiffness and thirty of w dt cancel before sixty are left
BITS_A_DIGIT = 3.33


@contextmanager
def digits(count: int, terms: int = 0) -> Iterator[None]:
    """Ball arithmetic of so many decimal digits, and power series of so many terms."""
    before = ctx.prec, ctx.cap
    ctx.prec = int(count * BITS_A_DIGIT)
    ctx.cap = terms
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before


@dataclass(frozen=True)
class Equations:
    """M x'' + K x = F and the rows of displacement and contact pressure."""

    M: arb_mat  # [kg and its moments]
    K: arb_mat
    F: list[arb]
    rows: dict[str, list[arb]]  # column name -> row


@dataclass(frozen=True)
class NewmarkNumbers:
    """Parameters of the scheme, the doubles of the scene taken as exact."""

    alpha: arb
    delta: arb
    gg: arb
    step: arb
    consistent: bool

    @classmethod
    def of(cls, scene: Scene) -> NewmarkNumbers:
        """Return the parameters of a scene."""
        t = scene.time
        return cls(arb(t.alpha), arb(t.delta), arb(t.discount), arb(t.step), t.start == "consistent")


def equations(scene: Scene) -> Equations:
    """Assemble the upright rectangle on its corner springs; call it with `WORKING` digits set."""
    width, height = (arb(length) for length in statics.size(scene))
    area = width * height
    stiffness = arb(scene.contact.stiffness)
    M = arb_mat(3, 3)
    for i, value in enumerate((area, area * width * width / 12, area * height * height / 12)):
        M[i, i] = arb(scene.block.density) * value
    K = _elastic(scene, area)
    K[1, 1] += arb(scene.contact.shear) * width * width / 2
    fall, corner = ([arb(1), arb(0), y] for y in (height / 2, -height / 2))  # rows of v at the top and at the base
    for i, value in enumerate(corner):
        for j, other in enumerate(corner):
            K[i, j] += 2 * stiffness * value * other
    rows = {
        "displacement": [arb(1), arb(0), arb(0)],
        "contact_pressure": [-2 * stiffness * value / width for value in corner],
    }
    return Equations(M, K, [-arb(scene.load.pressure) * width * value for value in fall], rows)


def _elastic(scene: Scene, area: arb) -> arb_mat:
    """Return area times elasticity from the Lame parameters of the plane problem."""
    E = arb(scene.block.young)
    mu = arb(scene.block.poisson)
    G = E / (2 * (1 + mu))
    last = 1 - mu if scene.block.hypothesis == "plane stress" else 1 - 2 * mu
    lam = E * mu / ((1 + mu) * last)
    K = arb_mat(3, 3)
    K[1, 1] = K[2, 2] = area * (lam + 2 * G)
    K[1, 2] = K[2, 1] = area * lam
    return K


def responses(system: Equations, scene: Scene, names: tuple[str, ...]) -> dict[str, list[arb]]:
    """Return the named columns of every step; balls are replaced by their midpoints from step to step."""
    s = NewmarkNumbers.of(scene)
    one = arb_mat(np.eye(len(system.F)).tolist())
    X = system.M.solve(system.K) * (s.step * s.step)
    F = system.M.solve(arb_mat([[force] for force in system.F])) * (s.step * s.step)
    implicit = (one + X * s.alpha).inv().mid()
    H = X * implicit
    trace = (one - H * (arb(1) / 2) + (one - H * s.delta) * s.gg).mid()
    det = ((one + H * (arb(1) / 2 - s.delta)) * s.gg).mid()

    half = arb(1) / 2 - s.alpha
    A0 = F if s.consistent else F * 0
    first = implicit * (A0 * half + F * s.alpha)
    A1 = F - X * first
    V1 = A0 * (1 - s.delta) + A1 * s.delta
    second = implicit * (first + V1 * s.gg + A1 * half + F * s.alpha)
    constant = (implicit * F * ((1 + s.gg) / 2)).mid()
    instants = [first.mid(), second.mid()]
    while len(instants) < scene.time.steps:
        instants.append((trace * instants[-1] - det * instants[-2] + constant).mid())
    observed = {name: arb_mat([system.rows[name]]) for name in names}
    return {name: [(row * D)[0, 0] for D in instants[: scene.time.steps]] for name, row in observed.items()}


def history(scene: Scene, names: tuple[str, ...]) -> dict[str, list[arb]]:
    """Return displacement [m] and contact pressure [Pa] of every step, good to sixty digits of the largest value."""
    with digits(WORKING):
        return responses(equations(scene), scene, names)
