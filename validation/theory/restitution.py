r"""The restitution of a rigid mass on a spring and a dashpot, exact in time, and the damping ratio of a restitution.

A mass m lands on k and c without load, zeta = c / (2 sqrt(k m)). Contact that lets go where its force is zero leaves,
with s = sqrt(|1 - zeta^2|),

    e = exp(-(zeta/s) atan2(2 zeta s, 2 zeta^2 - 1)),              zeta < 1
    e = exp(-2),                                                  zeta = 1
    e = exp(-(zeta/s) ln((zeta + s)/(zeta - s))),                  zeta > 1

e falls from 1 towards 0 as 1/(4 zeta^2), so that every e above 0 has its zeta.
"""

from __future__ import annotations

import math

LARGEST_LOGARITHM = 700.0  # whose exponential is finite; -ln e of the least number is 745
DIGITS = 4 * 2.0**-52  # of the damping ratio, as many as the search has


def restitution(zeta: float) -> float:
    """Return e of a damping ratio, or raise ValueError where that is negative or not a number."""
    if not zeta >= 0:
        raise ValueError(f"damping_ratio: must not be negative, got {zeta!r}")
    return 0.0 if math.isinf(zeta) else math.exp(-zeta * contact_time(zeta))


def contact_time(zeta: float) -> float:
    """Return w_c times the duration of the contact: (2/s) atan(s/zeta), or (2/s) artanh(s/zeta) beyond zeta = 1."""
    s = math.sqrt(abs(1 - zeta)) * math.sqrt(1 + zeta)
    if s == 0:
        return 2.0
    if zeta < 1:
        return 2 * math.atan2(s, zeta) / s
    return 2 * math.asinh(s) / s  # artanh(s/zeta) without the difference zeta - s


def damping_ratio(e: float) -> float:
    """Return zeta of a restitution, 0 at e = 1.

    Raises ValueError unless 0 < e <= 1: no dashpot stops a block for good, zeta goes to infinity as 1/(2 sqrt(e)).
    """
    if not 0 < e <= 1:
        raise ValueError(
            "restitution: must be above 0 and at most 1 with a dashpot, whose damping ratio would be infinite at 0 "
            f'(rule = "impact" takes 0), got {e!r}'
        )
    if e == 1:
        return 0.0
    from scipy.optimize import brentq

    loss = -math.log(e)
    # -ln e rises with zeta; it is at most pi zeta, and at least ln(1 + zeta)
    low = math.log(loss / math.pi)
    high = math.log(max(1.0, math.expm1(min(loss, LARGEST_LOGARITHM))))
    return math.exp(
        brentq(lambda x: math.exp(x) * contact_time(math.exp(x)) - loss, low, high, xtol=DIGITS, rtol=DIGITS)
    )
