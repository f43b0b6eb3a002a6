"""A block that rubs on two corners, in many digits: every combination of open, stick and slip is tried."""

from itertools import product

import numpy as np
from mpmath import mp, mpf
from oracles import unilateral_mp
from oracles.mp_reference import decimal
from oracles.unilateral_mp import HALF, ZERO, exact

OPEN, STICK = 0, 1  # and 2, -2 for slip


class Rubbing(unilateral_mp.Oracle):
    """The displacement form: T of a slipping corner makes the matrix of the step unsymmetric."""

    def __init__(self, model, scheme):
        super().__init__(model, scheme)
        beta = mpf(model.slope) * mp.pi / 180
        weight = self.M[0, 0] * exact(model.gravity)
        self.F[0] += weight * decimal(mp.sin(beta))
        self.F[1] += weight * decimal(1 - mp.cos(beta))
        if scheme.start == "consistent":
            self.A = self.inverse @ self.F
        self.mu, self.c = exact(model.contact.friction), exact(model.contact.cohesion)

    def step(self):
        """Advance by one step; return (u, v, r), N of both corners, T of both corners."""
        self._begin()
        found = [trial for trial in map(self._tried, product((OPEN, STICK, 2, -2), repeat=2)) if trial]
        assert len(found) == 1, "the oracle needs exactly one contact state"
        D1, N, T, self.r, self.closed = found[0]
        self._moved(D1, N, T)
        return [D1[0], D1[1], D1[2]], N, T

    def _tried(self, states):
        found = self._repeated(states)
        return found and self._agreed(*found)

    def _solve(self, states, shares):
        b = self.loads.copy()
        for i, state in enumerate(states):
            if state == OPEN:
                continue
            n, s, sign = self.normal[i], self.shear[i], state * HALF
            b -= self.h * self.p * self.g0 * n
            if state == STICK:
                b += self.h * self.ps * shares[i] * self._reference(i) * s
            else:  # T = -sign (mu N + c), N = -p w
                b += self.h * sign * (self.mu * self.p * self.g0 - self.c) * s
        held = (self.ps * share if state == STICK else None for state, share in zip(states, shares, strict=True))
        return self._solved(tuple(zip(states, held, strict=True)), b)

    def _matrix(self, held):
        S = self.free.copy()
        for n, s, (state, ps) in zip(self.normal, self.shear, held, strict=True):
            if state == OPEN:
                continue
            S += self.h * self.p * np.outer(n, n)
            S += self.h * (ps * np.outer(s, s) if state == STICK else -state * HALF * self.mu * self.p * np.outer(s, n))
        return S

    def _agreed(self, D1, gaps, states, shares):
        N, T, r = [ZERO] * 2, [ZERO] * 2, [ZERO] * 2
        for i, (state, w) in enumerate(zip(states, gaps, strict=True)):
            if (w < 0) != (state != OPEN):
                return None
            if state == OPEN:
                continue
            N[i], s = -self.p * w, self.shear[i] @ D1
            moved, limit = shares[i] * (s - self._reference(i)), self.mu * N[i] + self.c
            T[i] = -self.ps * moved if state == STICK else -state * HALF * limit
            if state == STICK and abs(T[i]) > limit:
                return None
            if state != STICK and state * (moved + T[i] / self.ps) < 0:
                return None
            r[i] = s + T[i] / self.ps
        return D1, N, T, r, tuple(state != OPEN for state in states)


def history(model, scheme, steps):
    """Return (u, v, r) [m, m, 1], the normal forces and the shear forces [N] of every step."""
    return unilateral_mp.history(model, scheme, steps, Rubbing)
