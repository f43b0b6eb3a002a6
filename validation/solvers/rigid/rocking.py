"""The rocking of a rigid block on a rigid base: quarter period, impacts, overturning."""

from __future__ import annotations

from dataclasses import dataclass

from validation.runs.history import Array


@dataclass(frozen=True)
class Rocking:
    """Motion of a rigid block that rocks."""

    time: Array  # instants [s], shape (times,)
    rotation: Array  # rotation, positive about the right corner and towards +x [rad], shape (times,)
    rate: Array  # its rate [rad/s], shape (times,)
    impacts: tuple[float, ...]  # instants at which it came down on the other corner [s]
    overturned: bool  # whether it fell on its side


def quarter_period(width: float, height: float, tilt: float, gravity: float = 9.81) -> float:
    """Return the time in which a block that is released at a tilt [rad] comes down [s], its rotation not being small.

    Raises
    ------
    ValueError
        A number is out of its range, such as a tilt beyond atan(width / height).
    """
    from fem_reference.exact.rocking import RockingBlock

    return RockingBlock(width, height, gravity).quarter_period(tilt)


def rocking(
    width: float,
    height: float,
    tilt: float,
    time: Array,
    restitution: float | None = None,
    gravity: float = 9.81,
) -> Rocking:
    """Return the rocking of a block that is released at rest from a tilt [rad].

    Parameters
    ----------
    width, height, gravity
        Of the block [m], and g [m/s2].
    tilt
        Rotation at t = 0 [rad].
    time
        Instants from 0 on that are reported [s], shape (times,); those after a fall are left out.
    restitution
        Rate after over rate before an impact [-]; None: Housner's, which keeps the moment of momentum.

    Raises
    ------
    ValueError
        A number is out of its range.
    """
    from fem_reference.exact.rocking import RockingBlock, solve

    motion = solve(RockingBlock(width, height, gravity, restitution), float(time[-1]), tilt)
    seen = time[time <= motion.end]
    return Rocking(seen, *motion.at(seen), motion.impacts, motion.overturned)


def overturning_acceleration(
    width: float, height: float, duration: float, shape: str = "half-sine", gravity: float = 9.81
) -> float:
    """Return the least amplitude of a pulse of the base that overturns a block at rest [m/s2].

    Parameters
    ----------
    width, height, gravity
        Of the block [m], and g [m/s2].
    duration
        Duration of the pulse [s].
    shape
        ``"half-sine"`` or ``"rectangle"``.

    Raises
    ------
    ValueError
        A number is out of its range.
    """
    from fem_reference.exact.rocking import RockingBlock, overturning_amplitude

    return overturning_amplitude(RockingBlock(width, height, gravity), duration, shape)
