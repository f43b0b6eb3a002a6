"""Elastic bars on each other: their data, the joints between them, and what drives them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from flint import acb, acb_poly, arb

from fem_reference.events.exponential_sum import ExponentialSum, Rate, Rates, distinct


def _require(condition: bool, field: str, rule: str, value: object) -> None:
    if not condition:
        raise ValueError(f"{field}: {rule}, got {value!r}")


@dataclass(frozen=True)
class Bar:
    """A homogeneous elastic bar of unit area.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    length: float  # L [m]
    density: float  # mass density rho [kg/m3]
    modulus: float  # modulus E of the wave [Pa]
    velocity: float = 0.0  # at t = 0, upwards [m/s]

    def __post_init__(self) -> None:
        for name in ("length", "density", "modulus"):
            value = getattr(self, name)
            _require(math.isfinite(value) and value > 0, name, "must be positive and finite", value)
        _require(math.isfinite(self.velocity), "velocity", "must be a finite number", self.velocity)

    @property
    def impedance(self) -> arb:
        """Impedance z = rho c in the precision of the context [Pa s/m]."""
        return (arb(self.density) * arb(self.modulus)).sqrt()

    @property
    def travel(self) -> arb:
        """Time T = L / c of a wave along the bar [s]."""
        return arb(self.length) * (arb(self.density) / arb(self.modulus)).sqrt()

    @property
    def mass(self) -> float:
        """Mass of the unit area [kg/m2]."""
        return self.density * self.length


