"""The block of one strain with no-tension corners and friction, exact in time: from switch to switch.

What a closed corner bears is told in `block_model`, how it gets from switch to switch, and what is proven of each, in
`march`.

By the settling of `march` a block that touches at rest when a pressure is switched on lifts off at once, since its base
accelerates upwards, and a corner that closes slips at once where p_s |s'| > tan(phi) p |w'|, unless it has cohesion.
What opens with a shear force T releases the energy T^2 / (2 p_s) of its spring.

A dashpot changes the matrices and what is watched, an impact on rigid contact the rates; the same proof holds. Impacts
that accumulate are named in `cascades`, with the instant at which the contact comes to rest enclosed (`block_impacts`).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from flint import arb, arb_mat
from numpy.typing import ArrayLike

from fem_reference.events.block_march import BlockMarch
from fem_reference.events.block_model import BlockModel, BlockProblem
from fem_reference.events.contacts import CARRIES_NOTHING, OPEN, direction
from fem_reference.events.enclosure import ZERO
from fem_reference.events.march import Node
from fem_reference.events.report import ROUNDING, Instant, ProvenMotion, with_enough_digits
from fem_reference.events.series import Start, column, floats
from fem_reference.events.switches import Cascade, Impact
from fem_reference.problem.problem import Array

DIGITS = 50  # decimal digits of the first computation
_UNKNOWNS = np.zeros((6, 6))  # from (u, v, r, ex, ey, gxy) to (u, v, ux, uy, vx, vy)
_UNKNOWNS[range(6), [0, 1, 3, 5, 5, 4]] = [1, 1, 1, 0.5, 0.5, 1]
_UNKNOWNS[[3, 4], 2] = -1, 1
_OUTPUTS = np.linalg.inv(_UNKNOWNS)
TO_OUTPUTS = arb_mat(_OUTPUTS.tolist())
REPORT_DIGITS = 40  # decimal digits in which the motion is evaluated where it is reported


@dataclass(frozen=True)
class BlockHistory:
    """The motion at given instants, arrays of shape (times,), of M and N of (2, times); forces act on the block."""

    time: Array  # [s]
    displacement: Array  # (u, v, r, ex, ey, gxy) of the centroid [m, rad, -], shape (6, times)
    velocity: Array  # their rates [m/s, 1/s], shape (6, times)
    gap: Array  # w [m], negative when pressed
    gap_velocity: Array  # its rate, the normal velocity of the base corner [m/s]
    normal_force: Array  # N [N], upwards, without impulses
    shear_force: Array  # T of the closed corners [N], towards +x
    slide: Array  # s over the base [m]
    slipped: Array  # movement of the shear reference r by slipping until then [m]
    states: Array  # 0 open or released, 1 sticks, 2 slips towards +x, -2 slips towards -x
    closed: Array  # 1 where a corner is closed, else 0
    contact_pressure: Array  # (N_M + N_N) / a [Pa]
    kinetic: Array  # energy [J]
    strain: Array  # energy [J]
    springs: Array  # energy of the normal and shear springs, of released ones too [J]
    load: Array  # potential energy of pressure, traction and weight, -F x, less the base's work [J]
    released: Array  # energy of the shear springs lost by opening until then [J]
    friction: Array  # energy lost until then [J]
    damped: Array  # energy lost in dashpots and by impacts until then [J]
    displacement_radius: Array  # greatest distance of each displacement from the true one, shape (6, times)

    @property
    def energy(self) -> Array:
        """Sum of all energies, which the motion conserves [J]."""
        return self.kinetic + self.strain + self.springs + self.load + self.released + self.friction + self.damped


@dataclass(frozen=True)
class BlockMotion(ProvenMotion):
    """Exact motion of a block from t = 0 to `end`."""

    problem: BlockProblem
    closed_at_start: tuple[bool, bool]  # whether M and N are closed just after t = 0
    model: BlockModel = field(repr=False, compare=False)
    impacts: tuple[Impact, ...] = ()  # on a rigid contact in the order of time, but for those of cascades
    cascades: tuple[Cascade, ...] = ()  # infinitely many impacts that end in rest, in the order of time

    def at(self, times: ArrayLike) -> BlockHistory:
        """The motion at instants from 0 to the end, in any order."""
        return BlockHistory(**self.columns(self.model, times, REPORT_DIGITS))

    def _at(self, instant: Instant) -> dict[str, Any]:
        problem = self.problem
        model = self.model
        node = instant.node
        start = instant.start
        away, speed = base_motion(node, start.time)
        u = start.u + away
        u[1, 0] -= problem.gap
        v = start.v + speed
        x = floats(TO_OUTPUTS * u)[:, 0]
        gap = np.array([float(row) for row in instant.rows[:2]])
        N = np.array([float(force) for force in instant.forces[:2]])
        pressed = gap
        if not problem.locked:
            N = np.maximum(0.0, N)
            pressed = np.minimum(0.0, gap)
        closed = [state not in CARRIES_NOTHING for state in node.states]
        ledger = self._ledgers[instant.number] + self._gains(node, start)
        slipped_m, slipped_n, dissipated, work, released = ledger.entries()
        has_friction = problem.friction is not None
        shear = instant.forces[2:4]
        springs = float(model.contacts[0].stiffness) * (pressed**2).sum() / 2
        if problem.shear_stiffness:
            springs += float(sum((T * T for T in shear), ZERO) / problem.shear_stiffness / 2)
        return {
            "displacement": x,
            "velocity": floats(TO_OUTPUTS * v)[:, 0],
            "gap": gap,
            "gap_velocity": floats(model.rows * start.v)[:2, 0],
            "normal_force": N,
            "shear_force": [float(T) for T in shear],
            "slide": [float(row) for row in instant.rows[2:4]],
            "slipped": [float(slipped_m), float(slipped_n)],
            "states": np.where(closed, node.states, OPEN),
            "closed": closed,
            "contact_pressure": N.sum() / problem.width,
            "kinetic": float((v.transpose() * model.mass * v)[0, 0] / 2),
            "strain": float((u.transpose() * model.stiffness * u)[0, 0] / 2),
            "springs": springs,
            "load": -float((model.load.transpose() * u)[0, 0] + work),
            "released": float(released),
            "friction": float(dissipated) * has_friction,
            "damped": float(dissipated) * (not has_friction),
            "displacement_radius": np.abs(_OUTPUTS) @ instant.radius + ROUNDING * np.abs(x),
        }

    @cached_property
    def _ledgers(self) -> list[arb_mat]:
        """What has slipped at M and N [m], been lost, been done by the base and been released until each node [J]."""
        ledgers = [arb_mat(5, 1)]
        for node, following in itertools.pairwise(self.nodes):
            # its end as seen from the base of this step, whose velocity jumps between two rows of its record
            time = following.start.time
            jump = base_motion(following, time)[1] - base_motion(node, time)[1]
            end = following.start._replace(v=following.start.v + jump, references=node.start.references)
            ledger = ledgers[-1] + self._gains(node, end)
            forces = self.model.forces(node.states, end, ())[1]
            for c, state in enumerate(following.states):
                T = forces[2 + c]
                if state in CARRIES_NOTHING and T != 0:
                    ledger[4, 0] += T * T / self.problem.shear_stiffness / 2
            ledgers.append(ledger)
        return ledgers

    def _gains(self, node: Node, end: Start) -> arb_mat:
        """What a step adds to a ledger until its end, as seen from its base."""
        model = self.model
        gains = [ZERO] * 5
        rows = model.values(end)
        for c, (contact, state) in enumerate(zip(model.contacts, node.states, strict=True)):
            if direction(state):
                gains[c] = contact.reference(state, rows) - node.start.references[c]
        losing = any(direction(state) for state in node.states)
        if self.problem.restitution is not None:
            losing = self.problem.restitution < 1 and node.states[0] == OPEN
        elif self.problem.damping:
            losing = any(state != OPEN for state in node.states)
        if losing:  # energy in the step or at its end
            gains[2] = model.energy(node.states, node.start) - model.energy(node.states, end)
        momentum = model.mass * (end.v - node.start.v) - model.load * (end.time - node.start.time)
        gains[3] = (base_motion(node, end.time)[1].transpose() * momentum)[0, 0]
        return column(gains)


def base_motion(node: Node, time: arb) -> tuple[arb_mat, arb_mat]:
    """What the base adds to unknowns and rates that are seen from it, at an instant of a step."""
    course = [piece.series(time, 1.0, 2) for piece in node.drives]
    away, speed = (column([*part, *[ZERO] * 4]) for part in zip(*course, strict=True))
    return away, speed


def solve(problem: BlockProblem, end: float, digits: int = DIGITS, limit: int = 100_000) -> BlockMotion:
    """The exact motion of a block from t = 0 to `end` [s], of at most `limit` switches.

    Parameters
    ----------
    digits
        Decimal digits of the computation, at least 30; more are taken, up to `MOST_DIGITS`, where the instants of
        the switches are not enclosed to `PROMISED`.

    Raises
    ------
    ValueError
        If `end` is not positive and finite or `digits` is below 30.
    TooManySwitchesError, TooMuchWorkError, LostDigitsError, AccumulationError, NoContactStateError
        If the motion cannot be followed to its end, as `switches` has it.
    """

    def motion_in(digits: int) -> BlockMotion:
        march = BlockMarch(problem, float(end), limit)
        march.run()
        first = march.nodes[0].states
        return BlockMotion(
            march.end,
            digits,
            tuple(march.switches),
            tuple(march.touches),
            tuple(march.nodes),
            problem,
            (first[0] != OPEN, first[1] != OPEN),
            march.block,
            tuple(march.impacts),
            tuple(march.cascades),
        )

    return with_enough_digits(motion_in, float(end), digits)
