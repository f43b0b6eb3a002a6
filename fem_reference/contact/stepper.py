"""The block on its contact points with its scheme: what each length of step needs is made once."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_array, vstack

from fem_reference.contact import kernel
from fem_reference.contact.kernel import (
    CONVERGED,
    OPEN,
    STARTED,
    STICK,
    TIME,
    TOTALS,
    UNDISCOUNTED,
    UNILATERAL_COLUMNS,
    UNSETTLED,
    ContactState,
)
from fem_reference.contact.points import ContactModel
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Scheme
from fem_reference.scheme.newmark import Operator, Work, effective_matrix, start_velocity

AVERAGE = (0.25, 0.5)
"""Alpha and delta of average acceleration."""
KEPT = 8
"""Greatest number of shorter steps whose matrices are kept."""
DENSE = 256
"""Greatest number of forces whose responses are kept, eight bytes an unknown each."""


@dataclass(frozen=True)
class Friction:
    """Coulomb's friction along the base, |T| <= tan(angle) N + cohesion times a point's length of the base.

    Raises
    ------
    ValueError
        For a value out of its range, naming field, rule and value.
    """

    angle: float  # friction angle [deg], from 0 to below 90
    cohesion: float = 0.0  # shear stress that a closed base bears without any pressure [Pa]

    def __post_init__(self) -> None:
        require(0 <= self.angle < 90, "friction", "must be at least 0 and below 90", self.angle)
        require(0 <= self.cohesion < math.inf, "cohesion", "must be finite and not negative", self.cohesion)

    @property
    def tangent(self) -> float:
        """Tangent of the angle [-]."""
        return math.tan(math.radians(self.angle))


class Marched(NamedTuple):
    """What a march has done."""

    state: ContactState  # after the completed steps
    steps: int  # number of completed steps
    solves: int  # solutions of the contact in the last step
    outcome: int  # `CONVERGED`, or why the march ended early


@dataclass
class ContactStepper:
    """The scheme applied to the block on points, with its factorisations made once for each length of step.

    Raises
    ------
    ValueError
        If a column is unknown, or the scheme is not the rule's; `Unilateral` checks the rest.
    """

    model: ContactModel
    scheme: Scheme
    shear: str = "frictionless"  # ``"frictionless"``, or ``"glued"``: shear springs hold the closed points
    limit: int = 6  # greatest number of solutions of the open-close iteration [-]
    rule: str = "newmark"  # or ``"implicit"``: the force of the step's end, and average acceleration of the block
    friction: Friction | None = None  # limit of the forces of glued points; none if absent
    columns: tuple[str, ...] = ()  # columns that a march keeps, among `UNILATERAL_COLUMNS`
    modal: bool = False  # step in the natural modes of the block, by products with diagonals
    compiled: Callable[..., Any] | None = None  # what is compiled of the kernel's march; as it stands if None
    work: Work = field(default_factory=Work)

    def __post_init__(self) -> None:
        for name in self.columns:
            if name not in UNILATERAL_COLUMNS:
                raise ValueError(f"columns: must be among {UNILATERAL_COLUMNS}, got {name!r}")
        implicit = self.rule == "implicit"
        if implicit and (self.scheme.alpha, self.scheme.delta) != AVERAGE:
            raise ValueError(f"alpha, delta: must be {AVERAGE} for implicit contact, got {self.scheme}")
        model = self.model
        both = vstack([model.normal, model.tangential])
        self._B: Any = csr_array(both if self.shear == "glued" else model.normal)
        self._M: Any = model.M
        self._K: Any = model.K
        self._F = model.F
        self._upwards = model.upwards
        names = ("displacement", "horizontal_displacement", "rotation")
        self._rows = np.array([model.observers[name] for name in names])
        self._momentum = model.M @ model.upwards
        self._momentum = self._momentum / float(model.upwards @ self._momentum)
        if self.modal:
            self._use_modes()
        self._impulse = self._responses(self._factor(self._M))[0] if implicit else None
        self._lengths: dict[float, tuple[tuple[kernel.Block, ...], tuple[kernel.Law, ...]]] = {}
        self._length(self.scheme.step)

    def start(self, gap: float = 0.0, speed: float = 0.0) -> ContactState:
        """State at t = 0: unstrained, a gap above the base [m], with one velocity upwards [m/s]."""
        points = len(self.model.share)
        consistent = self.scheme.start == "consistent"
        mass = self._factor(self._M) if consistent else None
        totals = np.zeros(TOTALS)
        totals[STARTED] = consistent
        totals[UNDISCOUNTED] = self.scheme.staggered
        A = np.zeros_like(self._F) if mass is None else mass * self._F
        return ContactState(
            D=np.zeros_like(self._F),
            V=start_velocity(speed * self._upwards, A, self.scheme),
            A=A,
            gap=np.full(points, float(gap)),
            slip=np.zeros(points),
            reference=np.zeros(points),
            normal=np.zeros(points),
            shear=np.zeros(points),
            states=np.full(points, STICK if gap == 0 else OPEN, dtype=np.int8),
            slid=np.zeros(points),
            totals=totals,
        )

    def march(self, state: ContactState, table: Array, length: float | None = None) -> Marched:
        """Make as many steps as the table has rows, of a shorter `length` [s] where that is given.

        The rows of the completed steps are filled.
        """
        blocks, laws = self._length(self.scheme.step if length is None else length)
        ends = np.array([stage.end for stage in self.scheme.stages])
        base = np.zeros((len(table), len(ends), 2))
        if self.model.motion is not None:
            times = state.totals[TIME] + blocks[0].step * (np.arange(float(len(table)))[:, None] + ends)
            base = (self.model.motion(times.ravel()) @ self.model.axes.T).reshape(base.shape)
        numbers = np.array([UNILATERAL_COLUMNS.index(name) for name in self.columns], dtype=np.int64)
        energies = any(name in kernel.ENERGY_COLUMNS for name in self.columns)
        losses = any(name in kernel.LOSS_COLUMNS for name in self.columns)
        march = self.compiled or kernel.march
        fallback = None if self.compiled else kernel.fall_back
        arguments = (numbers, energies, losses)
        completed = 0
        solves = 0
        outcome = CONVERGED
        while completed < len(table) and outcome == CONVERGED:
            rest = slice(completed, None)
            state, steps, solves, outcome = march(blocks, laws, state, base[rest], *arguments, table[rest], fallback)
            completed += steps
            if outcome == UNSETTLED:
                # A fallback is rare, and not compiled.
                one = slice(completed, completed + 1)
                state, steps, solves, outcome = kernel.march(
                    blocks, laws, state, base[one], *arguments, table[one], kernel.fall_back
                )
                completed += steps
        return Marched(state, completed, solves, outcome)

    def advance(self, state: ContactState, length: float | None = None) -> tuple[ContactState | None, Marched]:
        """One step; the state at its end, or None where it has no contact."""
        marched = self.march(state, np.empty((1, len(self.columns))), length)
        return marched.state if marched.steps else None, marched

    def _use_modes(self) -> None:
        """Turn to the natural modes of the block, in which M is one and K a diagonal."""
        squares, shapes = eigh(self._K.toarray(), self._M.toarray())
        # Without the springs of the base the block is free to move, and in the plane to turn.
        squares[: 1 if self.model.kind == "column" else 3] = 0.0
        self._upwards = shapes.T @ (self._M @ self._upwards)
        self._momentum = self._momentum @ shapes
        self._M = np.ones(len(squares))
        self._K = squares
        self._F = shapes.T @ self._F
        self._B = np.ascontiguousarray(self._B @ shapes)
        self._rows = np.ascontiguousarray(self._rows @ shapes)
        self.work.factorisations += 1
        self.work.nonzeros = shapes.size

    def _factor(self, matrix: Any) -> Any:
        """Inverse of M or S: of a diagonal, or as an operator."""
        return 1 / matrix if self.modal else Operator(self.work.factor(matrix))

    def _length(self, length: float) -> tuple[tuple[kernel.Block, ...], tuple[kernel.Law, ...]]:
        if length in self._lengths:
            return self._lengths[length]
        if len(self._lengths) > KEPT:
            self._lengths = {self.scheme.step: self._lengths[self.scheme.step]}
        scheme = replace(self.scheme, step=length, gg=self.scheme.gg ** (length / self.scheme.step))
        blocks: list[kernel.Block] = []
        laws: list[kernel.Law] = []
        weight = 1 / (2 * scheme.alpha) if self.rule == "implicit" else 1.0
        matrices: dict[int, tuple[Any, Any, Array]] = {}
        begin = 0.0
        for number, first in enumerate(scheme.stage_matrices):
            if first == number:
                inverse = self._factor(effective_matrix(self._M, self._K, scheme, number))
                matrices[number] = (inverse, *self._responses(inverse, weight))
            inverse, response, C = matrices[first]
            end = scheme.stages[number].end
            blocks.append(self._block(scheme, number, end - begin, inverse, response))
            laws.append(self._law(scheme, number, C))
            begin = end
        self._lengths[length] = tuple(blocks), tuple(laws)
        return self._lengths[length]

    def _block(self, scheme: Scheme, number: int, duration: float, inverse: Any, response: Any) -> kernel.Block:
        """The block in one stage."""
        implicit = self.rule == "implicit"
        stage = scheme.stages[number]
        closed_loss = scheme.table is None
        end_weight = stage.gamma if closed_loss else 0.5
        return kernel.Block(
            K=self._K if self.modal else Operator(lambda vector: self._K @ vector),
            M=self._M if self.modal else Operator(lambda vector: self._M @ vector),
            inverse=inverse,
            B=self._B,
            response=response,
            impulse=self._impulse if implicit else response,
            F=self._F,
            rows=self._rows,
            momentum=self._momentum,
            gg=float(scheme.gg),
            step=float(scheme.step),
            stagger=scheme.step / 2 if scheme.staggered else 0.0,
            duration=float(duration),
            beta=float(stage.beta),
            gamma=float(stage.gamma),
            d_u=float(stage.d_u),
            d_g=float(stage.d_g),
            e_0=float(stage.e_0),
            e_g=float(stage.e_g),
            g_0=float(stage.g_0),
            g_g=float(stage.g_g),
            am=float(stage.am),
            af=float(stage.af),
            end_weight=1.0 if implicit else float(end_weight),
            has_closed_loss=closed_loss,
        )

    def _law(self, scheme: Scheme, number: int, C: Array) -> kernel.Law:
        """The contact in one stage, C the gaps and slips of unit accelerations of the forces."""
        model = self.model
        friction = self.friction or Friction(0.0)
        glued = self.shear == "glued"
        return kernel.Law(
            C=scheme.stages[number].stiffness_weight * scheme.step**2 * (C + C.T) / 2,
            compliance=1 / model.stiffness,
            shear_stiffness=model.shear_stiffness if glued else np.zeros_like(model.share),
            tangent=math.inf if self.friction is None else friction.tangent,
            cohesion=friction.cohesion * model.length * model.share,
            share=model.share,
            length=float(model.length),
            limit=self.limit,
            implicit=self.rule == "implicit",
        )

    def _responses(self, inverse: Any, weight: float = 1.0) -> tuple[Any, Array]:
        """Weighted S^-1 B', an operator where it is not kept, and B times it; of M^-1 likewise."""
        count, unknowns = self._B.shape
        transposed = self._B.T
        if self.modal:
            response = np.ascontiguousarray(weight * inverse[:, None] * transposed)
            return response, self._B @ response
        if count > DENSE:
            columns = (self._B @ (inverse * self._B[[i]].toarray()[0]) for i in range(count))
            return Operator(lambda forces: inverse * (weight * (transposed @ forces))), weight * np.array([*columns]).T
        response = np.empty((unknowns, count))
        for i in range(count):
            response[:, i] = inverse * self._B[[i]].toarray()[0]
        response *= weight
        return response, np.asarray(self._B @ response)
