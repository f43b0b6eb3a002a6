"""What is kept of a history on corners that open, and what can be read from it.

Steps that were made one by one keep their states. Of steps that were made at once (`dda.one_block.unilateral_phase`)
only the first of every `BLOCK` is kept; a quantity is made from these when it is asked for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import SLIDES, SLIP, Corners, Unilateral, slide_forces
from dda.one_block.solution import Result, at_corner
from dda.one_block.unilateral_form import Layout, UnilateralForm
from dda.one_block.unilateral_phase import BLOCK, Phase
from dda.one_block.unilateral_step import State

Array = NDArray[np.float64]
SHORTEST = 8  # steps that a phase must have to be worth its set-up


class Step(NamedTuple):
    """A step that was made by itself."""

    v: Sequence[float] | Array
    closed: tuple[bool, ...]
    solves: int
    cuts: int
    state: tuple[int, ...] = ()  # of contacts with friction
    slipped: tuple[float, ...] = ()  # of contacts with friction [m]


class Glide(NamedTuple):
    """Steps without a switch, made at once."""

    first: int  # number of steps before
    steps: int
    phase: Phase
    closed: tuple[bool, ...]
    blocks: Array  # z before every BLOCK steps, (blocks, size of z)
    constant: Array  # v at its beginning, but for P


def vector(state: State) -> list[float]:
    """Return the quantities of a step as one vector, in the order of `Layout`."""
    c = state.corners
    return [*state.D, *state.P, *c.normal, *c.shear, *c.gap]


def glide(phase: Phase, v: Array, closed: tuple[bool, ...], first: int, left: int) -> tuple[Glide, Array] | None:
    """Make steps up to the next switch, `left` at most; return them and the last one's v, or None where there are none.

    A step is kept if the states that it began with agree with its forces and gaps: that is the first solve of the
    open-close iteration. NaN agrees with nothing.
    """
    z, constant = phase.start(v)
    limits = phase.limits(constant)
    kept, upto = _agreed([rows @ z for rows in phase.watch], limits, min(left, BLOCK))
    done, blocks, level = kept, z[None], BLOCK.bit_length() - 1
    while kept == upto and done < left:
        fresh = blocks @ phase.maps[level].T
        tested = [(fresh @ rows.T).ravel() for rows in phase.watch]
        kept, upto = _agreed(tested, limits, min(left - done, BLOCK * len(fresh)))
        done, blocks, level = done + kept, np.concatenate([blocks, fresh]), level + 1
    if done == 0:
        return None
    last, rest = divmod(done - 1, BLOCK)
    end = phase.shown @ phase.after(blocks[last], rest + 1) + constant
    if not math.isfinite(end.dot(end)):
        return None
    return Glide(first, done, phase, closed, blocks[: last + 1], constant), end


def _agreed(tested: Sequence[Array], limits: Sequence[float], upto: int) -> tuple[int, int]:
    """Return how many of the first `upto` steps come before one in which a quantity is below its limit, and `upto`."""
    kept = upto
    for values, limit in zip(tested, limits, strict=True):
        good = values[:kept] >= limit
        worst = int(good.argmin()) if kept else 0
        if kept and not good[worst]:
            kept = worst
    return kept, upto


def state_of(form: UnilateralForm, law: Unilateral, dt: float, before: Corners, v: Array) -> State:
    """Return the state after steps without a switch."""
    place = form.layout
    c = place.contacts
    D, P = v[place.D].tolist(), v[place.P].tolist()
    normal, shear, gap = (tuple(v[place.contact(kind)].tolist()) for kind in range(3))
    gap = tuple(0.0 - N * law.compliance if shut else w for shut, N, w in zip(before.closed, normal, gap, strict=True))
    D[-c:] = gap
    forces = np.array([*normal, *slide_forces(shear)][: len(form.B)])
    f = dt * dt * (form.F - form.K * D + form.multiplicity * (forces @ form.B))
    reference = before.reference
    if len(form.B) > c:
        where = (np.array(SLIDES[c]) @ (form.B[c:] @ D)).tolist()
        reference = tuple(r if shut else s for shut, r, s in zip(before.closed, reference, where, strict=True))
    stretch = tuple(0.0 - T / law.shear if law.shear else 0.0 for T in shear)
    return State(D, P, f.tolist(), Corners(before.closed, gap, stretch, reference, normal, shear))


@dataclass(eq=False)
class History:
    """Steps in their order."""

    layout: Layout
    parts: list[Step | Glide] = field(default_factory=list)
    steps: int = 0

    def add(self, part: Step | Glide) -> None:
        """Append a step or a glide."""
        self.parts.append(part)
        self.steps += part.steps if isinstance(part, Glide) else 1

    @cached_property
    def glides(self) -> list[Glide]:
        """The steps that were made at once."""
        return [part for part in self.parts if isinstance(part, Glide)]

    @cached_property
    def single(self) -> tuple[NDArray[np.intp], list[Step], Array]:
        """Numbers of the steps that were made by themselves, these steps, and their v as rows."""
        found = [part for part in self.parts if isinstance(part, Step)]
        mask = np.ones(self.steps, dtype=bool)
        for part in self.glides:
            mask[part.first : part.first + part.steps] = False
        rows = np.array([step.v for step in found]).reshape(len(found), self.layout.size)
        return np.flatnonzero(mask), found, rows

    def observe(self, rows: Array, less: Array | None = None) -> Array:
        """Return rows over v at every step, less a constant each, (rows, steps)."""
        numbers, _, values = self.single
        less = np.zeros(len(rows)) if less is None else less
        out = np.empty((len(rows), self.steps))
        out[:, numbers] = rows @ values.T - less[:, None] + 0.0
        constants = np.array([part.constant for part in self.glides]).reshape(-1, self.layout.size) @ rows.T - less
        for part, constant in zip(self.glides, constants.tolist(), strict=True):
            lines = out[:, part.first : part.first + part.steps]
            for line, inner, value in zip(lines, part.phase.table(rows), constant, strict=True):
                _fill(line, part.blocks, inner, value)
        return out

    def closed(self, contact: int) -> NDArray[np.bool_]:
        """Return the state of a contact at every step."""
        numbers, found, _ = self.single
        out = np.empty(self.steps, dtype=bool)
        out[numbers] = [step.closed[contact] for step in found]
        for part in self.glides:
            out[part.first : part.first + part.steps] = part.closed[contact]
        return out

    def states(self, contact: int) -> NDArray[np.int_]:
        """Return OPEN, STICK or SLIP of a contact in its direction at every step."""
        numbers, found, _ = self.single
        out = self.closed(contact).astype(int)
        out[numbers] = [step.state[contact] if step.state else step.closed[contact] for step in found]
        return out

    def slipped(self) -> Array:
        """Return the change of every contact's reference by slip in every step, (contacts, steps) [m]."""
        numbers, found, _ = self.single
        out = np.zeros((self.layout.contacts, self.steps))
        out[:, numbers] = np.array([step.slipped or (0.0,) * self.layout.contacts for step in found]).T
        return out

    def contacts(self, compliance: float) -> Array:
        """Return normal forces, shear forces and gaps, (3, contacts, steps); a closed contact has the gap -N/p."""
        place = self.layout
        c = place.contacts
        found = self.observe(np.eye(place.size)[place.contact(0).start :]).reshape(3, c, self.steps)
        for i in range(c):
            np.copyto(found[2, i], 0.0 - found[0, i] * compliance, where=self.closed(i))
        return found

    def counted(self, name: str, otherwise: int) -> NDArray[np.int_]:
        """Return solves or cuts of every step."""
        numbers, found, _ = self.single
        out = np.full(self.steps, otherwise)
        out[numbers] = [getattr(step, name) for step in found]
        return out


