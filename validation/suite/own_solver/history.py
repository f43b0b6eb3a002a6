"""What a history shows in place of a report: where the motion comes to rest, its natural frequency and its damping.

The displacement of the two-block model is a sum of five powers of the roots of its step, n counting steps,

    v_n = v_static + sum_k c_k z_k^n,   z_1, z_1*, z_2, z_2*,

whose strongest pair is that of the first axial mode: w' = |ln z| / dt, xi = -Re(ln z) / |ln z|. From z and the scheme's
alpha and gg the natural frequency follows whatever delta was used,

    |1 - z|^2 = (1 + gg) / 2 Omega^2 / (1 + alpha Omega^2),   Omega = w dt,

since trace and determinant of a step differ by a number without delta ((10) to (12) of the paper, with gg).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from validation.gates.gate import Gate
from validation.metrics.poles import swing
from validation.metrics.values import UNDEFINED, largest
from validation.runs.history import Array, History
from validation.runs.row import Value
from validation.scenes.scene import Scene

PENCIL = 1e-6  # the ratio of a history of these scenes is the operator's to this, see the gates on measured damping
FREQUENCY = 10 * PENCIL  # relative: both numbers of the root enter, times 1 + alpha Omega^2, which is below 2
REST = 1e-6  # relative: what comes to rest is no matter of digits, which have gates of their own
AT_REST = "displacement.at_rest"  # the metric that a history has in place of `displacement.static`
TAIL = 5  # the last fifth of the steps: several periods of the scenes that come to rest
BEGUN = 2  # rows that are left out: an initial acceleration of its own, or a wrong first row, is no mode of the step
POWERS = 5  # of the two-block model
TOLERATED = 1e-4  # of the maximum: what the powers do not give back to four digits is no such sum
MARGIN = 50.0  # of a pencil's error over the bound of Cramer and Rao for one swinging power in noise


@dataclass(frozen=True)
class Root:
    """The strongest oscillation of a history."""

    frequency: float  # w' [rad/s]
    ratio: float  # xi [1]
    error: float  # of xi, and of w' relative [1]


def shown(gate: Gate, scene: Scene, history: History) -> tuple[Gate, Value]:
    """Return a gate on what the history shows in place of a report, and the value that it has."""
    if gate.metric == "displacement.static":
        value, moving = rest(history.displacement)
        reason = f"{gate.reason}; measured as the middle of the last fifth, to what still moves there"
        return replace(_wider(gate, abs(value) * REST + moving), metric=AT_REST, reason=reason), value
    strongest = root(scene, history)
    if strongest is None:
        return gate, UNDEFINED
    if gate.metric == "mode1.frequency":
        band = _wider(gate, gate.high * (FREQUENCY + strongest.error))
        return band, natural_frequency(scene, strongest.frequency, strongest.ratio)
    allowance = PENCIL if gate.metric == "mode1.damping" else 0.0  # the other gate's band holds it already
    return replace(_wider(gate, allowance + strongest.error), metric="mode1.measured_damping"), strongest.ratio


def _wider(gate: Gate, half: float) -> Gate:
    return replace(gate, low=gate.low - half, high=gate.high + half)


def rest(x: Array) -> tuple[float, float]:
    """Return the middle of what the last steps span, and its width, which the middle is known to."""
    last = x[-max(2, len(x) // TAIL) :]
    return float(np.max(last) + np.min(last)) / 2, float(np.ptp(last))


def root(scene: Scene, history: History) -> Root | None:
    """Return the strongest oscillation of the displacement by a matrix pencil, None where it is no sum of powers."""
    x = history.displacement[BEGUN:]
    motion = swing(x, scene.time.step, POWERS)
    pole = motion.pole
    if pole is None or motion.misfit > TOLERATED:
        return None
    relative_noise = MARGIN * motion.misfit * largest(x) / pole.amplitude
    error = float(relative_noise * _bound(pole.value, motion.samples) / abs(np.log(pole.value)))
    return Root(pole.frequency, pole.damping, error)


def _bound(z: complex, samples: int) -> float:
    """Error of ln z over that of the samples, relative to the amplitude: N^(-3/2) of the N samples that swing."""
    lost = max(0.0, 1 - abs(z) ** 2) + 1 / samples
    return lost * math.sqrt(lost)


def natural_frequency(scene: Scene, numerical: float, ratio: float) -> Value:
    """Natural w [rad/s] of the mode that shows w' [rad/s] and xi (see above); undefined where no root does."""
    t = scene.time
    z = np.exp(complex(-ratio, math.sqrt(max(0.0, 1 - ratio**2))) * numerical * t.step)
    q = float(2 * abs(1 - z) ** 2 / (1 + t.discount))
    return math.sqrt(q / (1 - t.alpha * q)) / t.step if 0 < q * t.alpha < 1 else UNDEFINED
