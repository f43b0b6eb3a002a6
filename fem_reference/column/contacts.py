r"""A meshed column whose contacts open or slip, stepped by a scheme in its force form.

The runs of elements between the contacts are meshes of their own. With the numbers of a stage
(`fem_reference.problem.stages`), b = beta / (1 - am), gamma' = gamma (1 - af) / (1 - am), S = M + gamma' dt C +
beta' dt^2 K factorised once, u = gg v, B the rows that give the openings y of the contacts and e = (1 - am) a1 + am a
the acceleration of the equation of motion::

    x* = x + dt (d_u u + d_g vg) + dt^2 (e_0 a + e_g ag - b am a)
    v* = u + dt (g_0 a + g_g ag - gamma am / (1 - am) a)
    e_f = S^-1 (F* - (1 - af) (C v* + K x*) - af (C u + K x - B' N0))
    q = B (x* + b dt^2 e_f) - base + gap - r
    z = q + (G + 1/k) N,   G = beta' dt^2 B S^-1 B'       N between its bounds, z only where N is at one of them
    e = e_f + (1 - af) S^-1 B' N,   x1 = x* + b dt^2 e,   a1 = (e - am a) / (1 - am),   v1 = v* + gamma / (1 - am) dt e

The contacts' forces are those of the step's two ends, in the mean of the scheme. N >= 0 and z >= 0 where contacts open;
|T| <= s where they slip, by z, which is then added to r. G is tridiagonal, since a run ends at two contacts: a solution
for the forces of given states is one banded elimination.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack
from scipy.sparse import csr_array, hstack

from fem_reference.column.mesh import LineMesh, line_mesh
from fem_reference.column.problem import DISPLACEMENT, NEAR, PRESSURE, Excitation, Ground
from fem_reference.column.stepping import Model
from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.result import Result
from fem_reference.problem.stages import Stage
from fem_reference.scheme.newmark import (
    Operator,
    Work,
    end_velocity,
    operator,
    start_velocity,
)
from fem_reference.scheme.stage import (
    Body,
    Motion,
    free_response,
    mean_load,
    predicted_change,
    response_weight,
    stage_end,
)

AT_LOWER = -1
INSIDE = 0
AT_UPPER = 1
"""States of a force: open, or at one of its strengths; closed, or sticking."""
COMPLETED = "completed"
UNSOLVED = "no consistent contact state"
States = NDArray[np.int8]
TOGETHER = 2
"""Solves for each contact, and three more, in which all states change at once."""


@dataclass(frozen=True)
class ColumnContact:
    """A face across the column that opens or slips, per unit of area.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    height: float  # above the base [m]
    stiffness: float  # k [Pa/m]; inf: a rigid stop, or faces that move alike until they slip
    gap: float = 0.0  # at t = 0, of one that opens [m]
    strength: float = math.inf  # greatest shear stress of one that slips [Pa]; inf: it never does

    def __post_init__(self) -> None:
        if not (self.height >= 0 and self.stiffness > 0 and self.gap >= 0 and self.strength > 0):
            raise ValueError(f"contacts: must have positive numbers and a gap of 0 or more, got {self!r}")


