r"""The two-block model in sixty-digit arithmetic, by another route than the package's.

The matrices are those of (v, u, r, ex, ey, gxy) about the centroid, built from the doubles of the scene in ball
arithmetic (python-flint), whose balls say what is zero. A step is given by its trace and its determinant, which here
are matrices in X = dt^2 M^-1 K, as all that stands in the scheme is:

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
from scipy.sparse.csgraph import connected_components

from validation.scenes.scene import Scene

DIGITS = 60
WORKING = 120  # digits carried: thirty decades of stiffness and thirty of w dt cancel before sixty are left
BITS_A_DIGIT = 3.33
Point = tuple[arb, arb]


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
    """Assemble the block on its corner springs; call it with `WORKING` digits set."""
    points = [(arb(x), arb(y)) for x, y in scene.block.outline]
    area, centroid, moments = _integrals(points)
    centred = [(x - centroid[0], y - centroid[1]) for x, y in points]
    M = _inertia(scene, area, moments)
    K = _elastic(scene, area)
    base = _edge(centred, scene.block.base)
    (x1, y1), (x2, y2) = _edge(centred, scene.block.top)
    pressure = _add_springs(scene, K, base)
    length = _length(x2 - x1, y2 - y1)
    _, fall = _rows_of_T((x1 + x2) / 2, (y1 + y2) / 2)
    F = [-arb(scene.load.pressure) * length * value for value in fall]
    displacement = [arb(int(i == 1)) for i in range(6)]
    return _reached(Equations(M, K, F, {"displacement": displacement, "contact_pressure": pressure}))


def _edge(points: list[Point], index: int) -> tuple[Point, Point]:
    return points[index], points[(index + 1) % len(points)]


def _length(x: arb, y: arb) -> arb:
    return (x * x + y * y).sqrt()


def _integrals(points: list[Point]) -> tuple[arb, Point, tuple[arb, arb, arb]]:
    """Return area, centroid and the central second moments s1 (x x), s2 (y y), s3 (x y)."""
    s = sx = sy = sxx = syy = sxy = arb(0)
    x0, y0 = points[0]
    local = [(x - x0, y - y0) for x, y in points]
    for (x, y), (X, Y) in zip(local, local[1:] + local[:1], strict=True):
        c = x * Y - X * y
        s += c / 2
        sx += c * (x + X) / 6
        sy += c * (y + Y) / 6
        sxx += c * (x * x + x * X + X * X) / 12
        syy += c * (y * y + y * Y + Y * Y) / 12
        sxy += c * (x * Y + 2 * x * y + 2 * X * Y + X * y) / 24
    s1 = sxx - sx * sx / s
    s2 = syy - sy * sy / s
    s3 = sxy - sx * sy / s
    return s, (x0 + sx / s, y0 + sy / s), (s1, s2, s3)


def _rows_of_T(x: arb, y: arb) -> tuple[list[arb], list[arb]]:
    """Return the two rows of T, equation (3), in (u, v, r, ex, ey, gxy)."""
    unit = arb(1)
    zero = arb(0)
    return [unit, zero, -y, x, zero, y / 2], [zero, unit, x, zero, y, x / 2]


def _inertia(scene: Scene, area: arb, moments: tuple[arb, arb, arb]) -> arb_mat:
    """Return the mass matrix, equation (16) with (3, 6) and (6, 6) corrected."""
    s1, s2, s3 = moments
    M = arb_mat(6, 6)
    M[0, 0] = M[1, 1] = area
    M[2, 2] = s1 + s2
    M[3, 3] = s1
    M[4, 4] = s2
    M[5, 5] = (s1 + s2) / 4
    for i, j, value in ((2, 3, -s3), (2, 4, s3), (2, 5, (s1 - s2) / 2), (3, 5, s3 / 2), (4, 5, s3 / 2)):
        M[i, j] = M[j, i] = value
    return M * arb(scene.block.density)


def _elastic(scene: Scene, area: arb) -> arb_mat:
    """Return area times elasticity from the Lame parameters of the plane problem."""
    E = arb(scene.block.young)
    mu = arb(scene.block.poisson)
    G = E / (2 * (1 + mu))
    last = 1 - mu if scene.block.hypothesis == "plane stress" else 1 - 2 * mu
    lam = E * mu / ((1 + mu) * last)
    K = arb_mat(6, 6)
    K[3, 3] = K[4, 4] = area * (lam + 2 * G)
    K[3, 4] = K[4, 3] = area * lam
    K[5, 5] = area * G
    return K


def _add_springs(scene: Scene, K: arb_mat, base: tuple[Point, Point]) -> list[arb]:
    """Add the corner springs to K in place and return the row of the contact pressure."""
    (x1, y1), (x2, y2) = base
    a = _length(x2 - x1, y2 - y1)
    tx = (x2 - x1) / a
    ty = (y2 - y1) / a
    normal_k = arb(scene.contact.stiffness)
    shear_k = arb(scene.contact.shear)
    pressure = [arb(0)] * 6
    for x, y in base:
        u, v = _rows_of_T(x, y)
        normal = [tx * b - ty * c for b, c in zip(v, u, strict=True)]
        shear = [tx * c + ty * b for b, c in zip(v, u, strict=True)]
        for i in range(6):
            pressure[i] -= normal_k * normal[i] / a
            for j in range(6):
                K[i, j] += normal_k * normal[i] * normal[j] + shear_k * shear[i] * shear[j]
    return pressure


def _reached(full: Equations) -> Equations:
    """Leave out the unknowns that neither M nor K couples to the load; a ball that holds zero is zero."""
    linked = [
        [not (mass.contains(0) and stiffness.contains(0)) for mass, stiffness in zip(*lines, strict=True)]
        for lines in zip(full.M.tolist(), full.K.tolist(), strict=True)
    ]
    _, parts = connected_components(np.array(linked))
    loaded = {part for part, force in zip(parts, full.F, strict=True) if not force.contains(0)}
    unknowns = [i for i, part in enumerate(parts) if part in loaded] or [1, 4]
    M, K = (arb_mat([[matrix[i, j] for j in unknowns] for i in unknowns]) for matrix in (full.M, full.K))
    rows = {name: [row[i] for i in unknowns] for name, row in full.rows.items()}
    return Equations(M, K, [full.F[i] for i in unknowns], rows)


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
