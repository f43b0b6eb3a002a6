r"""The two-block model in sixty-digit arithmetic, by another route than the package's.

The matrices are those of (v, u, r, ex, ey, gxy) about the centroid, built from the doubles of the scene; the modes
are found to more than sixty digits, and each mode follows from trace and determinant of its step:

    y(n+1) = trace y(n) - det y(n-1) + (1 + gg) / 2 * h F / w^2,    h = w^2 dt^2 / (1 + alpha w^2 dt^2)

from the second step on; the first two come from the scheme's own definition, equations (6) and (7).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from mpmath import mp, mpf

from validation.scenes.scene import Scene

DIGITS = 60
WORKING = 120  # digits carried: thirty decades of stiffness and thirty of w dt cancel before sixty are left
Number = Any  # mpmath is not typed


@dataclass(frozen=True)
class Equations:
    """M x'' + K x = F and the rows of displacement and contact pressure, in the unknowns that the load reaches."""

    M: Number  # mp matrix [kg and its moments]
    K: Number  # mp matrix
    F: list[Number]
    rows: dict[str, list[Number]]  # column name -> row


@dataclass(frozen=True)
class NewmarkNumbers:
    """Parameters of the scheme, the doubles of the scene taken as exact."""

    alpha: Number
    delta: Number
    gg: Number
    step: Number
    consistent: bool

    @classmethod
    def of(cls, scene: Scene) -> NewmarkNumbers:
        """Return the parameters of a scene."""
        t = scene.time
        return cls(mpf(t.alpha), mpf(t.delta), mpf(t.discount), mpf(t.step), t.start == "consistent")


def equations(scene: Scene) -> Equations:
    """Assemble the block on its corner springs; call it with `WORKING` digits set."""
    points = [(mpf(x), mpf(y)) for x, y in scene.block.outline]
    area, centroid, moments = _integrals(points)
    centred = [(x - centroid[0], y - centroid[1]) for x, y in points]
    M = _inertia(scene, area, moments)
    K = _elastic(scene, area)
    base = _edge(centred, scene.block.base)
    top = _edge(centred, scene.block.top)
    pressure = _add_springs(scene, K, base)
    (x1, y1), (x2, y2) = top
    length = mp.hypot(x2 - x1, y2 - y1)
    _, fall = _rows_of_T((x1 + x2) / 2, (y1 + y2) / 2)
    F = [-mpf(scene.load.pressure) * length * value for value in fall]
    displacement = [mpf(0), mpf(1)] + [mpf(0)] * 4
    return _reached(Equations(M, K, F, {"displacement": displacement, "contact_pressure": pressure}))


def _edge(points: list[Any], index: int) -> tuple[Any, Any]:
    return points[index], points[(index + 1) % len(points)]


def _integrals(points: list[Any]) -> tuple[Number, tuple[Number, Number], tuple[Number, Number, Number]]:
    """Return area, centroid and the central second moments s1 (x x), s2 (y y), s3 (x y)."""
    s = sx = sy = sxx = syy = sxy = mpf(0)
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
    return s, (x0 + sx / s, y0 + sy / s), (s1, s2, _clean(s3, mp.sqrt(s1 * s2)))


def _clean(value: Number, scale: Number) -> Number:
    """Return exact zero for what is rounding of the working digits."""
    return mpf(0) if abs(value) < mpf(10) ** (10 - WORKING) * scale else value


def _rows_of_T(x: Number, y: Number) -> tuple[list[Number], list[Number]]:
    """Return the two rows of T, equation (3), in (u, v, r, ex, ey, gxy)."""
    unit = mpf(1)
    zero = mpf(0)
    return [unit, zero, -y, x, zero, y / 2], [zero, unit, x, zero, y, x / 2]


def _inertia(scene: Scene, area: Number, moments: tuple[Number, Number, Number]) -> Number:
    """Return the mass matrix, equation (16) with (3, 6) and (6, 6) corrected."""
    s1, s2, s3 = moments
    M = mp.zeros(6)
    M[0, 0] = M[1, 1] = area
    M[2, 2] = s1 + s2
    M[3, 3] = s1
    M[4, 4] = s2
    M[5, 5] = (s1 + s2) / 4
    for i, j, value in ((2, 3, -s3), (2, 4, s3), (2, 5, (s1 - s2) / 2), (3, 5, s3 / 2), (4, 5, s3 / 2)):
        M[i, j] = M[j, i] = value
    return M * mpf(scene.block.density)


def _elastic(scene: Scene, area: Number) -> Number:
    """Return area times elasticity from the Lame parameters of the plane problem."""
    E = mpf(scene.block.young)
    mu = mpf(scene.block.poisson)
    G = E / (2 * (1 + mu))
    last = 1 - mu if scene.block.hypothesis == "plane stress" else 1 - 2 * mu
    lam = E * mu / ((1 + mu) * last)
    K = mp.zeros(6)
    K[3, 3] = K[4, 4] = area * (lam + 2 * G)
    K[3, 4] = K[4, 3] = area * lam
    K[5, 5] = area * G
    return K


def _add_springs(scene: Scene, K: Number, base: tuple[Any, Any]) -> list[Number]:
    """Add the corner springs to K in place and return the row of the contact pressure."""
    (x1, y1), (x2, y2) = base
    a = mp.hypot(x2 - x1, y2 - y1)
    tx = (x2 - x1) / a
    ty = (y2 - y1) / a
    normal_k = mpf(scene.contact.stiffness)
    shear_k = mpf(scene.contact.shear)
    pressure = [mpf(0)] * 6
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
    """Leave out the unknowns that neither M nor K couples to the load."""
    size = range(6)
    scale = [mp.sqrt(full.M[i, i] * full.K[i, i]) for i in size]
    linked = [
        [
            bool(_clean(full.M[i, j], mp.sqrt(full.M[i, i] * full.M[j, j])))
            or bool(_clean(full.K[i, j], mp.sqrt(full.K[i, i] * full.K[j, j])))
            for j in size
        ]
        for i in size
    ]
    largest = max(abs(full.F[i]) / scale[i] for i in size)
    reached = {i for i in size if abs(full.F[i]) / scale[i] > mpf(10) ** (10 - WORKING) * largest} or {1, 4}
    while more := {j for j in size if any(linked[i][j] for i in reached)} - reached:
        reached |= more
    unknowns = sorted(reached)
    M, K = (mp.matrix([[matrix[i, j] for j in unknowns] for i in unknowns]) for matrix in (full.M, full.K))
    rows = {name: [row[i] for i in unknowns] for name, row in full.rows.items()}
    return Equations(M, K, [full.F[i] for i in unknowns], rows)


def modes(system: Equations) -> tuple[list[Number], list[Number], dict[str, list[Number]]]:
    """Return w^2, the modal loads phi'F and the modal rows, phi'M phi = 1."""
    n = len(system.F)
    L = mp.cholesky(system.M)
    inverse = L**-1
    squares, vectors = mp.eigsy(inverse * system.K * inverse.T)
    shapes = inverse.T * vectors
    columns = [[shapes[i, k] for i in range(n)] for k in range(n)]
    rows = {name: [mp.fdot(row, phi) for phi in columns] for name, row in system.rows.items()}
    return list(squares), [mp.fdot(system.F, phi) for phi in columns], rows


def modal_history(square: Number, load: Number, scheme: NewmarkNumbers, steps: int) -> list[Number]:
    """Return y of step 1 to the last of y'' + w^2 y = load from rest."""
    a = scheme.alpha
    d = scheme.delta
    gg = scheme.gg
    dt2 = scheme.step**2
    k = square * dt2
    beta = 1 + a * k
    h = k / beta
    trace = 1 - h / 2 + gg * (1 - d * h)
    det = gg * (1 + (mpf(1) / 2 - d) * h)
    F = load * dt2
    A0 = F if scheme.consistent else mpf(0)
    first = ((mpf(1) / 2 - a) * A0 + a * F) / beta
    A1 = F - k * first
    V1 = (1 - d) * A0 + d * A1
    values = [first, (first + gg * V1 + (mpf(1) / 2 - a) * A1 + a * F) / beta]
    constant = (1 + gg) / 2 * F / beta
    while len(values) < steps:
        values.append(trace * values[-1] - det * values[-2] + constant)
    return values[:steps]


def responses(system: Equations, scene: Scene, names: tuple[str, ...]) -> dict[str, list[Number]]:
    """Return the named columns of every step, mode by mode."""
    scheme = NewmarkNumbers.of(scene)
    squares, loads, rows = modes(system)
    parts = [modal_history(w2, f, scheme, scene.time.steps) for w2, f in zip(squares, loads, strict=True)]
    instants = list(zip(*parts, strict=True))
    return {name: [mp.fdot(rows[name], y) for y in instants] for name in names}


def history(scene: Scene, names: tuple[str, ...]) -> dict[str, list[Number]]:
    """Return displacement [m] and contact pressure [Pa] of every step, good to sixty digits of the largest value."""
    with mp.workdps(WORKING):
        return responses(equations(scene), scene, names)