@dataclass(frozen=True)
class ContactColumn:
    """A column on contacts.

    Raises
    ------
    ValueError
        For numbers that do not go together.
    """

    ground: Ground  # its joints are bonded springs; an impedance makes a half-space
    law: Literal["unilateral", "frictional"]
    contacts: tuple[ColumnContact, ...]  # from the base upwards
    velocities: tuple[float, ...]  # of the strata at t = 0 [m/s]
    gravity: float = 0.0  # downwards [m/s2]
    unsupported: bool = False  # whether nothing is below
    settled: bool = False  # whether it begins at rest under its weight, all contacts closed
    solve_limit: int | None = None  # solves of the open-close iteration that end the run; None: as many as it takes

    def __post_init__(self) -> None:
        heights = [contact.height for contact in self.contacts]
        if heights != sorted(set(heights)) or not heights or heights[-1] >= self.ground.height * (1 - NEAR):
            raise ValueError(f"contacts: must be one at least, upwards and below the top, got {heights!r}")
        if self.ground.joints:
            raise ValueError(f"joints: must be contacts where others open or slip, got {self.ground.joints!r}")
        supported = not self.unsupported and self.ground.impedance is None
        if heights[0] == 0 and not supported:
            raise ValueError("contacts: must be above the base where that is a half-space or nothing, got one at it")
        if self.settled and not (supported and self.law == "unilateral"):
            raise ValueError("settled: must be False but for contacts that open on a base, got True")
        if len(self.velocities) != len(self.ground.strata):
            raise ValueError(f"velocities: must be one for each stratum, got {self.velocities!r}")

    @property
    def foot_contact(self) -> bool:
        """Whether the column stands on a contact."""
        return self.contacts[0].height == 0


@dataclass(frozen=True)
class ColumnContactResult(Result):
    """Histories of the steps that were reached; element 0 is step 1."""

    outcome: str = COMPLETED  # or why the history ends early, in words
    step_solves: Array = field(default_factory=lambda: np.zeros(0))  # of each step, the confirming one included
    states: NDArray[np.int8] = field(default_factory=lambda: np.zeros((0, 0), np.int8))  # (contacts, steps)
    openings: Array = field(default_factory=lambda: np.zeros((0, 0)))  # gap y, or slip r [m], (contacts, steps)
    mean_velocity: Array = field(default_factory=lambda: np.zeros(0))  # of the centre of mass [m/s], (steps,)


@dataclass(frozen=True)
class ColumnState:
    """The column at the end of a step."""

    D: Array  # displacement of the free unknowns [m]
    V: Array  # velocity [m/s]
    A: Array  # acceleration [m/s2]
    force: Array  # N, or T on what is above, of each contact [Pa]
    opening: Array  # gap y, negative where a spring is pressed; or slip r [m]
    states: States
    solves: int = 0  # of the open-close iteration
    undiscounted: bool = False  # whether gg does not act on V: the first half step of a staggered scheme


class UnsolvedStepError(ArithmeticError):
    """The open-close iteration has found no consistent states, or has reached its limit."""


class ContactProblem:
    """z = q + (G + 1/k) N with N between bounds, and z only where N is at one: >= 0 at the lower, <= 0 at the upper."""

    def __init__(self, G: Array, compliance: Array, lower: Array, upper: Array) -> None:
        n = len(compliance)
        self.diagonal = G[0] + compliance  # G as its diagonal and the entries beside it, shape (2, n)
        self.beside = G[1, : n - 1]
        self.lower = lower
        self.upper = upper

    def times(self, N: Array) -> Array:
        """(G + 1/k) N."""
        product: Array = self.diagonal * N
        product[1:] += self.beside * N[:-1]
        product[:-1] += self.beside * N[1:]
        return product

    def forces(self, q: Array, states: States) -> Array:
        """Forces that given states ask for: no opening or slip where they are inside of their bounds."""
        inside = states == INSIDE
        fixed = np.where(states == AT_UPPER, self.upper, np.where(states == AT_LOWER, self.lower, 0.0))
        right = np.where(inside, -q - self.times(fixed), 0.0)
        diagonal = np.where(inside, self.diagonal, 1.0)
        if len(q) == 1:
            return np.asarray(np.where(inside, right / diagonal, fixed))
        beside = np.where(inside[1:] & inside[:-1], self.beside, 0.0)
        _, _, N, failed = lapack.dptsv(diagonal, beside, right)
        if failed:
            raise UnsolvedStepError("the forces of the contacts are no numbers")
        return np.asarray(np.where(inside, N, fixed))

    def following(self, N: Array, z: Array) -> States:
        """States that forces and openings ask for, each as if its contact were alone."""
        alone = N - z / self.diagonal
        return np.where(alone <= self.lower, AT_LOWER, np.where(alone > self.upper, AT_UPPER, INSIDE)).astype(np.int8)

    def solve(self, q: Array, states: States, limit: int | None) -> tuple[Array, Array, States, int]:
        """Forces, openings or slips, states, and how many solves they took.

        All states change at once, first from those given. A cycle, which none is known to make, would be left by
        changing the lowest wrong one alone, which always ends.

        Raises
        ------
        UnsolvedStepError
            If the limit of solves is reached, or the numbers are none.
        """
        together = TOGETHER * len(q) + 3
        solves = 0
        while True:
            N = self.forces(q, states)
            solves += 1
            z = np.where(states == INSIDE, 0.0, q + self.times(N))
            following = self.following(N, z)
            if not math.isfinite(N.sum()):
                raise UnsolvedStepError("the forces of the contacts are no numbers")
            if np.array_equal(following, states):
                return N, z, states, solves
            if solves == limit:
                raise UnsolvedStepError(f"the open-close iteration has not ended after {solves} solves")
            if solves > together:
                wrong = int(np.argmax(following != states))
                states = states.copy()
                states[wrong] = following[wrong]
            else:
                states = following


