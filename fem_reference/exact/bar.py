"""The block as a bar on a spring: exact in space, in time a scheme's or exact.

With mu = 0, a vertical load and a distributed foundation every vertical line of an upright rectangle
moves alike: a bar of length h and stiffness EA = E W per unit thickness on a base spring k = 2 p, with
the force q W switched on at its top. With kappa = k h / (E W) its modes are::

    b tan b = kappa,   w = (b / h) sqrt(E / rho),   shape cos(b (1 - y / h)), y from the base

A mode of index n lies at b = n pi + atan(kappa / b), so that cos b = (-1)^n b / sqrt(b^2 + kappa^2)
keeps its relative digits for soft and stiff springs alike. Each history is::

    static value * (1 - sum over modes of share * x(w, t)),   sum over modes of share = 1

with x = cos w t for the continuum and the scheme's own response for Newmark. The shares alternate in
sign and are smooth in n up to a slow rotation, so that the sum is cut off smoothly: its error falls
faster than any power of the number of modes, also for the modes far beyond the time step.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from fem_reference.exact import continuum, viscous
from fem_reference.exact.bar_modes import cut_off, shares, wave_numbers
from fem_reference.problem.bar import BarProblem, no_bar
from fem_reference.problem.problem import Array, Problem, Scheme
from fem_reference.problem.result import Mode, Result, check_request, just_ended
from fem_reference.scheme.modal import applicable as steppable
from fem_reference.scheme.modal import ramped_response, roots, weighted_response

FIRST = 256
"""Modes of the first attempt."""
LAST = 2**16
"""Modes of the last attempt."""
BEGUN = 1e-3
"""Part of the wave's own effect, min(1, kappa) of the static value, below which a history has not begun."""
TARGET = 1e-11
"""Estimated truncation error over the maximum at which no more modes are added."""


@dataclass(frozen=True)
class Bar(BarProblem):
    """An elastic bar on a spring under a pressure on its top, at once or in a ramp; its spring also pulls."""

    ramp: float = 0.0  # time in which the pressure rises linearly from zero [s]

    @classmethod
    def of(cls, problem: Problem) -> Bar:
        """The bar that a problem reduces to; a `ValueError` if it is not exact for the problem."""
        reason = applicable(problem)
        if reason is not None or problem.rectangle is None:
            raise ValueError(f"problem: must reduce to a bar, but {reason}")
        width, height = problem.rectangle
        data = problem.density, problem.young, 2 * problem.stiffness, problem.pressure
        return cls(height, width, *data, ramp=problem.ramp)

    def static(self) -> dict[str, float]:
        """Static value of each column: -(q W / k + q h / (2 E)), q and zero."""
        unit = self.pressure * self.height / self.young
        return {
            "displacement": -unit * (1 / self.kappa + 0.5),
            "contact_pressure": self.pressure,
            "horizontal_displacement": 0.0,
        }

    def frequencies(self, count: int) -> Array:
        """The lowest natural frequencies w = b c / h [rad/s], shape (count,)."""
        return wave_numbers(self.kappa, count) / self.travel

    def modes(self, scheme: Scheme, count: int = 3) -> tuple[Mode, ...]:
        """The lowest modes, with the eigenvalues of the scheme's step."""
        b = wave_numbers(self.kappa, count)
        weight = shares("load", b, self.kappa)
        pairs = zip((b / self.travel).tolist(), weight.tolist(), strict=True)
        return tuple(Mode(w, share, roots(w * scheme.step, scheme)) for w, share in pairs)

    def solve(
        self, scheme: Scheme, steps: int, columns: tuple[str, ...] = ("displacement", "contact_pressure")
    ) -> Result:
        """History under a scheme; row 0 is step 1.

        Raises
        ------
        ValueError
            If the scheme is not stable for every frequency, or `steps` or `columns` are not valid.
        """
        check_request(steps, columns)
        if reason := steppable(scheme):
            raise ValueError(f"scheme: must be stable for every frequency, but {reason}")
        began = time.perf_counter()
        count = FIRST
        while True:
            history, estimate = self._sum(scheme, steps, columns, count)
            if estimate <= TARGET or count >= LAST:
                break
            count *= 2
        return self._result(scheme.step, history, count, columns, estimate, began)

    def _sum(self, scheme: Scheme, steps: int, columns: tuple[str, ...], count: int) -> tuple[Array, float]:
        """Histories over their static values and the truncation error over the maximum."""
        b = wave_numbers(self.kappa, count)
        weights = np.array([shares(name, b, self.kappa) for name in columns])
        cut = np.vstack([weights * cut_off(count, count), weights * cut_off(count, count // 2)])
        omega = b / self.travel * scheme.step
        if self.ramp:
            acting = np.minimum(scheme.stage_times(steps) / self.ramp, 1.0)
            history = ramped_response(omega, cut, scheme, steps, acting)
        else:
            history = weighted_response(omega, cut, scheme, steps)
        fine = history[: len(columns)]
        coarse = history[len(columns) :]
        error = np.abs(fine - coarse).max(axis=1, initial=0.0)
        scale = np.maximum(np.abs(fine).max(axis=1, initial=0.0), BEGUN * min(1.0, self.kappa))
        return fine, float((error / scale).max(initial=0.0))

    def continuum(
        self, scheme: Scheme, steps: int, columns: tuple[str, ...] = ("displacement", "contact_pressure")
    ) -> Result:
        """Exact history at the scheme's instants; its gg becomes the damping rate c = -ln(gg) / dt.

        Raises
        ------
        ValueError
            If gg is zero, the load rises in a ramp, or `steps` or `columns` are not valid.
        """
        check_request(steps, columns)
        if self.ramp:
            raise ValueError(f"ramp: must be 0 for a bar in continuous time, got {self.ramp!r}")
        if scheme.gg == 0:
            raise ValueError("gg: must be positive for a damping rate -ln(gg) / dt, got 0")
        began = time.perf_counter()
        s = scheme.step * np.arange(1.0, steps + 1) / self.travel
        rate = (scheme.mass_damping - float(np.log(scheme.gg)) / scheme.step) * self.travel
        if scheme.stiffness_damping:
            lag = scheme.stiffness_damping / self.travel
            history, change = viscous.histories(s, self.kappa, rate, lag, columns)
            return self._result(scheme.step, history, 0, columns, change, began)
        history = continuum.histories(s, self.kappa, rate, columns)
        return self._result(scheme.step, history, 0, columns, None, began)

    def _result(
        self, step: float, history: Array, count: int, columns: tuple[str, ...], estimate: float | None, began: float
    ) -> Result:
        static = self.static()
        return Result(
            **just_ended(step, history.shape[1], began, began),
            columns={name: static[name] * row for name, row in zip(columns, history, strict=True)},
            unknowns=count,
            nonzeros=count,
            notes=("exact in space: a bar on a spring",),
            estimate=estimate,
        )


def applicable(problem: Problem) -> str | None:
    """Why the bar is not exact for a problem, in words; None if it is."""
    if not problem.vertical or problem.gravity != 0 or problem.motion is not None:
        return "the bar carries a centred pressure only"
    return no_bar(problem)
