"""A block on corners that open, in high-precision arithmetic and in the displacement form with springs.

Nothing is shared with the package: matrices are those of `mp_reference`, the springs of the closed corners are part of
the matrix of the step, and the crossing of a closing corner is found by repetition. Many digits make harmless
what this form loses by subtraction. Steps are made with arrays of `decimal`'s numbers, which are compiled.
"""

from decimal import Context, Decimal, localcontext
from itertools import product
from types import SimpleNamespace

import numpy as np
from mpmath import mp, mpf
from oracles import mp_reference
from oracles.mp_reference import decimal

DIGITS = 60
ZERO, ONE, HALF = Decimal(0), Decimal(1), Decimal("0.5")


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


class Oracle:
    """The model and the scheme in numbers of many digits."""

    def __init__(self, model, scheme):
        locked = SimpleNamespace(
            block=model.block,
            contact=SimpleNamespace(normal=0, shear=0),
            base=model.base,
            top=model.top,
            pressure=model.pressure,
        )
        M, K0, _, _ = mp_reference.matrices(locked)
        self.M, self.K0, self.inverse = array(M), array(K0), array(M**-1)
        self.alpha, self.delta, self.gg, self.dt = map(exact, (scheme.alpha, scheme.delta, scheme.gg, scheme.step))
        points = [(mpf(float(x)), mpf(float(y))) for x, y in model.block.corners]
        _, x0, y0, *_ = mp_reference.integrals(points)
        self.centred = [(decimal(x - x0), decimal(y - y0)) for x, y in points]
        self.p, self.ps, self.g0 = (exact(getattr(model.contact, name)) for name in ("stiffness", "shear", "gap"))
        self.F = self._load(model)
        self._rows(model)
        self.D, self.V = zeros(6), zeros(6)
        self.V[1] = exact(model.velocity)
        self.A = self.inverse @ self.F if scheme.start == "consistent" else zeros(6)
        self.closed = (self.g0 == 0,) * 2
        self.r = [ZERO, ZERO]
        self.h = self.alpha * self.dt**2
        self.free = self.M + self.h * self.K0
        self.factors = {}  # of the matrix of the step, by closed corners and their shares

    def _ends(self, edge):
        n = len(self.centred)
        return self.centred[edge % n], self.centred[(edge + 1) % n]

    def _rows(self, model):
        (x1, y1), (x2, y2) = self._ends(model.base)
        self.a = ((x2 - x1) ** 2 + (y2 - y1) ** 2).sqrt()
        tx, ty = (x2 - x1) / self.a, (y2 - y1) / self.a
        self.normal, self.shear = [], []
        for x, y in ((x1, y1), (x2, y2)):
            u, v = map(np.array, mp_reference.displacement_rows(x, y))
            self.normal.append(tx * v - ty * u)
            self.shear.append(tx * u + ty * v)

    def _load(self, model):
        """Pressure on the part whose middle is shifted, traction on the whole top, weight (level top edge only)."""
        (x1, y1), (x2, y2) = self._ends(model.top)
        e, length = exact(model.eccentricity), ((x2 - x1) ** 2 + (y2 - y1) ** 2).sqrt()
        part = length - 2 * abs(e)
        _, v = mp_reference.displacement_rows((x1 + x2) / 2 + e, (y1 + y2) / 2)
        whole, _ = mp_reference.displacement_rows((x1 + x2) / 2, (y1 + y2) / 2)
        F = -exact(model.pressure) * part * np.array(v) + exact(model.traction) * length * np.array(whole)
        F[1] -= self.M[0, 0] * exact(model.gravity)
        return F

    def step(self):
        """Advance by one step; return v of the centroid, N of both corners, T of both corners."""
        self._begin()
        found = [trial for trial in map(self._trial, product((False, True), repeat=2)) if trial]
        assert len(found) == 1, "the oracle needs exactly one contact state"
        D1, N, T, self.r, self.closed = found[0]
        self._moved(D1, N, T)
        return D1[1], N, T

    def _begin(self):
        """Keep what all trials of a step have in common."""
        self.star = self.D + self.gg * self.dt * self.V + self.dt**2 * (HALF - self.alpha) * self.A
        self.loads = self.M @ self.star + self.h * self.F
        self.before = [self.g0 + row @ self.D for row in self.normal]

    def _moved(self, D1, N, T):
        """Take over the end of a step: acceleration from the forces, velocity from the accelerations."""
        push = zeros(6)
        for c in (0, 1):
            push += N[c] * self.normal[c] + T[c] * self.shear[c]
        A1 = self.inverse @ (self.F - self.K0 @ D1 + push)
        self.V = self.gg * self.V + self.dt * ((1 - self.delta) * self.A + self.delta * A1)
        self.D, self.A = D1, A1

    def _trial(self, closed):
        """Return the step with these corners closed if its gaps agree with that."""
        found = self._repeated(closed)
        if found is None or any((w < 0) != shut for w, shut in zip(found[1], closed, strict=True)):
            return None
        return self._accepted(*found)

    def _repeated(self, states):
        """Return displacements, gaps, states and shares when these agree with each other, None where they never do."""
        shares = [ONE if was else HALF for was in self.closed]
        for _ in range(400):
            D1 = self._solve(states, shares)
            gaps = [self.g0 + row @ D1 for row in self.normal]
            new = self._shares(gaps)
            if max(abs(x - y) for x, y in zip(new, shares, strict=True)) < Decimal(10) ** (10 - DIGITS):
                return D1, gaps, states, shares
            shares = new
        return None

    def _shares(self, gaps):
        """Return the share 1 - theta of the step's slide behind the crossing; 1 of a corner that was closed."""
        pairs = zip(self.closed, self.before, gaps, strict=True)
        return [ONE if was or w0 <= 0 else max(ZERO, -w1) / (w0 + max(ZERO, -w1)) for was, w0, w1 in pairs]

    def _reference(self, corner):
        """Return r, from which the share of the slide is measured."""
        return self.r[corner] if self.closed[corner] else self.shear[corner] @ self.D

    def _solve(self, closed, shares):
        if self.alpha == 0:
            return self.star
        b = self.loads.copy()
        for c in (0, 1):
            if closed[c]:
                sticking = self.ps * shares[c] * self._reference(c)
                b += self.h * (sticking * self.shear[c] - self.p * self.g0 * self.normal[c])
        return self._solved(tuple(self.ps * x if shut else None for x, shut in zip(shares, closed, strict=True)), b)

    def _solved(self, key, b):
        """Solve with the step's matrix, whose factors are kept: most steps have the states and shares of others."""
        if key not in self.factors:
            self.factors[key] = factorised(self._matrix(key))
        return solved(self.factors[key], b)

    def _matrix(self, held):
        """Return the matrix of the step from the shear stiffness of every corner, None where it is open."""
        S = self.free.copy()
        for n, s, ps in zip(self.normal, self.shear, held, strict=True):
            if ps is not None:
                S += self.h * (self.p * np.outer(n, n) + ps * np.outer(s, s))
        return S

    def _accepted(self, D1, gaps, closed, shares):
        N, T, r = [ZERO] * 2, [ZERO] * 2, [ZERO] * 2
        for c in (0, 1):
            if closed[c]:
                s = self.shear[c] @ D1
                stretch = shares[c] * (s - self._reference(c))
                N[c], T[c], r[c] = -self.p * gaps[c], -self.ps * stretch, s - stretch
        return D1, N, T, r, closed


def history(model, scheme, steps, kind=Oracle):
    """Return v [m], the normal forces and the shear forces [N] of every step."""
    with mp.workdps(DIGITS), localcontext(Context(prec=DIGITS)):
        oracle = kind(model, scheme)
        return [_with_mpf(oracle.step()) for _ in range(steps)]


def _with_mpf(values):
    """Return the same lists in numbers of mpmath."""
    return list(map(_with_mpf, values)) if isinstance(values, list | tuple) else mpf(str(values))


def lost(values, exact):
    """Return the maximum error over the maximum value."""
    with mp.workdps(DIGITS):
        return mp_reference.lost(values, exact)
