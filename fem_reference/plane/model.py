"""Bodies in the plane on common contacts, and what they answer: at rest, by modes, step by step.

Displacements are small and normals those of t = 0. A body that nothing clamps keeps its rigid motions: no spring is in
its stiffness K, whose forces they have none of; contacts are rows (`fem_reference.contact`).
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from scipy.linalg import block_diag as dense_block_diag
from scipy.linalg import null_space
from scipy.sparse import block_array, block_diag, csr_array
from scipy.sparse.linalg import splu

from fem_reference.contact import compilation
from fem_reference.contact.columns import ENERGY_COLUMNS, LOSS_COLUMNS, energies_of
from fem_reference.contact.driver import OUTCOMES, Cut, histories
from fem_reference.contact.law import AT_LOWER, INSIDE
from fem_reference.contact.march import ContactState, Record
from fem_reference.contact.stepper import ContactStepper
from fem_reference.contact.system import ContactSystem, with_springs
from fem_reference.plane.body import PlaneBody, Point
from fem_reference.plane.contact import PatchContact, points_of
from fem_reference.plane.elements import BodyElements
from fem_reference.problem.motion import Motion as BaseMotion
from fem_reference.problem.motion import moved_base
from fem_reference.problem.problem import Array, Flags, Scheme
from fem_reference.problem.result import Mode, Result, just_ended
from fem_reference.scheme.eigen import as_modes, largest_frequency, lowest
from fem_reference.scheme.newmark import Work
from fem_reference.scheme.stage import Motion

SHIFT = 1e-3  # of the square of the lowest frequency of a shear wave: keeps K + shift M definite where a body is free
UNBALANCED = 1e-9  # of the sum of the loads' sizes: what rounding leaves of a balanced load
UNHELD = 1e-9  # of the stiffest rigid motion on its springs: a motion below its square is held by none
REST_SOLVES = 50  # most sets of closed points that are tried for a rest
CUT = Cut(0.3, 0.01)  # of a step whose contact has no solution, as of a block


@dataclass(frozen=True)
class Rest:
    """Bodies at rest; arrays of contacts have the shape (contacts,)."""

    D: Array  # displacements [m], shape (unknowns,)
    place: Array  # of each row beyond the length of its spring, of an open point its gap [m], shape (rows,)
    force: Array  # of each row [N]
    normal: Array  # force out of the second body on the first [N]
    shear: Array  # force on the first body clockwise of that [N]


@dataclass(frozen=True, kw_only=True)
class BodiesResult(Result):
    """Histories of the steps that were reached; row 0 is step 1, and a contact has a column of its arrays."""

    normal: Array  # as of `Rest` [N]
    shear: Array
    gap: Array  # mean distance over the patch, negative where the springs are shortened [m]
    slip: Array  # mean of what its points have slid while closed, there less back [m]
    closed: Array  # share of the patch that is closed [-]
    rates: dict[str, Array]  # of the columns [1/s]
    momentum: Array  # in x, in y and about (0, 0) at the places of t = 0 [kg m/s, kg m2/s], shape (steps, 3)
    energy: dict[str, Array]  # `ENERGY_COLUMNS` and `LOSS_COLUMNS` of `fem_reference.contact.columns` [J]
    step_solves: Array  # solutions of the contact in each step [-], shape (steps,)
    cuts: Array  # of each step [-]


class PlaneModel:
    """M D'' + K D = F + B' N of bodies on their meshes, clamped unknowns left out, N by the laws of their contacts.

    Parameters
    ----------
    bodies
        Their unknowns come one body after the other.
    base_motion
        Of what is fixed below the contacts, zero at t = 0.

    Raises
    ------
    ValueError
        A clamp, a load or a contact does not lie on the outline.
    """

    def __init__(
        self,
        bodies: Sequence[PlaneBody],
        contacts: Sequence[PatchContact] = (),
        base_motion: BaseMotion | None = None,
    ) -> None:
        self.parts = [BodyElements(body) for body in bodies]
        self.first = [0, *np.cumsum([len(part.free) for part in self.parts]).tolist()]
        self.M = csr_array(block_diag([part.M for part in self.parts]))
        self.K = csr_array(block_diag([part.K for part in self.parts]))
        self.F = np.concatenate([part.F for part in self.parts])
        self.points = points_of(contacts, self.parts, self.first)
        self.base_motion = base_motion

    def observer(self, start: Point, end: Point, body: int = 0) -> Array:
        """The rows of `BodyElements.observer` of a body, on all unknowns."""
        return self.rows(self.parts[body].observer(start, end), body)

    def means(self, body: int) -> Array:
        """Rows of `BodyElements.means` of a body, shape (6, unknowns)."""
        return self.rows(self.parts[body].means, body)

    def rows(self, of_body: Array, body: int) -> Array:
        """Rows on a body's unknowns as rows on all."""
        rows = np.zeros((len(of_body), len(self.F)))
        rows[:, self.first[body] : self.first[body + 1]] = of_body
        return rows

    @cached_property
    def motions(self) -> Array:
        """Rigid motions of each body that no clamp holds, shape (unknowns, motions)."""
        return np.asarray(dense_block_diag(*(part.motions for part in self.parts)))

    def highest_frequency(self) -> float:
        """The largest natural frequency of all states: all points closed and sticking [rad/s]."""
        return largest_frequency(self._stiffness(self.points.all_closed), self.M)

    @cached_property
    def settled(self) -> Rest:
        """The bodies at rest under their loads: points that would pull are open, springs of shear stick.

        Orthogonal to what rigid motions no spring holds.

        Raises
        ------
        ValueError
            The loads have a resultant that nothing holds, or no set of closed points was found.
        """
        points = self.points
        rows = points.rows
        closed = points.all_closed
        for _ in range(REST_SOLVES):
            D = self._rest_of(closed)
            y = points.B @ D + points.gap
            force = np.where(closed, -y / rows.compliance, 0.0)
            following = np.where(closed, force >= rows.lower, y < 0)[rows.partner]
            if np.array_equal(following, closed):
                place = np.where(closed, -force * rows.compliance, y)
                return Rest(D, place, force, force @ points.normal, force @ points.shear)
            closed = following
        raise ValueError(
            "contacts: must agree with their own forces at rest, which steps with gg = 0 may find, got none"
        )

    @property
    def rest(self) -> Array:
        """Displacements at rest, as `settled` has them, shape (unknowns,)."""
        return self.settled.D

    def stress_error(self) -> float:
        """Return `BodyElements.stress_error` of the first body at rest."""
        return self.parts[0].stress_error(self.rest[: self.first[1]])

    def modes(self, scheme: Scheme, count: int) -> tuple[Mode, ...]:
        """The lowest modes that are no free motion, all points closed and sticking, in rising order."""
        closed = self.points.all_closed
        K = self._stiffness(closed)
        first = self.parts[0].body
        reach = float(np.max(first.extent[1] - first.extent[0]))
        shift = SHIFT * first.shear_modulus / first.density * (np.pi / reach) ** 2
        rigid = self._unheld(closed).shape[1]
        squares, shapes = lowest(K, self.M, count + rigid, shift)
        work = float(self.F @ self._rest_of(closed))
        return as_modes(squares[rigid:], shapes[:, rigid:], self.F, work, scheme)

    def history(
        self, scheme: Scheme, steps: int, rows: Array, *, settled: bool = False, limit: int = 6
    ) -> BodiesResult:
        """What some rows observe of the bodies, at each step, with their contacts and energies.

        They begin unstrained with their velocities, or at rest under their loads. A numerical failure is an outcome:
        the history then ends with the last step that was reached.

        Parameters
        ----------
        rows : (columns, unknowns) array
            As `observer` returns them; the columns of the result are named by their numbers.
        settled
            Whether they begin at `rest`.
        limit
            Most solutions of the open-close iteration before its fallback.
        """
        began = time.perf_counter()
        system, compiled, notes = compilation.prepared(self._system(scheme, rows), steps)
        stepper = ContactStepper(system, scheme, limit, energies=True, losses=True, compiled=compiled)
        state = self._start(stepper, settled)
        ready = time.perf_counter()
        cut = None if scheme.staggered or system.C is not None else CUT
        kept, marched = histories(stepper, state, steps, cut, self._kept)
        observed = kept.pop("observed")
        rates = kept.pop("rates")
        energy = {name: kept.pop(name) for name in (*ENERGY_COLUMNS, *LOSS_COLUMNS)}
        return BodiesResult(
            **just_ended(scheme.step, len(observed), began, ready),
            columns={str(i): values for i, values in enumerate(observed.T)},
            unknowns=len(self.F),
            **vars(stepper.work),
            notes=notes if len(self.points.gap) else (),
            outcome=OUTCOMES[marched.outcome],
            rates={str(i): values for i, values in enumerate(rates.T)},
            energy=energy,
            **kept,
        )

    def _system(self, scheme: Scheme, rows: Array) -> ContactSystem:
        """The bodies on their contacts, what the rows observe, and the momenta."""
        rigid = dense_block_diag(*(part.rigid for part in self.parts)).reshape(len(self.F), -1, 3).sum(axis=1)
        damping = scheme.mass_damping * self.M + scheme.stiffness_damping * self.K
        return ContactSystem(
            M=self.M,
            K=self.K,
            F=self.F,
            B=self.points.B,
            rows=self.points.rows,
            watch=Motion(np.asarray(rows, float), np.vstack([rigid.T @ self.M, rows]), np.zeros((0, len(self.F)))),
            pushes=np.zeros((len(self.F), 0)),
            ground=self.points.ground,
            prescribed=partial(moved_base, self.base_motion),
            start_parts=np.zeros(2),
            motions=tuple(part.motions for part in self.parts),
            C=csr_array(damping) if scheme.damped else None,
        )

    def _start(self, stepper: ContactStepper, settled: bool) -> ContactState:
        rows = self.points.rows
        gap = self.points.gap
        states = np.where(gap[rows.partner] > 0, AT_LOWER, INSIDE).astype(np.int8)
        states[rows.slips] = INSIDE
        place = gap
        D = np.zeros(len(self.F))
        force = np.where(states == INSIDE, -gap / rows.compliance, 0.0)  # of springs that are short at t = 0
        if settled:
            D = self.settled.D
            place = self.settled.place
            force = self.settled.force
            states = np.where(rows.slips | (force > 0), INSIDE, AT_LOWER).astype(np.int8)
        V = np.concatenate([part.velocity() for part in self.parts])
        unknowns = stepper.system.unknowns
        return stepper.start(unknowns(V), place, states, unknowns(D), force)

    def _kept(self, record: Record) -> dict[str, Any]:
        points = self.points
        mean = points.share[:, None]
        return {
            "observed": record.displacements,
            "momentum": record.velocities[:, :3],
            "rates": record.velocities[:, 3:],
            "normal": record.force @ points.normal,
            "shear": record.force @ points.shear,
            "gap": record.place @ (mean * points.normal),
            "slip": record.slid @ (mean * points.shear),
            "closed": (record.states == INSIDE) @ (mean * points.normal),
            "step_solves": record.solves,
            "cuts": record.cuts,
            **energies_of(record, points.rows),
        }

    def _stiffness(self, closed: Flags) -> csr_array:
        """K with the springs of the closed rows [N/m]."""
        return with_springs(self.K, self.points.B[closed], self.points.rows.compliance[closed])

    def _unheld(self, closed: Flags) -> Array:
        """Rigid motions that neither clamps nor closed springs hold, orthonormal, shape (unknowns, 0 or more)."""
        motions, _ = np.linalg.qr(self.motions)
        if not motions.shape[1]:  # which LAPACK may refuse
            return motions
        springs = np.sqrt(1 / self.points.rows.compliance[closed])[:, None] * (self.points.B[closed] @ motions)
        return np.asarray(motions @ null_space(np.vstack([springs, np.zeros(motions.shape[1])]), rcond=UNHELD))

    def _rest_of(self, closed: Flags) -> Array:
        """Displacements at rest with springs at the closed rows alone, orthogonal to what they do not hold."""
        points = self.points
        F = self.F - points.B[closed].T @ (points.gap / points.rows.compliance)[closed]
        K = self._stiffness(closed)
        motions = self._unheld(closed)
        size = float(np.sum(abs(F)))
        if np.any(abs(motions.T @ F) > UNBALANCED * size * np.max(abs(motions), axis=0, initial=0.0)):
            raise ValueError("load: must be in balance where nothing is clamped, got a resultant")
        if not motions.shape[1]:
            return Work().factor(K)(F)
        momentum = self.M @ motions
        weight = float(abs(K).max()) / float(abs(momentum).max())  # rows of the size of the others
        border = csr_array(weight * momentum)
        matrix = block_array([[K, border], [border.T, None]], format="csc")
        # Symmetric but for its pivots; the default order, for others, fills ten times as much beside a full border.
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A")
        return np.asarray(factors.solve(np.concatenate([F, np.zeros(border.shape[1])]))[: len(F)])
