"""Small contact problems for the kernel of `fem_reference.contact`, in the terms of one step and its points."""

from dataclasses import dataclass

import numpy as np

from fem_reference.contact import kernel

FAILURES = {kernel.CONVERGED: "", kernel.NONE: "none", kernel.SEVERAL: "several", kernel.UNSETTLED: "unsettled"}


@dataclass(frozen=True)
class Forces:
    """What given states lead to."""

    normal: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    settled: bool
    trial: kernel.Trial


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

    def law(self, limit=6):
        n = len(self.compliance)
        cohesion = np.zeros(n) if self.cohesion is None else self.cohesion
        share = np.full(n, 1 / n)
        return kernel.Law(
            self.C, self.compliance, self.shear_stiffness, self.tangent, cohesion, share, 1.0, limit, False
        )

    def _forces(self, trial):
        n = len(self.compliance)
        shear = trial.forces[n:] if len(self.free) > n else np.zeros(n)
        return Forces(trial.forces[:n], shear, trial.moved[:n], trial.settled, trial)

    def forces(self, guess):
        law = self.law()
        equations = kernel.equations_of(law, guess, np.ones(len(guess)))
        return self._forces(kernel.solution(law, equations, self.free, self.gap, self.states, guess))

    def asked(self, forces, guess):
        return kernel.corrected(self.law(), forces.trial, self.gap, self.states, guess)[0]

    def contact(self, limit=6, fallback=kernel.fall_back):
        law = self.law(limit)
        equations = kernel.equations_of(law, self.states, np.ones(len(self.states)))
        trial, states, solves, outcome = kernel.contact(law, equations, self.free, self.gap, self.states, fallback)
        forces = self._forces(trial) if outcome == kernel.CONVERGED else None
        return Found(forces, states, solves, FAILURES[outcome])


def frictionless(C, compliance, free, states):
    """Points without shear springs."""
    zero = np.zeros(len(free))
    return PointStep(C, compliance, zero, free, np.where(states != 0, -1.0, 1.0) * 0, states)
