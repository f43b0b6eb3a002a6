"""What is watched of the block's corners, as linear functions of its unknowns or of their rates."""

from __future__ import annotations

from dataclasses import dataclass, replace
from decimal import Decimal

from fem_reference.events.block_model import OPEN, STICKS, Base, BlockModel, Pair, States, sigma
from fem_reference.events.decimals import ZERO, Vector, dot


@dataclass(frozen=True)
class State:
    """An instant of the motion."""

    time: Decimal  # instant [s]
    displacement: Vector  # unknowns (u, v, ux, uy, vx, vy) [m, -]
    velocity: Vector  # their rates [m/s, 1/s]
    states: States  # of the corners M and N from now on
    references: Pair  # r of each corner: the slide at which its shear force is zero [m]
    released: Decimal  # energy of the shear springs lost by opening until now [J]
    slipped: Pair  # movement of each reference by slipping until now [m]
    base: Base  # the base


@dataclass(frozen=True)
class Row:
    """weights x + constant + drift s, or the same of the rates of x, with s the time since a state."""

    weights: Vector
    constant: Decimal = ZERO
    drift: Decimal = ZERO
    of_rates: bool = False

    def mixed(self, own: Decimal, other: Row, share: Decimal) -> Row:
        """A multiple of this row plus a share of another one."""
        weights = [own * a + share * b for a, b in zip(self.weights, other.weights, strict=True)]
        constant, drift = (own * a + share * b for a, b in ((self.constant, other.constant), (self.drift, other.drift)))
        return Row(weights, constant, drift)

    def plus(self, constant: Decimal) -> Row:
        """The row with a constant added."""
        return Row(self.weights, self.constant + constant, self.drift)

    @property
    def rate(self) -> Row:
        """The rate of this row, as a function of the rates of the unknowns."""
        return Row(self.weights, self.drift, of_rates=True)


@dataclass(frozen=True)
class Corner:
    """One corner in a state."""

    model: BlockModel
    state: State
    index: int  # 0 for M, 1 for N

    @property
    def is_in(self) -> int:
        """State of the corner."""
        return self.state.states[self.index]

    def as_if(self, state: int) -> Corner:
        """The corner in another state."""
        states = (state, self.state.states[1]) if self.index == 0 else (self.state.states[0], state)
        return replace(self, state=replace(self.state, states=states))

    def value(self, row: Row) -> Decimal:
        """Value of a function of the unknowns at the state."""
        return dot(row.weights, self.state.displacement) + row.constant

    @property
    def gap(self) -> Row:
        """Gap w [m]."""
        base = self.state.base
        return Row(self.model.normal[self.index], self.model.gap - base.y, -base.vy)

    @property
    def slide(self) -> Row:
        """Slide s [m]."""
        base = self.state.base
        return Row(self.model.shear[self.index], -base.x, -base.vx)

    @property
    def stretch(self) -> Row:
        """Stretch s - r = -T / p_s of the shear spring [m], zero in an open corner."""
        if self.is_in == OPEN:
            return Row([ZERO] * 6)
        if self.is_in == STICKS:
            return self.slide.plus(-self.state.references[self.index])
        return self._pressing.mixed(-sigma(self.is_in) / self.model.ps, self.slide, ZERO)

    @property
    def _pressing(self) -> Row:
        """Limit tan(phi) N + C of the shear force [N]."""
        return self.gap.mixed(-self.model.friction * self.model.p, self.slide, ZERO).plus(self.model.C)

    def reserve(self, sign: int) -> Row:
        """What a corner that sticks can carry before it slips under a shear force of a sign, limit - sign T [N]."""
        return self._pressing.mixed(Decimal(1), self.stretch, sign * self.model.ps)

    @property
    def dissipation(self) -> Row:
        """Rate -sigma r' at which a corner that slips moves its reference, in the direction of its slip [m/s]."""
        moved = self.slide.mixed(Decimal(1), self.stretch, Decimal(-1))
        return moved.mixed(Decimal(-sigma(self.is_in)), moved, ZERO).rate

    def watched(self) -> list[Row]:
        """Functions that are positive, or zero for ever, as long as the corner stays in its state."""
        if self.is_in == OPEN:
            return [self.gap]
        pressed = self.gap.mixed(Decimal(-1), self.gap, ZERO)
        if self.model.tan is None:
            return [pressed]
        if self.is_in == STICKS:
            return [pressed, self.reserve(1), self.reserve(-1)]
        return [pressed, self.dissipation]
