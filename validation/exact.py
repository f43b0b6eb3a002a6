"""Exact motions by plain numbers: SI units in, numpy arrays out; no scene, no study and no solver comes in.

>>> import numpy as np
>>> from validation.exact import locked_block
>>> block = {"width": 2.0, "height": 2.0, "density": 2700.0, "young": 1e9, "stiffness": 1e9}
>>> answer = locked_block(np.array([0.01]), **block, pressure=5e6)
>>> round(float(answer.displacement[0]), 6)
-0.01983

They load numpy alone, and what else they need when they are called: scipy, of blocks python-flint too. All start at
t = 0; upwards, towards +x and counter-clockwise are positive, compression is positive, everything is per metre of
thickness.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.runs import extras

if TYPE_CHECKING:
    from fem_reference.events.block_events import BlockHistory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BlockAnswer:
    """The motion of a block, each array of shape (times,).

    Attributes
    ----------
    time
        Instants [s].
    displacement, horizontal_displacement
        Of the centroid, upwards and towards +x [m].
    rotation
        Counter-clockwise [rad].
    contact_pressure
        Normal forces of both springs over the width [Pa].
    openings
        Instants at which a corner opens [s].
    closings
        Instants at which a corner closes after t = 0 [s].
    """

    time: Array
    displacement: Array
    horizontal_displacement: Array
    rotation: Array
    contact_pressure: Array
    openings: tuple[float, ...]
    closings: tuple[float, ...]


def locked_block(
    time: ArrayLike,
    *,
    width: float,
    height: float,
    density: float,
    young: float,
    stiffness: float,
    pressure: float = 0.0,
    gravity: float = 0.0,
) -> BlockAnswer:
    """Return the undamped vibration of a block of one strain on springs that push and pull, loads switched on at t = 0.

    With v of the centroid, e the vertical strain, m = rho a h and the base at v - h e / 2::

        m v''          = -2 p (v - h e / 2) - q a - m g
        m h^2 / 12 e'' = -E a h e + p h (v - h e / 2) - q a h / 2

    Parameters
    ----------
    time
        Instants from 0 on [s].
    width, height, density, young
        Of the block: a [m], h [m], rho [kg/m3], E [Pa]; Poisson's ratio is 0.
    stiffness
        p of each of the two corner springs [N/m].
    pressure, gravity
        q on the top [Pa] and g [m/s2], downwards.

    Raises
    ------
    ValueError
        A number is out of its range.

    Notes
    -----
    Source: the block of G.-H. Shi, Discontinuous Deformation Analysis (1988), its modes summed in fifty digits.
    """
    data = {"width": width, "height": height, "density": density, "young": young, "stiffness": stiffness}
    return _block(time, locked=True, pressure=pressure, gravity=gravity, **data)


def unilateral_block(
    time: ArrayLike,
    *,
    width: float,
    height: float,
    density: float,
    young: float,
    stiffness: float,
    pressure: float = 0.0,
    gravity: float = 0.0,
    gap: float = 0.0,
    velocity: float = 0.0,
) -> BlockAnswer:
    """Return the motion of a block on springs that carry no tension, from opening to closing; it may fall and bounce.

    The equations of `locked_block` while the base is below the springs' ends; without their forces while it is above.

    Parameters
    ----------
    gap
        Between base and springs at t = 0 [m].
    velocity
        Of the block at t = 0, upwards [m/s].

    Raises
    ------
    ValueError
        A number is out of its range.
    """
    data = {"width": width, "height": height, "density": density, "young": young, "stiffness": stiffness}
    return _block(time, pressure=pressure, gravity=gravity, gap=gap, velocity=velocity, **data)


def frictional_block(
    time: ArrayLike,
    *,
    width: float,
    height: float,
    density: float,
    young: float,
    stiffness: float,
    shear_stiffness: float,
    friction: float,
    slope: float,
    gravity: float,
    cohesion: float = 0.0,
    pressure: float = 0.0,
) -> BlockAnswer:
    """Return the motion of a block with friction on a slope, from stick to slip, corner by corner.

    A closed corner carries N = -p w and T = -p_s (s - r), |T| at most tan(phi) N + C, C half of cohesion times width.

    Parameters
    ----------
    shear_stiffness
        p_s of each corner [N/m].
    friction, slope
        phi and the angle by which gravity is turned towards +x [deg].
    cohesion
        Over the whole base [Pa].

    Raises
    ------
    ValueError
        A number is out of its range.
    """
    data = {"width": width, "height": height, "density": density, "young": young, "stiffness": stiffness}
    joint = {"shear_stiffness": shear_stiffness, "friction": friction, "slope": slope, "cohesion": cohesion}
    return _block(time, pressure=pressure, gravity=gravity, **data, **joint)


def _block(time: ArrayLike, **data: Any) -> BlockAnswer:
    extras.require("the exact motion of a block", *extras.EXACT)
    from fem_reference.events.block_events import solve
    from fem_reference.events.block_model import BlockProblem

    instants = _instants(time)
    motion = solve(BlockProblem(**data), float(instants[-1]))
    state: BlockHistory = motion.at(instants)
    u, v, rotation = state.displacement[:3]
    openings = tuple(switch.time for switch in motion.switches if switch.kind == "opens")
    closings = tuple(switch.time for switch in motion.switches if switch.kind == "closes")
    return BlockAnswer(instants, v, u, rotation, state.contact_pressure, openings, closings)


def _instants(time: ArrayLike) -> Array:
    """Return instants that rise from 0 on, the last one after 0.

    Raises
    ------
    ValueError
        They are others.
    """
    instants = np.atleast_1d(np.asarray(time, dtype=np.float64))
    in_range = instants.ndim == 1 and np.isfinite(instants).all() and instants[0] >= 0 and instants[-1] > 0
    if not in_range or np.any(np.diff(instants) < 0):
        raise ValueError("time: must be finite instants that rise from 0 or later to after 0")
    return instants


def rigid_slide(time: ArrayLike, *, slope: float, friction: float, gravity: float = 9.81) -> Array:
    """Return how far a rigid mass has slid from rest down a slope that is steeper than its friction [m].

        s(t) = g (sin b - cos b tan phi) t^2 / 2, and 0 where that is negative

    Parameters
    ----------
    time
        Instants [s].
    slope, friction
        b and phi [deg].
    gravity
        g [m/s2].
    """
    t = np.asarray(time, dtype=np.float64)
    b = math.radians(slope)
    acceleration = gravity * (math.sin(b) - math.cos(b) * math.tan(math.radians(friction)))
    return np.asarray(max(acceleration, 0.0) * t**2 / 2)


def rocking_quarter_period(*, width: float, height: float, tilt: float, gravity: float = 9.81) -> float:
    """Return when a rigid block released from a tilt comes down on its base [s]; it needs scipy.

    theta'' = -p^2 sin(alpha - theta), p^2 = 3 g / (4 R), alpha = atan(a / h), R half of the diagonal; the time is an
    incomplete elliptic integral. Source: G. W. Housner, Bulletin of the Seismological Society of America 53 (1963).

    Parameters
    ----------
    width, height
        a and h [m].
    tilt
        theta at t = 0, at most alpha [rad].
    gravity
        g [m/s2].

    Raises
    ------
    ValueError
        A number is out of its range.
    """
    from fem_reference.exact.rocking import RockingBlock

    return RockingBlock(width, height, gravity).quarter_period(tilt)


def rocking_tilt(time: ArrayLike, *, width: float, height: float, tilt: float, gravity: float = 9.81) -> Array:
    """Return the tilt of a rigid block released at rest [rad], impacts with Housner's loss; it needs scipy.

    The equation and the parameters of `rocking_quarter_period`; after an impact the block rises on its other corner
    with 1 - 3/2 sin^2(alpha) of the rate and its tilt is negative.

    Raises
    ------
    ValueError
        A number is out of its range.
    """
    from fem_reference.exact.rocking import RockingBlock, solve

    instants = _instants(time)
    rotation, _ = solve(RockingBlock(width, height, gravity), float(instants[-1]), tilt).at(instants)
    return np.asarray(rotation)


def layered_column(
    step: float,
    steps: int,
    pressure: Callable[[Array], Array],
    *,
    thickness: Sequence[float],
    density: Sequence[float],
    young: Sequence[float],
    heights: Sequence[float],
    impedance: float | None = None,
    motion: Literal["pressure", "shear"] = "pressure",
) -> tuple[Array, Array]:
    """Return instants [s] and the displacements of a layered column at heights [m], shape (heights, steps).

    rho u'' = E u_xx in each layer (its shear modulus E / 2 where the motion is shear), sigma = -pressure(t) on the top;
    below, the base is held, or a half-space of an impedance rho c takes what comes. Transfer matrices of Thomson and
    Haskell, in time by a weighted Fourier transform whose samples are halved until nothing changes by 1e-6.

    Parameters
    ----------
    step, steps
        The instants are step, 2 step, ... [s].
    pressure
        Of instants [s] to the pressure on the top [Pa].
    thickness, density, young
        Of the layers, from the base upwards [m, kg/m3, Pa].
    heights
        Above the base [m].
    impedance
        Of the half-space below [Pa s/m]; None: the base is held.
    motion
        ``"pressure"`` along the column, ``"shear"`` across it.

    Raises
    ------
    ValueError
        A number is out of its range.
    """
    from fem_reference.column.problem import Excitation, Ground, Stratum
    from fem_reference.exact.layers import solve_layers
    from fem_reference.problem.problem import Scheme

    def drive(t: Array) -> Excitation:
        still = np.zeros_like(t)
        return Excitation(still, still, still, np.asarray(pressure(t), dtype=np.float64))

    strata = tuple(Stratum(d, rho, e, 0.0) for d, rho, e in zip(thickness, density, young, strict=True))
    columns = [f"displacement_{number}" for number in range(1, len(heights) + 1)]
    ground = Ground(strata, motion, (), impedance)
    scheme = Scheme(0.25, 0.5, 1.0, step)
    solution = solve_layers(ground, scheme, steps, drive, columns, heights)
    return step * np.arange(1.0, steps + 1), np.array([solution.columns[name] for name in columns])