class StageMatrices(NamedTuple):
    """What a stage needs of its matrix S."""

    body: Body
    mobility: csr_array  # S^-1 B'
    problem: ContactProblem


class ContactStepper:
    """The scheme on a column of contacts, its matrices factorised once."""

    def __init__(self, column: ContactColumn, elements: Sequence[int], degree: int, scheme: Scheme) -> None:
        self.column = column
        self.scheme = scheme
        ground = column.ground
        self.mesh = _separate_runs(column, elements, degree)
        self.work = Work()
        mesh = self.mesh
        self.prescribed = ground.impedance is None and not column.unsupported and not column.foot_contact
        model = Model.of(mesh, ground.impedance)
        if not self.prescribed:
            model = Model(model.M, model.C, model.K, np.arange(mesh.size), model.base, model.top, model.impedance)
        self.model = model
        free = model.free
        self.M, self.C, self.K = (csr_array(matrix[free][:, free]) for matrix in (model.M, model.C, model.K))
        self.B = self._openings()
        model.check_scheme(scheme)
        self.compliance = np.array([1 / contact.stiffness for contact in column.contacts])
        n = len(column.contacts)
        if column.law == "unilateral":
            self.lower = np.zeros(n)
            self.upper = np.full(n, np.inf)
        else:
            self.upper = np.array([contact.strength for contact in column.contacts])
            self.lower = -self.upper
        if scheme.explicit and np.any(self.compliance == 0):
            field, value = ("alpha", 0) if scheme.table is None else ("scheme", scheme.name)
            raise ValueError(f"{field}: must be positive where contacts are rigid, got {value}")
        self.stages: list[StageMatrices] = []
        for number, first in enumerate(scheme.stage_matrices):
            self.stages.append(self.stages[first] if first < number else self._stage(scheme.stages[number]))
        self.weight = np.asarray(-column.gravity * (model.M @ np.ones(mesh.size)))

    def _stage(self, stage: Stage) -> StageMatrices:
        """Factorise the matrix of a stage."""
        dt = self.scheme.step
        b = stage.stiffness_weight * dt**2
        S = csr_array(self.M + stage.damping_weight * dt * self.C + b * self.K)
        solve = self.work.factor(S)
        mobility = csr_array(hstack([csr_array(solve(row)[:, None]) for row in self.B.toarray()]))
        C = None if self.model.impedance is None else operator(self.C)
        body = Body(operator(self.M), C, operator(self.K), Operator(solve), is_free=True)
        return StageMatrices(body, mobility, self._problem(b, mobility, self.compliance))

    def _problem(self, b: float, mobility: csr_array, compliance: Array) -> ContactProblem:
        """The contacts' problem with G = b B S^-1 B', of which a contact and its neighbours have entries."""
        G = (b * (self.B @ mobility)).toarray()
        band = np.zeros((2, len(G)))
        band[0] = np.diag(G)
        band[1, :-1] = np.diag(G, 1)
        return ContactProblem(band, compliance, self.lower, self.upper)

    def _openings(self) -> csr_array:
        """Rows that give the relative displacement of the faces of each contact, less the base's."""
        B = np.zeros((len(self.column.contacts), self.mesh.size))
        runs = self.mesh.parts[1:] if not self.column.foot_contact else self.mesh.parts
        for number, run in enumerate(runs):
            B[number, run.end(top=False)] = 1.0
        for number, run in enumerate(self.mesh.parts[:-1]):
            B[number + self.column.foot_contact, run.end(top=True)] = -1.0
        return csr_array(B[:, self.model.free])

    def load(self, excitation: Excitation, step: int) -> Array:
        """Forces on the free unknowns at the end of a step [Pa]."""
        e = excitation
        model = self.model
        F: Array = self.weight[model.free].copy()
        if self.prescribed:
            F -= self._base_columns @ np.array([e.displacement[step], e.acceleration[step]])
        elif model.impedance is not None:
            F[model.base] += 2 * model.impedance * e.velocity[step]
        F[self._top] -= e.pressure[step]
        return F

    @cached_property
    def _base_columns(self) -> Array:
        base = [self.model.base]
        columns = [matrix[self.model.free][:, base].toarray()[:, 0] for matrix in (self.model.K, self.model.M)]
        return np.column_stack(columns)

    @cached_property
    def _top(self) -> int:
        return int(np.flatnonzero(self.model.free == self.model.top)[0])

    @cached_property
    def gaps(self) -> Array:
        """Gaps of the contacts at t = 0 [m]."""
        return np.array([contact.gap for contact in self.column.contacts])

    def base_opening(self, displacement: float) -> Array:
        """What the base takes of the openings [m]."""
        openings = np.zeros(len(self.gaps))
        if self.column.foot_contact:
            openings[0] = displacement
        return openings

    def start(self, excitation: Excitation) -> ColumnState:
        """State at t = 0: unstrained with the gaps of the contacts, or at rest under the weight."""
        n = len(self.gaps)
        V = self._velocities()[self.model.free]
        D = np.zeros_like(V)
        force = np.zeros(n)
        opening = self.gaps.copy() if self.column.law == "unilateral" else np.zeros(n)
        states = np.full(n, AT_LOWER if self.column.law == "unilateral" else INSIDE, np.int8)
        if self.column.settled:
            D, force = self._static(float(excitation.displacement[0]))
            opening = -force * self.compliance
            states = np.zeros(n, np.int8)
        A = np.zeros_like(V)
        if self.scheme.start == "consistent":
            solve = self.work.factor(self.M)
            A = solve(self.load(excitation, 0) - self.C @ V - self.K @ D + self.B.T @ force)
            rigid = (self.compliance == 0) & (opening == 0) & (not self.column.settled)
            if np.any(rigid):
                mobility = csr_array(hstack([csr_array(solve(row)[:, None]) for row in self.B.toarray()]))
                # a contact that is not rigid and touching has no part: an endless compliance
                problem = self._problem(1.0, mobility, np.where(rigid, 0.0, 1e6 * abs(mobility).max()))
                problem.upper = np.where(rigid, problem.upper, 0.0)
                problem.lower = np.where(rigid, problem.lower, 0.0)
                q = self.B @ A - self.base_opening(float(excitation.acceleration[0]))
                N, _, _, _ = problem.solve(
                    np.where(rigid, q, 0.0), np.where(rigid, states, AT_LOWER).astype(np.int8), None
                )
                A = A + mobility @ N
                force = force + N
        V = start_velocity(V, A, self.scheme)
        return ColumnState(D, V, A, force, opening, states, undiscounted=self.scheme.staggered)

    def _velocities(self) -> Array:
        """Velocity of each unknown at t = 0: that of its stratum, between two the mean by their masses."""
        V = np.zeros(self.mesh.size)
        column = self.column
        for run in self.mesh.parts:
            nodes = run.basis.mesh.p[0]
            ends = nodes[run.basis.mesh.t]
            stratum = np.searchsorted(column.ground.tops, ends.mean(axis=0))
            share = run.densities * abs(ends[1] - ends[0])
            momentum = np.zeros(run.size)
            mass = np.zeros(run.size)
            for local in run.basis.element_dofs:
                np.add.at(momentum, local, share * np.asarray(column.velocities)[stratum])
                np.add.at(mass, local, share)
            V[run.first : run.first + run.size] = momentum / mass
        return V

    def _static(self, base: float) -> tuple[Array, Array]:
        """Displacements of the free unknowns and forces at rest: each contact carries the weight above it."""
        ground = self.column.ground
        gravity = self.column.gravity
        bottoms = ground.tops - [stratum.thickness for stratum in ground.strata]
        densities = np.array([stratum.density for stratum in ground.strata])
        moduli = np.array([stratum.modulus(ground.motion) for stratum in ground.strata])

        def carried(height: float) -> float:
            above = np.clip(ground.tops - height, 0.0, ground.tops - bottoms)
            return gravity * float(densities @ above)

        def shortening(height: float) -> float:
            """Of the column between its foot and a height, its contacts apart."""
            total = 0.0
            for low, high, density, modulus in zip(bottoms, ground.tops, densities, moduli, strict=True):
                length = min(max(height - low, 0.0), high - low)
                total += (carried(low) - density * gravity * length / 2) * length / modulus
            return total

        force = np.array([carried(contact.height) for contact in self.column.contacts])
        closing = force * self.compliance + self.gaps
        D = np.zeros(self.mesh.size)
        first = 0 if self.column.foot_contact else 1
        for number, run in enumerate(self.mesh.parts):
            below = float(closing[: number + 1 - first].sum())
            heights = run.basis.doflocs[0]
            D[run.first : run.first + run.size] = [base - below - shortening(float(height)) for height in heights]
        return D[self.model.free], force

    def advance(self, state: ColumnState, loads: Sequence[Array], base: Sequence[float]) -> ColumnState:
        """One step under the loads at its start and at the ends of its stages, to the base's displacement there."""
        end = self._advance_stage(state, None, loads, base[0], 0)
        solves = end.solves
        for stage in range(1, len(self.stages)):
            end = self._advance_stage(state, end, loads, base[stage], stage)
            solves += end.solves
        return replace(end, solves=solves)

    def _advance_stage(
        self, state: ColumnState, before: ColumnState | None, loads: Sequence[Array], base: float, stage: int
    ) -> ColumnState:
        s = self.scheme
        numbers = s.stages[stage]
        matrices = self.stages[stage]
        latest = state if before is None else before
        gg = 1.0 if state.undiscounted else s.gg
        start = Motion(state.D, state.V, state.A)
        middle = Motion(latest.D, latest.V, latest.A)
        force = mean_load(numbers, loads[0], loads[stage + 1])
        if numbers.af:
            force = force + numbers.af * (self.B.T @ state.force)
        predicted = predicted_change(numbers, s.step, gg, start, middle)
        response = free_response(numbers, s.step, gg, matrices.body, start, middle, predicted, force)
        change = response if numbers.beta else predicted
        slip = latest.opening if self.column.law == "frictional" else -self.gaps
        q = self.B @ (state.D + change) - self.base_opening(base) - slip
        N, z, states, solves = matrices.problem.solve(q, latest.states, self.column.solve_limit)
        response = response + (1 - numbers.af) * response_weight(numbers, s.step) * (matrices.mobility @ N)
        end = stage_end(numbers, s.step, gg, start, middle, predicted, response)
        opening = slip + z if self.column.law == "frictional" else np.where(states == INSIDE, -N * self.compliance, z)
        return ColumnState(state.D + end.D, end.V, end.A, N, np.asarray(opening), states, solves)

    def march(self, excitation: Excitation) -> Iterator[ColumnState]:
        """Yield the state at t = 0 and after each step.

        Raises
        ------
        UnsolvedStepError
            If the forces of a step are not found.
        """
        stages = len(self.stages)
        state = self.start(excitation)
        yield state
        load = self.load(excitation, 0)
        for end in range(stages, len(excitation.pressure), stages):
            instants = range(end - stages + 1, end + 1)
            loads = [load, *(self.load(excitation, instant) for instant in instants)]
            base = [float(excitation.displacement[instant]) for instant in instants]
            state = self.advance(state, loads, base)
            yield state
            load = loads[-1]