@dataclass(frozen=True)
class BarJoint:
    """What joins two bars, or the lowest bar to its base.

    A unilateral joint carries N = k max(0, -y) of the gap y between its faces; any other one T = -k (y - r), and its
    slip r grows where |T| would pass the strength.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    law: Literal["unilateral", "frictional"]
    stiffness: float = math.inf  # k [Pa/m]; inf: a rigid stop, or faces that move alike until they slip
    gap: float = 0.0  # at t = 0 [m], of a unilateral joint
    strength: float = math.inf  # greatest |T| [Pa], of a frictional one; inf: it is bonded

    def __post_init__(self) -> None:
        _require(self.law in ("unilateral", "frictional"), "law", "must be unilateral or frictional", self.law)
        _require(self.stiffness > 0, "stiffness", "must be positive", self.stiffness)
        _require(math.isfinite(self.gap) and self.gap >= 0, "gap", "must be finite and not negative", self.gap)
        _require(self.law == "unilateral" or self.gap == 0, "gap", "must be 0 of a frictional joint", self.gap)
        _require(self.strength > 0, "strength", "must be positive", self.strength)


BONDED = BarJoint("frictional")
"""Faces that always move alike."""


@dataclass(frozen=True)
class DrivePiece:
    """A drive from an instant on, sum of c_k s^k + a sin(w s) + b cos(w s) of the time s since then."""

    start: float  # [s]
    coefficients: tuple[float, ...] = ()  # c_k, the constant first
    sine: float = 0.0  # a
    cosine: float = 0.0  # b
    turns: float = 0.0  # w = 2 pi turns / duration, which is exact for half a turn in the duration of a pulse
    duration: float = 1.0  # [s]

    @property
    def rate(self) -> acb:
        """The rate i w [1/s]."""
        return acb(0, 2 * arb.pi() * arb(self.turns) / arb(self.duration))

    @property
    def size(self) -> float:
        """Size of the values in a drive whose polynomials do not grow."""
        return abs(self.coefficients[0] if self.coefficients else 0.0) + abs(self.sine) + abs(self.cosine)

    def function(self, rates: Rates) -> ExponentialSum:
        """The drive as a function of the time since the start."""
        function = ExponentialSum.polynomial(rates, [arb(c) for c in self.coefficients])
        if self.turns:
            phasor = acb_poly([acb(self.cosine, -self.sine)])  # Re (b - i a)(cos + i sin) = b cos + a sin
            function += ExponentialSum(rates, {rates.index(self.rate): phasor})
        return function


Drive = tuple[DrivePiece, ...]
"""Pieces in the order of time; zero before the first."""


def half_sine(size: float, duration: float) -> Drive:
    """Half a period of a sine, then nothing."""
    return DrivePiece(0.0, sine=size, turns=0.5, duration=duration), DrivePiece(duration)


def triangle(size: float, duration: float) -> Drive:
    """A steep front that falls to zero along a line, then nothing."""
    return DrivePiece(0.0, (size, -size / duration)), DrivePiece(duration)


def sine(size: float, frequency: float) -> Drive:
    """A sine from t = 0 on."""
    return (DrivePiece(0.0, sine=size, turns=frequency),)


def cosine(size: float, frequency: float) -> Drive:
    """A cosine from t = 0 on."""
    return (DrivePiece(0.0, cosine=size, turns=frequency),)


def recorded(instants: Sequence[float], values: Sequence[float]) -> Drive:
    """A record, linear between its rows and zero before the first and after the last."""
    pieces = []
    for (start, value), (end, next_value) in itertools.pairwise(zip(instants, values, strict=True)):
        pieces.append(DrivePiece(start, (value, (next_value - value) / (end - start))))
    return (*pieces, DrivePiece(instants[-1]))


def accelerated(instants: Sequence[float], accelerations: Sequence[float]) -> Drive:
    """The velocity of a record of accelerations, which is linear between its rows and zero before and after them."""
    pieces = []
    velocity = 0.0
    for (start, a), (end, next_a) in itertools.pairwise(zip(instants, accelerations, strict=True)):
        pieces.append(DrivePiece(start, (velocity, a, (next_a - a) / (end - start) / 2)))
        velocity += (a + next_a) / 2 * (end - start)
    return (*pieces, DrivePiece(instants[-1], (velocity,)))


@dataclass(frozen=True)
class BarsProblem:
    """Bars from the base upwards, unstrained at t = 0, when all loads come on.

    Raises
    ------
    ValueError
        For numbers that do not go together.
    """

    bars: tuple[Bar, ...]
    joints: tuple[BarJoint | None, ...]  # at the foot of each bar; the first is None where nothing is below
    gravity: float = 0.0  # downwards [m/s2]
    base_impedance: float = math.inf  # of a half-space below [Pa s/m]; inf: the base's motion is prescribed
    base: Drive = ()  # velocity of the base, or of the wave that comes up in the half-space [m/s]
    top: Drive = ()  # pressure on the top, downwards [Pa]
    settled: bool = False  # whether the bars begin at rest under their weight, all joints closed, not unstrained

    def __post_init__(self) -> None:
        _require(len(self.bars) > 0, "bars", "must be one at least", self.bars)
        _require(len(self.joints) == len(self.bars), "joints", "must be one for each bar", len(self.joints))
        _require(None not in self.joints[1:], "joints", "must all be given above the base", self.joints)
        _require(math.isfinite(self.gravity), "gravity", "must be a finite number", self.gravity)
        _require(self.base_impedance > 0, "base_impedance", "must be positive", self.base_impedance)
        for name in ("base", "top"):
            starts = [piece.start for piece in getattr(self, name)]
            _require(starts == sorted(set(starts)), name, "must have pieces in the order of time", starts)

        _require(not self.settled or self.joints[0] is not None, "settled", "must be False above nothing", self.settled)

    @property
    def fall(self) -> arb:
        """Acceleration with which the waves see the bars fall [m/s2]: none where static stresses carry the weight."""
        return arb(0 if self.settled else self.gravity)

    def static_force(self, joint: int) -> arb:
        """Force of a joint at t = 0 [Pa]: the weight above it where the bars begin at rest."""
        if not self.settled:
            return arb(0)
        masses = (arb(bar.density) * arb(bar.length) for bar in self.bars[joint:])
        return arb(self.gravity) * sum(masses, arb(0))

    def static_point(self, bar: int, height: arb) -> tuple[arb, arb]:
        """Displacement [m] and stress [Pa] at t = 0 at a height above the foot of a bar."""
        displacement = arb(0)
        if not self.settled:
            return displacement, arb(0)
        for number in range(bar + 1):
            data = self.bars[number]
            joint = self.joints[number]
            N = self.static_force(number)
            if joint is not None:
                displacement -= N / arb(joint.stiffness) if math.isfinite(joint.stiffness) else arb(0)
                displacement -= arb(joint.gap)
            x = height if number == bar else arb(data.length)
            weight = arb(data.density) * arb(self.gravity) * x
            displacement -= (N - weight / 2) * x / arb(data.modulus)
        return displacement, N - weight

    def mobility(self, joint: int) -> arb:
        """Relative velocity of the faces of a joint over its force, 1/z above + 1/z below [m/(Pa s)]."""
        below = arb(0)
        if joint:
            below = 1 / self.bars[joint - 1].impedance
        elif math.isfinite(self.base_impedance):
            below = 1 / arb(self.base_impedance)
        return 1 / self.bars[joint].impedance + below

    def rates(self, end: float) -> Rates:
        """The rates of the motion, and the sizes of its numbers."""
        values: list[Rate] = []
        for number, joint in enumerate(self.joints):
            if joint is not None and math.isfinite(joint.stiffness):
                values.append(-arb(joint.stiffness) * self.mobility(number))
        values += [piece.rate for piece in (*self.base, *self.top) if piece.turns]
        z = min(float(bar.impedance) for bar in self.bars)
        sizes = [abs(bar.velocity) for bar in self.bars] + [abs(self.gravity) * end]
        sizes += [float(self.static_force(0)) / z]
        sizes += [piece.size for piece in self.base] + [piece.size / z for piece in self.top]
        travel = arb(min(float(bar.travel) for bar in self.bars))
        return Rates(distinct(values), arb(max(sizes) or 1.0), travel, arb(end))
