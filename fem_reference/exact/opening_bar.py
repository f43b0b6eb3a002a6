r"""The bar on a spring that carries no tension: exact in space, in time a scheme of one stage.

Without its spring the bar is free at both ends, and its motion is one rigid mode and what it stretches besides. For
the generating function D(z) = sum of D_n z^n of a history the scheme (`fem_reference.problem.stages`) says
s^2 D = (psi / phi) (A - r A_0), with psi = 1 - am + am z, phi = 1 - af + af z and

    s^2 = (psi / phi) (1 - z) (1 - gg z) / (dt^2 b),   b = (e_0 z + beta) (1 - gg z) + d_u gg z (g_0 z + gamma)
    r   = (beta (1 - gg z) + d_u gg z gamma) / b

in every mode alike, so that with x = s H / c the bar's own closed forms hold: a pressure at one end moves, beyond the
rigid mode and in units of H / E,

    that end by (x coth x - 1) / x^2,  the other by (x / sinh x - 1) / x^2,  mid-height by (x / (2 sinh(x/2)) - 1) / x^2

Their series in z are the weights of a convolution with the history of that pressure: nothing is cut off, in space
or in modes. The weights come from one transform on a circle in the unit disk, and the contact force at the end of a
step is the one unknown of the step: w = w_f + C N with C = beta' dt^2 coth(H / l) / (rho l), l = c dt sqrt(beta').

Lubich, Convolution quadrature and discretized operational calculus, Numer. Math. 52 (1988), is the theory.
"""

from __future__ import annotations

import time

import numpy as np
from scipy.fft import next_fast_len

from fem_reference.problem.bar import BarProblem, no_bar
from fem_reference.problem.problem import Array, Problem, Scheme
from fem_reference.problem.result import Result, just_ended
from fem_reference.scheme import modal
from fem_reference.scheme.stage import Motion, end_of_stage, predicted_change

OVERSAMPLED = 16
"""Points of the circle for each step: its radius loses one digit to rounding and sixteen to aliasing."""
SMALL = 1.5
"""Modulus of x below which the closed forms are continued fractions."""
LEVELS = 12
"""Levels of these: one more changes nothing that a float shows."""
NOTHING = 1e-13
"""Gap over the motions of which it is the sum, below which it is their rounding."""


class OpeningBar(BarProblem):
    """An elastic bar that is dropped on or pressed against a base spring that carries no tension."""

    @classmethod
    def of(cls, problem: Problem, gap: float = 0.0, velocity: float = 0.0) -> OpeningBar:
        """The bar that a problem reduces to, a gap [m] above its springs and with a velocity [m/s].

        A `ValueError` if it is not exact for the problem, or a number is out of its range.
        """
        reason = applicable(problem)
        if reason is not None or problem.rectangle is None:
            raise ValueError(f"problem: must reduce to a bar, but {reason}")
        width, height = problem.rectangle
        loads = problem.pressure, problem.gravity
        return cls(height, width, problem.density, problem.young, 2 * problem.stiffness, *loads, gap, velocity)

    def solve(self, scheme: Scheme, steps: int) -> Result:
        """History under a scheme; row 0 is step 1.

        Its columns are `displacement` of the mid-height [m], `contact_pressure` N / W [Pa], `gap` w under the base [m],
        negative where pressed, `closed`, 1 where it is, else 0 [-], and `velocity` of the centre of mass, upwards
        [m/s].

        Raises
        ------
        ValueError
            If the scheme has two stages or is not stable for every frequency, or `steps` is below one.
        """
        if steps < 1:
            raise ValueError(f"steps: must be at least 1, got {steps!r}")
        if reason := steppable(scheme):
            raise ValueError(f"scheme: must have one stage, but {reason}")
        if reason := modal.applicable(scheme):
            raise ValueError(f"scheme: must be stable for every frequency, but {reason}")
        began = time.perf_counter()
        own, half, across, half_load = _series(scheme, steps, self.travel)
        ready = time.perf_counter()
        unit = self.height / self.young
        columns = _stepped(self, scheme, unit * own, -self.pressure * unit * across)
        count = next_fast_len(2 * len(half), real=True)
        spectrum = np.fft.rfft(half, count) * np.fft.rfft(columns["contact_pressure"], count)
        convolved = np.fft.irfft(spectrum, count)[: len(half)]  # sum of half[k] pressure[n - k]
        columns["displacement"] += unit * (convolved - self.pressure * half_load)
        return Result(
            **just_ended(scheme.step, steps, began, ready),
            columns={name: values[1:] for name, values in columns.items()},
            unknowns=1,
        )


def applicable(problem: Problem) -> str | None:
    """Why the bar is not exact for a problem, in words; None if it is."""
    if problem.ramp:
        return "its load is constant, and that of the problem rises in a ramp"
    if not problem.vertical or problem.motion is not None:
        return "the bar carries a centred pressure and its weight only"
    return no_bar(problem)


def steppable(scheme: Scheme) -> str | None:
    """Why the bar cannot be stepped by a scheme where its base opens, in words; None if it can."""
    return f"{scheme.name!r} has {len(scheme.stages)}" if len(scheme.stages) > 1 else None


