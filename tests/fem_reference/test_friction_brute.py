"""Points that slide against brute force over all sets of states, and a stiff block against the rigid one."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from oracles.elements import make

from fem_reference import Friction, Scheme, Unilateral, assemble, solve_unilateral
from fem_reference.contact.points import build

CONSTANT = Scheme(0.5, 1.0, 1.0, 2e-4, "consistent")
AVERAGE = Scheme(0.25, 0.5, 1.0, 2e-4, "consistent")
RUBBING = Unilateral(shear="glued", friction=Friction(25.0))


class Brute:
    """Newmark steps in which every set of states is tried, with the springs in the matrix instead of their forces."""

    def __init__(self, M, K, F, Bn, Bt, k, k_t, tan, cohesion, scheme):
        self.M, self.K, self.F, self.Bn, self.Bt, self.k, self.k_t = M, K, F, Bn, Bt, k, k_t
        self.tan, self.cohesion, self.scheme = tan, cohesion, scheme
        self.D, self.V, self.A = 0 * F, 0 * F, np.linalg.solve(M, F) * (scheme.start == "consistent")
        self.w, self.s, self.r = (np.zeros(len(k)) for _ in range(3))
        self.closed = np.ones(len(k), bool)
        self.met, self.slid, self.again = set(), np.zeros(len(k)), 0

    def solved(self, states, ahead, phi):
        """D1, N and T for given states and crossings."""
        held, d = self.k_t * phi * (states == 1), np.where(np.abs(states) == 2, np.sign(states), 0)
        pressed = self.k * (states != 0)
        scale = self.scheme.alpha * self.scheme.step**2
        stiff = self.K + self.Bn.T @ (pressed[:, None] * self.Bn) + self.Bt.T @ (held[:, None] * self.Bt)
        stiff = stiff - self.Bt.T @ ((d * self.tan * self.k)[:, None] * self.Bn)
        pushed = self.F + self.Bt.T @ (held * self.r - d * self.cohesion)
        D = np.linalg.solve(self.M + scale * stiff, self.M @ ahead + scale * pushed)
        N = -pressed * (self.Bn @ D)
        return D, N, -held * (self.Bt @ D - self.r) - d * (self.tan * N + self.cohesion)

    def tried(self, states, ahead):
        """D1, N, T and the references from which the points slide, or None where the states do not hold."""
        closing, phi = (states != 0) & ~self.closed, np.where((states != 0) & ~self.closed, 0.5, 1.0)
        for _ in range(60):  # halves: 1e-14 after 47
            D, N, T = self.solved(states, ahead, phi)
            w, s = self.Bn @ D, self.Bt @ D
            crossed = np.where(closing, np.clip(w / np.where(closing, w - self.w, 1.0), 0, 1), 1.0)
            if np.abs(crossed - phi).max() < 1e-14:
                break
            phi = (phi + crossed) / 2
        r = self.r + (1 - phi) * (s - self.s)
        slides, d = np.abs(states) == 2, np.sign(states)
        good = np.where(states == 0, w >= 0, N >= 0) & (np.abs(T) <= (self.tan * N + self.cohesion) * (1 + 1e-10))
        onward = d * (s + T / self.k_t - r) >= 0
        return (D, N, T, r) if np.all(good & (onward | ~slides)) else None

    def step(self):
        dt, old = self.scheme.step, self.A
        ahead = self.D + dt * self.V + dt**2 * (0.5 - self.scheme.alpha) * old
        found = [
            (np.array(states), hit)
            for states in product((0, 1, 2, -2), repeat=len(self.k))
            if (hit := self.tried(np.array(states), ahead))
        ]
        ((states, (self.D, N, T, r)),) = found
        self.A = np.linalg.solve(self.M, self.F - self.K @ self.D + self.Bn.T @ N + self.Bt.T @ T)
        self.V = self.V + dt * ((1 - self.scheme.delta) * old + self.scheme.delta * self.A)
        self.w, self.s = self.Bn @ self.D, self.Bt @ self.D
        slides = np.abs(states) == 2
        self.slid = self.slid + np.where(slides, self.s + T / self.k_t - r, 0.0)
        self.again += np.count_nonzero(slides & ~self.closed)
        self.r = np.where(states == 0, self.s, np.where(states == 1, r, self.s + T / self.k_t))
        self.closed = states != 0
        self.met |= set(states.tolist())
        return N.sum(), T.sum()


@pytest.mark.long
@pytest.mark.parametrize(
    ("scheme", "elements"),
    [
        (replace(CONSTANT, step=1e-3), 1),
        pytest.param(replace(AVERAGE, step=5e-4), 2, marks=pytest.mark.long),
    ],
)
def test_points_that_slide_are_those_of_brute_force(scheme, elements):
    loads = {"traction": 1.5e6, "eccentricity": 0.4 if elements > 1 else 0.0}
    problem = replace(make(elements=elements, degree=1, poisson=0.2, shear=4e8), **loads)
    assembled, model = assemble(problem), build(problem)
    share = np.array([0.25, 0.5, 0.25] if elements == 2 else [0.5, 0.5])
    brute = Brute(
        assembled.M.toarray(),
        assembled.K.toarray(),
        assembled.F,
        model.normal.toarray(),
        model.tangential.toarray(),
        2e9 * share,
        8e8 * share,
        np.tan(np.radians(12.0)),
        2.0 * 2e4 * share,
        scheme,
    )
    run = solve_unilateral(problem, scheme, 24, replace(RUBBING, friction=Friction(12.0, 2e4))).columns
    forces = np.array([brute.step() for _ in range(24)]).T / 2.0
    assert brute.met >= {0, 1, 2}
    for name, expected in zip(("contact_pressure", "base_shear"), forces, strict=True):
        # thirty solutions with the springs in the matrix, of condition 1e5
        assert np.abs(run[name] - expected).max() <= 1e-8 * np.abs(expected).max()
    assert brute.again > 0  # points that close and slide within the same step
    assert run["largest_slide"][-1] == pytest.approx(np.abs(brute.slid).max(), rel=1e-8)
    assert run["displacement"][-1] == pytest.approx(assembled.observers["displacement"] @ brute.D, rel=1e-8)
