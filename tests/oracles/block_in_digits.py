"""A block on springs that hold it or on corners that open, in arithmetic of many digits and in displacements.

Nothing is shared with the package: areas, springs, loads and the step are written again here, in the textbook unknowns
and with the textbook order of operations; the springs of closed corners are part of the matrix of the step, and the
crossing of a closing corner is found by repetition. Many digits make harmless what this form loses by subtraction.
Matrices are those of mpmath; steps are made with arrays of `decimal`'s numbers, which are compiled.
"""

from decimal import Context, Decimal, localcontext
from itertools import product

import numpy as np
from mpmath import mp, mpf

DIGITS = 80
ZERO, HALF = Decimal(0), Decimal("0.5")


def integrals(points):
    """Return area, centroid and central second moments (s, x0, y0, s1, s2, s3)."""
    s = sx = sy = sxx = syy = sxy = mpf(0)
    for (x, y), (X, Y) in zip(points, points[1:] + points[:1], strict=True):
        c = x * Y - X * y
        s += c / 2
        sx += c * (x + X) / 6
        sy += c * (y + Y) / 6
        sxx += c * (x * x + x * X + X * X) / 12
        syy += c * (y * y + y * Y + Y * Y) / 12
        sxy += c * (x * Y + 2 * x * y + 2 * X * Y + X * y) / 24
    x0, y0 = sx / s, sy / s
    return s, x0, y0, sxx - x0 * sx, syy - y0 * sy, sxy - x0 * sy


def displacement_rows(x, y):
    """Return the two rows of T at a point relative to the centroid."""
    return [1, 0, -y, x, 0, y / 2], [0, 1, x, 0, y, x / 2]


def matrices(block):
    """Return M and K of a block alone, as matrices of mpmath."""
    material = block.material
    s, _, _, s1, s2, s3 = integrals([(mpf(float(x)), mpf(float(y))) for x, y in block.corners])
    rho, E, mu = mpf(material.density), mpf(material.young), mpf(material.poisson)
    M = mp.zeros(6)
    M[0, 0] = M[1, 1] = s
    M[2, 2], M[3, 3], M[4, 4], M[5, 5] = s1 + s2, s1, s2, (s1 + s2) / 4
    for i, j, value in ((2, 3, -s3), (2, 4, s3), (2, 5, (s1 - s2) / 2), (3, 5, s3 / 2), (4, 5, s3 / 2)):
        M[i, j] = M[j, i] = value
    G = E / (2 * (1 + mu))
    lam = E * mu / (1 - mu**2) if material.hypothesis == "plane stress" else E * mu / ((1 + mu) * (1 - 2 * mu))
    K = mp.zeros(6)
    K[3, 3] = K[4, 4] = s * (lam + 2 * G)
    K[3, 4] = K[4, 3] = s * lam
    K[5, 5] = s * G
    return rho * M, K


def decimal(x):
    """Return a number of mpmath as a decimal one, with more digits than it has."""
    return Decimal(mp.nstr(x, DIGITS + 5))


def exact(x):
    """Return a double as it is."""
    return Decimal(float(x))


def array(matrix):
    """Return a matrix of mpmath as an array of decimal numbers."""
    return np.array([list(map(decimal, row)) for row in matrix.tolist()])


def zeros(n):
    """Return so many zeros."""
    return np.array([ZERO] * n)


def factorised(matrix):
    """Return L (ones on its diagonal) below U, and the order of the rows, by Gauss's elimination."""
    A, order = matrix.copy(), list(range(len(matrix)))
    for k in range(len(A)):
        best = max(range(k, len(A)), key=lambda i: abs(A[i, k]))
        A[[k, best]] = A[[best, k]]
        order[k], order[best] = order[best], order[k]
        A[k + 1 :, k] /= A[k, k]
        A[k + 1 :, k + 1 :] -= np.outer(A[k + 1 :, k], A[k, k + 1 :])
    return A, order


def solved(factors, b):
    """Return the solution for one right-hand side."""
    (A, order), n = factors, len(b)
    x = b[order]
    for i in range(1, n):
        x[i] -= A[i, :i] @ x[:i]
    x[-1] /= A[-1, -1]
    for i in range(n - 2, -1, -1):
        x[i] = (x[i] - A[i, i + 1 :] @ x[i + 1 :]) / A[i, i]
    return x


