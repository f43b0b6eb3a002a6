"""Small contact problems for the rows of `fem_reference.contact`, in the terms of one step and its points."""

from dataclasses import dataclass

import numpy as np

from fem_reference.contact import iteration, law
from fem_reference.contact.law import AT_LOWER, AT_UPPER, INSIDE

FAILURES = {iteration.CONVERGED: "", iteration.NONE: "none", iteration.SEVERAL: "several"}
FAILURES[iteration.UNSETTLED] = "unsettled"
# a point: open; closed, its shear spring held; closed and sliding towards +x, towards -x
OPEN, STICK, SLIP = 0, 1, 2
ROWS = {OPEN: (AT_LOWER, INSIDE), STICK: (INSIDE, INSIDE), SLIP: (INSIDE, AT_LOWER), -SLIP: (INSIDE, AT_UPPER)}
NAMES = {rows: point for point, rows in ROWS.items()}


@dataclass(frozen=True)
class Forces:
    """What given states lead to."""

    normal: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    settled: bool
    trial: law.Trial


@dataclass(frozen=True)
class Found:
    """Contact of a step, its forces None where there is none."""

    trial: Forces | None
    states: np.ndarray
    solves: int
    failure: str


@dataclass(frozen=True)
class PointStep:
    """Points in one step: gaps (and slips) without forces, gaps and states at its start."""

    C: np.ndarray
    compliance: np.ndarray
    shear_stiffness: np.ndarray
    free: np.ndarray
    gap: np.ndarray
    states: np.ndarray
    tangent: float = np.inf
    cohesion: np.ndarray | None = None

    @property
    def closed(self):
        return self.states != 0

    @property
    def holds(self):
        return len(self.free) > len(self.gap)

    def law(self, limit=6):
        n = len(self.compliance)
        slides = np.isfinite(self.tangent)
        one = np.arange(n)
        compliance, upper, friction, slips = self.compliance, np.full(n, np.inf), np.zeros(n), np.zeros(n, dtype=bool)
        lower = np.zeros(n)
        if self.holds:
            cohesion = np.zeros(n) if self.cohesion is None else self.cohesion
            strength = cohesion if slides else np.full(n, np.inf)
            compliance, one = np.append(compliance, 1 / self.shear_stiffness), np.tile(one, 2)
            lower, upper = np.append(lower, -strength), np.append(upper, strength)
            friction = np.append(friction, np.full(n, self.tangent if slides else 0.0))
            slips = np.append(slips, np.ones(n, dtype=bool))
        single = (4 if slides else 100) * n
        return law.Law(self.C, compliance, lower, upper, friction, one, slips, limit, single)

    def rows(self, states):
        """States of the rows of points."""
        of_points = np.array([ROWS[state] for state in np.asarray(states).tolist()], dtype=np.int8)
        return of_points.T.ravel() if self.holds else of_points[:, 0]

    def points(self, rows):
        """States of points by their rows."""
        n = len(self.compliance)
        beside = rows[n:] if self.holds else np.full(n, INSIDE)
        return np.array([NAMES[pair] for pair in zip(rows[:n].tolist(), beside.tolist(), strict=True)], dtype=np.int8)

    @property
    def begun(self):
        """Gaps of the rows at the start, and their states."""
        gap = np.append(self.gap, np.zeros(len(self.gap))) if self.holds else self.gap
        return gap, self.rows(self.states)

    def _forces(self, trial):
        n = len(self.compliance)
        shear = trial.force[n:] if self.holds else np.zeros(n)
        return Forces(trial.force[:n], shear, trial.place[:n], trial.settled, trial)

    def forces(self, guess):
        rows = self.law()
        equations = law.equations_of(rows, self.rows(guess), np.ones(len(self.free)))
        return self._forces(law.solution(rows, equations, self.free, *self.begun, self.rows(guess)))

    def asked(self, forces, guess):
        return self.points(law.agreed(self.law(), forces.trial, *self.begun, self.rows(guess))[0])

    def contact(self, limit=6, fallback=iteration.fall_back):
        rows = self.law(limit)
        gap, states = self.begun
        equations = law.equations_of(rows, states, np.ones(len(states)))
        trial, states, solves, outcome = iteration.find_contact(rows, equations, self.free, gap, states, fallback)
        forces = self._forces(trial) if outcome == iteration.CONVERGED else None
        return Found(forces, self.points(states), solves, FAILURES[outcome])


def frictionless(C, compliance, free, states):
    """Points without shear springs."""
    zero = np.zeros(len(free))
    return PointStep(C, compliance, zero, free, np.where(states != 0, -1.0, 1.0) * 0, states)