def _separate_runs(column: ContactColumn, elements: Sequence[int], degree: int) -> LineMesh:
    """Mesh a column cut at its contacts, without springs."""
    ground = column.ground
    cuts = tuple((contact.height, 1.0) for contact in column.contacts if contact.height > 0)
    return line_mesh(Ground(ground.strata, ground.motion, cuts, ground.impedance), elements, degree, springs=False)


def solve_contacts(
    column: ContactColumn,
    elements: Sequence[int],
    degree: int,
    scheme: Scheme,
    excitation: Excitation,
    columns: Sequence[str] = (DISPLACEMENT, PRESSURE),
    heights: Sequence[float] = (),
) -> ColumnContactResult:
    """Step a column of contacts from its starting velocities.

    A numerical failure is an outcome, not an exception: the history then ends with the last step that was reached.

    Parameters
    ----------
    elements, degree
        Number of elements of each stratum, and their degree.
    excitation
        What drives it at the scheme's `stage_times`: t = 0 and the ends of all stages.
    columns
        ``displacement`` of the top [m], ``contact_pressure``, the force of the base on the column [Pa], and at the
        heights ``displacement_1`` ... [m], ``velocity_1`` ... [m/s], ``stress_1`` ... [Pa, compression positive], and
        where a contact is ``force_1`` ... [Pa, on what is above], ``gap_1`` ... and ``slip_1`` ... [m].
    heights
        Above the base [m]; where two faces meet, the lower one is observed.

    Raises
    ------
    ValueError
        For an unknown column, a height outside, or a mesh that is not possible.
    """
    column.ground.check_heights(heights)
    began = perf_counter()
    stepper = ContactStepper(column, elements, degree, scheme)
    observed = _Observed(stepper, columns, heights)
    ready = perf_counter()
    stages = len(scheme.stages)
    steps = (len(excitation.pressure) - 1) // stages
    histories = np.zeros((len(columns) + 1, steps))
    states = np.zeros((len(column.contacts), steps), np.int8)
    openings = np.zeros(states.shape)
    solves = np.zeros(steps)
    reached = 0
    outcome = COMPLETED
    notes: tuple[str, ...] = ()
    with np.errstate(all="ignore"):
        try:
            for step, state in enumerate(stepper.march(excitation)):
                if step == 0:
                    continue
                histories[:, step - 1] = observed.after(state)
                states[:, step - 1] = state.states
                openings[:, step - 1] = state.opening
                solves[step - 1] = state.solves
                reached = step
        except UnsolvedStepError as error:
            outcome = UNSOLVED
            notes = (f"step {reached + 1}: {error}",)
    e = excitation
    parts = np.array([e.displacement, e.velocity, e.acceleration, np.ones_like(e.pressure)])
    histories += observed.of_base @ parts[:, stages::stages]
    ended = perf_counter()
    return ColumnContactResult(
        time=scheme.step * np.arange(1.0, reached + 1),
        columns=dict(zip(columns, histories[:-1, :reached], strict=True)),
        unknowns=len(stepper.model.free),
        nonzeros=stepper.work.nonzeros,
        factorisations=stepper.work.factorisations,
        solves=stepper.work.solves,
        notes=notes,
        setup_seconds=ready - began,
        stepping_seconds=ended - ready,
        outcome=outcome,
        step_solves=solves[:reached],
        states=states[:, :reached],
        openings=openings[:, :reached],
        mean_velocity=histories[-1, :reached],
    )


