"""The bar on a no-tension base spring: its data, and the units in which its motion is computed."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from flint import arb

POSITIVE = ("height", "width", "density", "young", "base_stiffness")


@dataclass(frozen=True)
class BarProblem:
    """An elastic bar that is dropped on or pressed against a no-tension base spring.

    At t = 0 the bar is unstrained, its base a gap above the spring, and all loads are switched on.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    height: float  # length H of the bar [m]
    width: float  # width W [m], unit thickness
    density: float  # mass density rho [kg/m3]
    young: float  # axial modulus: E in plane stress, E / (1 - mu^2) in plane strain [Pa]
    base_stiffness: float  # stiffness k = 2 p of the base spring [N/m]
    pressure: float = 0.0  # pressure q on the top [Pa], downwards, from t = 0 on
    gravity: float = 0.0  # acceleration of gravity, downwards [m/s2]
    gap: float = 0.0  # gap g0 under the base at t = 0 [m]
    velocity: float = 0.0  # velocity of the bar at t = 0 [m/s], upwards positive: an impact has a negative one

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not math.isfinite(value):
                raise ValueError(f"{field.name}: must be a finite number, got {value!r}")
            if field.name in POSITIVE and value <= 0:
                raise ValueError(f"{field.name}: must be positive, got {value!r}")
        if self.gap < 0:
            raise ValueError(f"gap: must not be negative, got {self.gap!r}")

    @property
    def travel(self) -> float:
        """Time H / c of a wave from top to base [s]."""
        return self.height * math.sqrt(self.density / self.young)

    @property
    def kappa(self) -> float:
        """Stiffness of the spring over that of the bar, k H / (E W) [-]: decay rate per travel time."""
        return self.base_stiffness / self.young * (self.height / self.width)


@dataclass(frozen=True)
class Units:
    """The data in m/s and travel times."""

    travel: arb  # H / c [s]
    impedance: arb  # Z = rho c [Pa s/m]
    kappa: arb  # k H / (E W) [-]
    q: arb  # q / Z [m/s]
    b: arb  # b H / c [m/s]
    gap: arb  # g0 c / H [m/s]
    V: arb  # initial velocity [m/s]

    @classmethod
    def of(cls, bar: BarProblem) -> Units:
        """Units of a bar in the precision of the current context."""
        H, rho, E = arb(bar.height), arb(bar.density), arb(bar.young)
        c = (E / rho).sqrt()
        return cls(
            travel=H / c,
            impedance=rho * c,
            kappa=arb(bar.base_stiffness) * H / (E * arb(bar.width)),
            q=arb(bar.pressure) / (rho * c),
            b=arb(bar.gravity) * H / c,
            gap=arb(bar.gap) * c / H,
            V=arb(bar.velocity),
        )

    @property
    def scale(self) -> arb:
        """Size of the velocities [m/s]."""
        return arb(max(float(abs(size)) for size in (self.q, self.b, self.gap, self.V)))