class OpeningBlock:
    """The model and the scheme in numbers of many digits; corners without springs along the base open."""

    states = tuple(product((False, True), repeat=2))

    def __init__(self, model, scheme):
        M, K0 = matrices(model.block)
        self.M, self.K0, self.inverse = array(M), array(K0), array(M**-1)
        self.alpha, self.delta, self.gg, self.dt = map(exact, (scheme.alpha, scheme.delta, scheme.gg, scheme.step))
        points = [(mpf(float(x)), mpf(float(y))) for x, y in model.block.corners]
        _, x0, y0, *_ = integrals(points)
        self.centred = [(decimal(x - x0), decimal(y - y0)) for x, y in points]
        self.p, self.ps, self.g0 = map(exact, self.springs(model.contact))
        self.F = self._load(model)
        self._rows(model)
        self.D, self.V = zeros(6), zeros(6)
        self.V[1] = exact(getattr(model, "velocity", 0.0))
        self.A = self.inverse @ self.F if scheme.start == "consistent" else zeros(6)
        self.h = self.alpha * self.dt**2
        self.free = self.M + self.h * self.K0
        self.factors = {}  # of the matrix of the step, by closed corners

    @staticmethod
    def springs(contact):
        """Return stiffness across and along the base, and the gap at t = 0."""
        return contact.stiffness, contact.shear, contact.gap

    def _ends(self, edge):
        n = len(self.centred)
        return self.centred[edge % n], self.centred[(edge + 1) % n]

    def _rows(self, model):
        (x1, y1), (x2, y2) = self._ends(model.base)
        self.a = ((x2 - x1) ** 2 + (y2 - y1) ** 2).sqrt()
        tx, ty = (x2 - x1) / self.a, (y2 - y1) / self.a
        self.normal, self.shear = [], []
        for x, y in ((x1, y1), (x2, y2)):
            u, v = map(np.array, displacement_rows(x, y))
            self.normal.append(tx * v - ty * u)
            self.shear.append(tx * u + ty * v)

    def _load(self, model):
        """Pressure on the part whose middle is shifted, traction on the whole top, weight (level top edge only)."""
        (x1, y1), (x2, y2) = self._ends(model.top)
        e, length = exact(model.eccentricity), ((x2 - x1) ** 2 + (y2 - y1) ** 2).sqrt()
        part = length - 2 * abs(e)
        _, v = displacement_rows((x1 + x2) / 2 + e, (y1 + y2) / 2)
        whole, _ = displacement_rows((x1 + x2) / 2, (y1 + y2) / 2)
        F = -exact(model.pressure) * part * np.array(v) + exact(model.traction) * length * np.array(whole)
        F[1] -= self.M[0, 0] * exact(model.gravity)
        return F

    def step(self):
        """Advance by one step; return v of the centroid, N of both corners, T of both corners."""
        star = self.D + self.gg * self.dt * self.V + self.dt**2 * (HALF - self.alpha) * self.A
        found = [(self._moved(star, closed), closed) for closed in self.states]
        ((D1, closed),) = [(D1, closed) for D1, closed in found if self._agrees(D1, closed)]
        N = [-self.p * gap if shut else ZERO for gap, shut in zip(self._gaps(D1), closed, strict=True)]
        T = [-self.ps * (row @ D1) if shut else ZERO for row, shut in zip(self.shear, closed, strict=True)]
        push = zeros(6)
        for c in (0, 1):
            push += N[c] * self.normal[c] + T[c] * self.shear[c]
        A1 = self.inverse @ (self.F - self.K0 @ D1 + push)
        self.V = self.gg * self.V + self.dt * ((1 - self.delta) * self.A + self.delta * A1)
        self.D, self.A = D1, A1
        return D1[1], N, T

    def _gaps(self, D):
        return [self.g0 + row @ D for row in self.normal]

    def _agrees(self, D, closed):
        return all((w < 0) == shut for w, shut in zip(self._gaps(D), closed, strict=True))

    def _moved(self, star, closed):
        """Return where a step leads with these corners closed."""
        if self.alpha == 0:
            return star
        b = self.M @ star + self.h * self.F
        for row, shut in zip(self.normal, closed, strict=True):
            b -= self.h * self.p * self.g0 * row * shut
        if closed not in self.factors:
            S = self.free.copy()
            for n, s, shut in zip(self.normal, self.shear, closed, strict=True):
                S += shut * self.h * (self.p * np.outer(n, n) + self.ps * np.outer(s, s))
            self.factors[closed] = factorised(S)
        return solved(self.factors[closed], b)


class LockedBlock(OpeningBlock):
    """The same whose corners stay closed, and pull."""

    states = ((True, True),)

    @staticmethod
    def springs(contact):
        return contact.normal, contact.shear, 0.0

    def _agrees(self, D, closed):
        return True


def locked_matrices(model, scheme):
    """Return M, K with the springs of both corners, and F."""
    with mp.workdps(DIGITS), localcontext(Context(prec=DIGITS)):
        block = LockedBlock(model, scheme)
        springs = zip(block.normal, block.shear, strict=True)
        return (
            block.M,
            block.K0 + sum(block.p * np.outer(n, n) + block.ps * np.outer(s, s) for n, s in springs),
            block.F,
        )


def history(model, scheme, steps, kind=OpeningBlock):
    """Return v [m], the normal forces and the shear forces [N] of every step."""
    with mp.workdps(DIGITS), localcontext(Context(prec=DIGITS)):
        block = kind(model, scheme)
        return [_with_mpf(block.step()) for _ in range(steps)]


def locked_history(model, scheme, steps):
    """Return v of the centroid and the contact pressure of every step, as lists."""
    rows = history(model, scheme, steps, LockedBlock)
    start, end = model.block.edge(model.base)
    with mp.workdps(DIGITS):
        width = mp.hypot(*(mpf(float(x)) - mpf(float(y)) for x, y in zip(end, start, strict=True)))
        return [v for v, _, _ in rows], [sum(N) / width for _, N, _ in rows]


def _with_mpf(values):
    """Return the same lists in numbers of mpmath."""
    return list(map(_with_mpf, values)) if isinstance(values, list | tuple) else mpf(str(values))


def lost(values, exact):
    """Return the maximum error over the maximum value."""
    with mp.workdps(DIGITS):
        peak = max(abs(x) for x in exact)
        if peak == 0:
            return 0.0 if all(v == 0 for v in values) else float("inf")
        return float(max(abs(mpf(float(v)) - x) for v, x in zip(values, exact, strict=True)) / peak)