class _Observed:
    """Columns of the history, and last the mean velocity, as rows on a state and on the motion of the base."""

    def __init__(self, stepper: ContactStepper, columns: Sequence[str], heights: Sequence[float]) -> None:
        model = stepper.model
        self.scheme = stepper.scheme
        count = len(columns) + 1
        full = np.zeros((3, count, stepper.mesh.size))  # on displacement, velocity and acceleration
        self.force = np.zeros((count, len(stepper.column.contacts)))
        self.opening = np.zeros_like(self.force)
        self.of_base = np.zeros((count, 4))  # on displacement, velocity and acceleration of the base, and one
        self.opens = stepper.column.law == "unilateral"
        for number, name in enumerate(columns):
            if name == PRESSURE:
                self._add_base_force(stepper, number, full)
            else:
                self._add(stepper, number, name, heights, full)
        mass = stepper.model.M @ np.ones(stepper.mesh.size)
        full[1, -1] = mass / mass.sum()
        if stepper.prescribed:
            self.of_base[:, :3] += full[:, :, model.base].T
        self.full = full[:, :, model.free]

    def _add(self, stepper: ContactStepper, number: int, name: str, heights: Sequence[float], full: Array) -> None:
        mesh = stepper.mesh
        if name == DISPLACEMENT:
            full[0, number, mesh.top] = 1.0
            return
        part, _, digits = name.rpartition("_")
        known = part in ("displacement", "velocity", "stress", "force", "gap", "slip")
        if not (known and digits.isdigit() and 1 <= int(digits) <= len(heights)):
            raise ValueError(f"columns: must be of the top, the base or one of {len(heights)} heights, got {name!r}")
        height = heights[int(digits) - 1]
        if part not in ("force", "gap", "slip"):
            full[int(part == "velocity"), number] = mesh.row(height, stress=part == "stress")
            return
        distances = [abs(contact.height - height) for contact in stepper.column.contacts]
        nearest = int(np.argmin(distances))
        if distances[nearest] > NEAR * stepper.column.ground.height:
            raise ValueError(f"columns: must be of a height where a contact is, got {name!r} at {height!r}")
        if part == "force":
            self.force[number, nearest] = 1.0
        elif (part == "gap") == self.opens:
            self.opening[number, nearest] = 1.0

    def _add_base_force(self, stepper: ContactStepper, number: int, full: Array) -> None:
        """Force of the base on the column: of a contact, of a half-space, or what the prescribed motion takes."""
        model = stepper.model
        if stepper.column.unsupported:
            return
        if stepper.column.foot_contact:
            self.force[number, 0] = 1.0
        elif model.impedance is not None:
            full[1, number, model.base] = -model.impedance
            self.of_base[number, 1] = 2 * model.impedance
        else:
            full[0, number] = model.K[[model.base]].toarray()[0]
            full[2, number] = model.M[[model.base]].toarray()[0]
            self.of_base[number, 3] = -stepper.weight[model.base]

    def after(self, state: ColumnState) -> Array:
        """Values after a step, but for what the base adds."""
        opening = np.maximum(state.opening, 0.0) if self.opens else state.opening
        D, V, A = self.full
        velocity = end_velocity(state.V, state.A, self.scheme)
        values: Array = D @ state.D + V @ velocity + A @ state.A + self.force @ state.force + self.opening @ opening
        return values