def _series(scheme: Scheme, steps: int, travel: float) -> Array:
    """What a pressure does to the bar beyond its rigid motion, from step 0 on, in units of H / E, shape (4, steps + 1).

    Weights of the end that is pressed and of the mid-height; histories of the base under a unit pressure on the top
    from t = 0 on, and of the mid-height under that pressure, for one that acts upwards.
    """
    count = next_fast_len(OVERSAMPLED * (steps + 1), real=True)
    radius = 10.0 ** (-1.0 / (steps + 1))
    z = radius * np.exp(2j * np.pi * np.arange(count // 2 + 1) / count)
    x2, load = _image(scheme, travel, z)
    stretch, across, half = closed_forms(x2)
    images = np.array([stretch, half, across * load, half * load])
    return np.asarray(np.fft.irfft(np.conj(images), count)[:, : steps + 1] / radius ** np.arange(steps + 1.0))


def _image(scheme: Scheme, travel: float, z: Array) -> tuple[Array, Array]:
    """x^2 of the scheme, and the image of a load that is one from t = 0 on, less r times the A_0 that it causes."""
    stage = scheme.stages[0]
    gg = scheme.gg
    denominator = 1 - gg * z
    carried = stage.d_u * gg * z
    b = (stage.e_0 * z + stage.beta) * denominator + carried * (stage.g_0 * z + stage.gamma)
    phi = 1 - stage.af + stage.af * z
    lag = (1 - stage.am + stage.am * z) / phi
    x2 = (travel / scheme.step) ** 2 * lag * (1 - z) * denominator / b
    # What the first step takes of the load at t = 0, and of the acceleration that it causes where there is one.
    late = 1 / (1 - z) - (1 - stage.af) / phi
    if scheme.start == "consistent":
        r = (stage.beta * denominator + carried * stage.gamma) / b
        return x2, late + (1 - stage.am) / phi - lag * r
    return x2, late


def closed_forms(x2: Array) -> tuple[Array, Array, Array]:
    """The three closed forms above, of complex x^2.

    All are even in x and regular at zero. Since 1 / sinh x = coth(x/2) - coth x, the first one, S, is enough::

        (x / sinh x - 1) / x^2 = S(x/2) / 2 - S(x)
    """
    x = np.sqrt(np.asarray(x2, complex))  # Re x >= 0, so that the exponentials decay
    whole, half, quarter = (_stretch(x / part) for part in (1, 2, 4))
    return whole, half / 2 - whole, (quarter / 2 - half) / 4


def _stretch(x: Array) -> Array:
    """(x coth x - 1) / x^2, for small x by Lambert's continued fraction 1 / (3 + x^2 / (5 + x^2 / (7 + ...)))."""
    near = np.abs(x) < SMALL
    small = np.where(near, x, 0.0) ** 2
    fraction = np.zeros_like(x)
    for odd in range(2 * LEVELS + 1, 1, -2):
        fraction = 1 / (odd + small * fraction)
    with np.errstate(divide="ignore", invalid="ignore", under="ignore"):
        e = np.exp(-2 * x)
        values = (x * (1 + e) / (1 - e) - 1) / (x * x)
    return np.where(near, fraction, values)


def _stepped(bar: OpeningBar, scheme: Scheme, loaded: Array, free: Array) -> dict[str, Array]:
    """Columns of the history from step 0 on, the displacement being that of the rigid motion.

    `loaded` are the weights of the base's own pressure [m/Pa], `free` is what the load alone does to the base beyond
    the rigid motion [m], each of shape (steps + 1,).
    """
    count = len(loaded)
    dt = scheme.step
    stage = scheme.stages[0]
    gg = scheme.gg
    surface = bar.density * bar.height
    compliance = bar.width / bar.base_stiffness
    load = -bar.pressure / surface - bar.gravity
    now = Motion(0.0, bar.velocity, load if scheme.start == "consistent" else 0.0)
    C = stage.stiffness_weight * dt**2 / surface + loaded[0]
    backwards = loaded[::-1].copy()
    rigid = np.zeros(count)
    N = np.zeros(count)
    gap = np.full(count, bar.gap)
    closed = np.zeros(count)
    speed = np.full(count, bar.velocity)
    closed[0] = bar.gap == 0
    for n in range(1, count):
        predicted = predicted_change(stage, dt, gg, now, now)
        e = load + stage.af * N[n - 1] / surface - stage.am * now.A  # but for the force at the end of the step
        ahead = end_of_stage(stage, dt, gg, now, now, predicted, e, now.D).D
        past = N[1:n] @ backwards[count - n : -1]
        w = bar.gap + ahead + (free[n] + past)
        noise = NOTHING * (abs(ahead) + abs(free[n]) + abs(past))
        if abs(w) <= noise:  # neither pressed nor lifted
            w = 0.0
            closed[n] = closed[n - 1]
        else:
            closed[n] = w < 0
        if w < 0:
            N[n] = -w / (C + compliance)
        gap[n] = -compliance * N[n] if closed[n] else w
        now = end_of_stage(stage, dt, gg, now, now, predicted, e + (1 - stage.af) * N[n] / surface, now.D)
        rigid[n] = now.D
        speed[n] = now.V
    return {"displacement": rigid, "contact_pressure": N, "gap": gap, "closed": closed, "velocity": speed}
