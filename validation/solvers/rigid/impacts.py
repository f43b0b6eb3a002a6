"""The restitution of a rigid mass on a penalty contact."""

from __future__ import annotations


def impact_statistics(alpha: float, delta: float, gg: float, omega: float) -> tuple[float, float, float, float]:
    """Return mean, least, greatest and mean square of the restitution of a penalty contact over its phase.

    A mass without load under Newmark's scheme, omega = sqrt(k / m) dt, `math.inf` for a rigid contact. The phase is how
    far the first predictor in contact lies below the spring's end, over V dt: uniform from 0 to gg, as that step covers
    gg V dt and starts above the spring.

    Raises
    ------
    ValueError
        A number is out of the range in which the map is defined.
    """
    from fem_reference.events.restitution import ContactScheme, statistics

    restitutions = statistics(ContactScheme(alpha, delta, gg), omega)
    return restitutions.mean, restitutions.low, restitutions.high, restitutions.mean_square


def impact_restitution(alpha: float, delta: float, gg: float, omega: float, phase: float) -> float:
    """Return the restitution of one phase, see `impact_statistics`."""
    from fem_reference.events.restitution import ContactScheme, restitution

    return restitution(ContactScheme(alpha, delta, gg), omega, phase)
