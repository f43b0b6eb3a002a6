"""Elastic bars on each other: their data, the joints between them, and what drives them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from flint import acb, acb_poly, arb

from fem_reference.events.column_drive import Drive, Piece, Polynomial, Ricker, Sine, still
from fem_reference.events.enclosure import ZERO
from fem_reference.events.exponential_sum import ExponentialSum, Rate, Rates, distinct
from fem_reference.events.switches import Work
from fem_reference.problem.checks import require, require_numbers


@dataclass(frozen=True)
class Bar:
    """A homogeneous elastic bar of unit area."""

    length: float  # L [m]
    density: float  # rho [kg/m3]
    modulus: float  # E of the wave [Pa]
    velocity: float = 0.0  # at t = 0, upwards [m/s]

    def __post_init__(self) -> None:
        require_numbers(self, positive=("length", "density", "modulus"))

    @property
    def impedance(self) -> arb:
        """Impedance z = rho c in the precision of the context [Pa s/m]."""
        return (arb(self.density) * arb(self.modulus)).sqrt()

    @property
    def travel(self) -> arb:
        """Time T = L / c of a wave along the bar [s]."""
        return arb(self.length) * (arb(self.density) / arb(self.modulus)).sqrt()


@dataclass(frozen=True)
class BarJoint:
    """What joins two bars, or the lowest bar to its base.

    A unilateral joint carries N = k max(0, -y) of the gap y between its faces; any other one T = -k (y - r), and its
    slip r grows where |T| would pass the strength.
    """

    law: Literal["unilateral", "frictional"]
    stiffness: float = math.inf  # k [Pa/m]; inf: a rigid stop, or faces that move alike until they slip
    gap: float = 0.0  # at t = 0 [m], of a unilateral joint
    strength: float = math.inf  # greatest |T| [Pa], of a frictional one; inf: it is bonded

    def __post_init__(self) -> None:
        require(self.law in ("unilateral", "frictional"), "law", "must be unilateral or frictional", self.law)
        require_numbers(self, ("stiffness", "strength"), ("gap",), infinite=("stiffness", "strength"))
        require(self.law == "unilateral" or self.gap == 0, "gap", "must be 0 of a frictional joint", self.gap)


BONDED = BarJoint("frictional")  # faces that always move alike


def function_of(piece: Piece, start: arb, rates: Rates) -> ExponentialSum:
    """A piece of a drive as a function of the time since its start [s].

    A Ricker pulse, which is no sum of exponentials times polynomials, is a `ValueError`.
    """
    if isinstance(piece, Ricker):
        raise ValueError(f"drive: must be made of polynomials and sines, got {piece!r}")
    if isinstance(piece, Polynomial):
        return ExponentialSum.polynomial(rates, piece.series(start, 1.0, len(piece.coefficients)))
    sine, slope = piece.series(start, 1.0, 2)
    # a sin(w s) + b cos(w s) = Re (b - i a) exp(i w s), with b the sine at the start and a its slope over w
    phasor = acb_poly([acb(sine - piece.offset, -slope / piece.rate)])
    vibration = ExponentialSum(rates, {rates.index(acb(0, piece.rate)): phasor})
    return ExponentialSum.polynomial(rates, [piece.offset]) + vibration


def size_of(piece: Piece) -> float:
    """Size of the values in a drive whose polynomials do not grow."""
    if isinstance(piece, Polynomial):
        return float(abs(arb(piece.coefficients[0])))
    return 0.0 if isinstance(piece, Ricker) else float(abs(piece.amplitude)) + float(abs(piece.offset))


@dataclass(frozen=True)
class BarsProblem:
    """Bars from the base upwards, unstrained at t = 0, when all loads come on."""

    bars: tuple[Bar, ...]
    joints: tuple[BarJoint | None, ...]  # at the foot of each bar; the first is None where nothing is below
    gravity: float = 0.0  # downwards [m/s2]
    base_impedance: float = math.inf  # of a half-space below [Pa s/m]; inf: the base's motion is prescribed
    base: Drive = still  # velocity of the base, or of the wave that comes up in the half-space [m/s]
    top: Drive = still  # pressure on the top, downwards [Pa]
    settled: bool = False  # whether the bars begin at rest under their weight, all joints closed, not unstrained

    def __post_init__(self) -> None:
        require(len(self.bars) > 0, "bars", "must be one at least", self.bars)
        require(len(self.joints) == len(self.bars), "joints", "must be one for each bar", len(self.joints))
        require(None not in self.joints[1:], "joints", "must all be given above the base", self.joints)
        require_numbers(self, positive=("base_impedance",), infinite=("base_impedance",))
        require(not self.settled or self.joints[0] is not None, "settled", "must be False above nothing", self.settled)

    @property
    def fall(self) -> arb:
        """Acceleration with which the waves see the bars fall [m/s2]: none where static stresses carry the weight."""
        return arb(0 if self.settled else self.gravity)

    def static_force(self, joint: int) -> arb:
        """Force of a joint at t = 0 [Pa]: the weight above it where the bars begin at rest."""
        if not self.settled:
            return ZERO
        masses = (arb(bar.density) * arb(bar.length) for bar in self.bars[joint:])
        return arb(self.gravity) * sum(masses, ZERO)

    def static_point(self, bar: int, height: arb) -> tuple[arb, arb]:
        """Displacement [m] and stress [Pa] at t = 0 at a height above the foot of a bar."""
        displacement = ZERO
        if not self.settled:
            return displacement, ZERO
        for number in range(bar + 1):
            data = self.bars[number]
            joint = self.joints[number]
            N = self.static_force(number)
            if joint is not None:
                displacement -= N / arb(joint.stiffness) if math.isfinite(joint.stiffness) else ZERO
                displacement -= arb(joint.gap)
            x = height if number == bar else arb(data.length)
            weight = arb(data.density) * arb(self.gravity) * x
            displacement -= (N - weight / 2) * x / arb(data.modulus)
        return displacement, N - weight

    def mobility(self, joint: int) -> arb:
        """Relative velocity of the faces of a joint over its force, 1/z above + 1/z below [m/(Pa s)]."""
        below = ZERO
        if joint:
            below = 1 / self.bars[joint - 1].impedance
        elif math.isfinite(self.base_impedance):
            below = 1 / arb(self.base_impedance)
        return 1 / self.bars[joint].impedance + below

    def rates(self, end: float, work: Work) -> Rates:
        """The rates of the motion, and the sizes of its numbers; its work is counted."""
        values: list[Rate] = []
        for number, joint in enumerate(self.joints):
            if joint is not None and math.isfinite(joint.stiffness):
                values.append(-arb(joint.stiffness) * self.mobility(number))
        base = [piece for _, piece in self.base().parts()]
        top = [piece for _, piece in self.top().parts()]
        values += [acb(0, piece.rate) for piece in (*base, *top) if isinstance(piece, Sine)]
        z = min(float(bar.impedance) for bar in self.bars)
        sizes = [abs(bar.velocity) for bar in self.bars] + [abs(self.gravity) * end]
        sizes += [float(self.static_force(0)) / z]
        sizes += [size_of(piece) for piece in base] + [size_of(piece) / z for piece in top]
        travel = arb(min(float(bar.travel) for bar in self.bars))
        return Rates(distinct(values), arb(max(sizes) or 1.0), travel, arb(end), work)