def _fill(out: Array, blocks: Array, inner: Array | None, constant: float) -> None:
    if inner is None:
        out[:] = constant
        return
    whole = len(out) // BLOCK
    if whole:
        moved = inner.copy()
        moved[:, -1] += constant  # the last entry of z is one
        np.matmul(blocks[:whole], moved.T, out=out[: whole * BLOCK].reshape(whole, BLOCK))
    if rest := len(out) - whole * BLOCK:
        end = out[whole * BLOCK :]
        np.matmul(inner[:rest], blocks[whole], out=end)
        end += constant


@dataclass(frozen=True, eq=False)
class UnilateralResult(Result):
    """Histories of the steps that were reached; element 0 is step 1. Forces act on the block.

    What is no field is made when it is first asked for. `solves` counts the small systems of the open-close
    iteration, the confirming one of each step included.
    """

    outcome: str  # "completed", or why the history ends early, in words
    balance: Callable[[], dict[str, Array]] | None  # makes the energies
    history: History
    form: UnilateralForm
    law: Unilateral
    momentum: Array  # (2, n) horizontal and vertical velocity of the centroid by P [1/(kg s)]

    @cached_property
    def energies(self) -> dict[str, Array] | None:
        """By `ENERGIES` [J], losses summed from t = 0 on; None if not asked for."""
        if self.balance is None:
            return None
        with np.errstate(all="ignore"):
            return self.balance()

    @cached_property
    def _contacts(self) -> dict[str, Array]:
        """Forces and gaps of M and N, (2, steps)."""
        every = self.history.contacts(self.law.compliance)
        both = {name: values[[0, -1]] for name, values in zip(("normal", "shear", "gap"), every, strict=True)}
        if self.form.multiplicity == 2:  # the one contact is N, M moves and is held in the opposite direction
            both["shear"][0] = -both["shear"][0] + 0.0
        return both

    @property
    def normal(self) -> Array:
        """N at M and N, (2, steps) [N]."""
        return self._contacts["normal"]

    @property
    def gap(self) -> Array:
        """W at M and N, (2, steps) [m]."""
        return self._contacts["gap"]

    @property
    def shear(self) -> Array:
        """T at M and N, (2, steps) [N]."""
        return self._contacts["shear"]

    @property
    def stretch(self) -> Array:
        """Stretch s - r of the shear springs at M and N, 0 where open, (2, steps) [m]."""
        return 0.0 - self.shear / self.law.shear if self.law.shear else np.zeros_like(self.shear)

    @cached_property
    def closed(self) -> NDArray[np.bool_]:
        """Whether M and N are closed, (2, steps)."""
        return np.array([self.history.closed(i) for i in (0, self.history.layout.contacts - 1)])

    @cached_property
    def states(self) -> NDArray[np.int_]:
        """State of M and N, (2, steps): 0 open, 1 closed and not slipping, 2 and -2 slipping towards N and M."""
        c = self.history.layout.contacts
        both = np.array([self.history.states(0), self.history.states(c - 1)])
        return both if c == 2 else np.array([np.where(np.abs(both[0]) == SLIP, -both[0], both[0]), both[1]])

    @cached_property
    def slide(self) -> Array:
        """Displacement s of M and N along the base, from M to N, less that of the base, (2, steps) [m]."""
        place = self.history.layout
        rows = np.zeros((2, place.size))
        rows[:, place.D] = self.form.slide
        return self.history.observe(rows)

    @cached_property
    def slip(self) -> Array:
        """Largest sum of what the reference of a corner moved while it was pressed, (steps,) [m]."""
        return np.asarray(np.abs(np.cumsum(self.history.slipped(), axis=1)).max(axis=0))

    normal_force_m, normal_force_n = at_corner("normal", 0), at_corner("normal", 1)  # N, away from the base [N]
    shear_force_m, shear_force_n = at_corner("shear", 0), at_corner("shear", 1)  # T, from M to N [N]
    gap_m, gap_n = at_corner("gap", 0), at_corner("gap", 1)  # w, negative when pressed [m]
    slide_m, slide_n = at_corner("slide", 0), at_corner("slide", 1)  # s [m]
    shear_m, shear_n = at_corner("stretch", 0), at_corner("stretch", 1)  # s - r [m]
    closed_m, closed_n = at_corner("closed", 0), at_corner("closed", 1)
    state_m, state_n = at_corner("states", 0), at_corner("states", 1)

    @cached_property
    def _velocities(self) -> Array:
        place = self.history.layout
        rows = np.zeros((2, place.size))
        rows[:, place.P] = self.momentum
        return self.history.observe(rows)

    @property
    def velocity(self) -> Array:
        """Of the centroid, upwards [m/s]."""
        values: Array = self._velocities[1]
        return values

    @property
    def horizontal_velocity(self) -> Array:
        """Of the centroid [m/s]."""
        values: Array = self._velocities[0]
        return values

    @cached_property
    def step_solves(self) -> NDArray[np.int_]:
        """Solves of each step, repeated and cut ones included."""
        return self.history.counted("solves", 1)

    @cached_property
    def step_cuts(self) -> NDArray[np.int_]:
        """Times that a step was cut."""
        return self.history.counted("cuts", 0)


def observed(form: UnilateralForm, history: History, a: float, names: Sequence[str]) -> dict[str, Array]:
    """Return the asked columns; `a` is the length of the base [m]."""
    place = history.layout
    rows = np.zeros((len(names), place.size))
    for row, name in zip(rows, names, strict=True):
        if name == "contact_pressure":
            row[place.contact(0)] = 2 / place.contacts / a
        else:
            row[place.D] = form.observers[name]
    return dict(zip(names, history.observe(rows, rows[:, place.D] @ form.start), strict=True))
