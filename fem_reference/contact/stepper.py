"""The scheme on a system of contacts: what each length of step needs is made once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from fem_reference.contact.iteration import CONVERGED, UNSETTLED, fall_back
from fem_reference.contact.law import Law, States
from fem_reference.contact.march import SUMS, ContactStage, ContactState, Record, Watch, load, march, part_of
from fem_reference.contact.system import ContactSystem
from fem_reference.problem.checks import require
from fem_reference.problem.problem import Array, Scheme
from fem_reference.problem.stages import Stage
from fem_reference.scheme.newmark import Operator, Work, inverses, operator, start_velocity
from fem_reference.scheme.stage import Body

AVERAGE = (0.25, 0.5)
"""Alpha and delta of average acceleration."""
KEPT = 8
"""Most shorter steps whose matrices are kept."""
DENSE = 256
"""Most rows whose responses are kept, eight bytes an unknown each."""
SINGLY = 4
SINGLY_UNIQUE = 100
"""Most changes of one point after the other, over the number of points: with friction, and without."""


class Marched(NamedTuple):
    """What a march has done."""

    state: ContactState  # after the completed steps
    steps: int  # number of completed steps
    solves: int  # solutions of the contact in the last step
    outcome: int  # `CONVERGED`, or why the march ended early


@dataclass
class ContactStepper:
    """The scheme applied to bodies on contacts; a scheme that is not the rule's is a `ValueError`."""

    system: ContactSystem
    scheme: Scheme
    limit: int = 6  # most solutions of the open-close iteration [-]
    single_limit: int | None = None  # then changes of one point after the other [-]; None: as many as may be needed
    rule: str = "newmark"  # or ``"implicit"``: the force of the step's end, and average acceleration of the bodies
    energies: bool = False  # whether energies are kept
    losses: bool = False  # whether energies lost are
    compiled: Callable[..., Any] | None = None  # what is compiled of the march; as it stands if None
    work: Work = field(default_factory=Work)

    def __post_init__(self) -> None:
        is_average = (self.scheme.alpha, self.scheme.delta) == AVERAGE
        is_sound = is_average or self.rule != "implicit"
        require(is_sound, "alpha, delta", f"must be {AVERAGE} for implicit contact", self.scheme)
        system = self.system
        if system.to_modes is not None:
            self.work.factorisations += 1
            self.work.nonzeros = system.to_modes.size
        self._impulse = self._responses(self.factor(system.M))[0] if self.rule == "implicit" else None
        self._watch = Watch(*system.watch, self.energies, self.losses)
        self._lengths: dict[float, tuple[ContactStage, ...]] = {}
        self._stages(1.0)

    def start(
        self,
        V: Array,
        place: Array,
        states: States,
        D: Array | None = None,
        force: Array | None = None,
        pull: Callable[[Any, Array], tuple[Array, Array]] | None = None,
    ) -> ContactState:
        """State at t = 0 of a velocity [m/s] and the rows' places and states, unstrained without `D` [m] or `force`.

        `pull` finds forces that come at once, of M^-1 and the acceleration without them; it returns both with them.
        """
        system = self.system
        D = np.zeros_like(V) if D is None else D
        force = np.zeros_like(place) if force is None else force
        parts = system.start_parts
        A = np.zeros_like(V)
        is_consistent = self.scheme.start == "consistent"
        if is_consistent:
            mass = self.factor(system.M)
            F = load(system.F, system.pushes, parts) + system.B.T @ force - self._stages(1.0)[0].body.K * D
            A = mass * (F if system.C is None else F - system.C @ V)
            if pull is not None:
                A, force = pull(mass, A)
        return ContactState(
            D=D,
            V=start_velocity(V, A, self.scheme),
            A=A,
            place=place,
            force=force,
            states=states,
            slid=np.zeros_like(place),
            parts=parts,
            sums=np.zeros(SUMS),
            position=0.0,
            is_undiscounted=self.scheme.staggered,
            is_out_of_balance=not is_consistent,
        )

    def record(self, steps: int) -> Record:
        """Room for so many steps."""
        rows = len(self.system.rows.compliance)
        watch = self.system.watch
        return Record(
            displacements=np.zeros((steps, len(watch.D))),
            velocities=np.zeros((steps, len(watch.V))),
            accelerations=np.zeros((steps, len(watch.A))),
            place=np.zeros((steps, rows)),
            force=np.zeros((steps, rows)),
            slid=np.zeros((steps, rows)),
            states=np.zeros((steps, rows), dtype=np.int8),
            stored=np.zeros((steps, 3)),
            sums=np.zeros((steps, SUMS)),
            solves=np.zeros(steps),
            cuts=np.zeros(steps),
        )

    def march(self, state: ContactState, record: Record, ratio: float = 1.0) -> Marched:
        """As `march`, for steps of a `ratio` of the scheme's own length."""
        stages = self._stages(ratio)
        steps = len(record.solves)
        positions = state.position + ratio * np.arange(float(steps))
        ends = ratio * np.array([now.stage.end for now in stages])
        prescribed = self.system.prescribed(positions, self.scheme.step * (positions[:, None] + ends))
        run = self.compiled or march
        fallback = None if self.compiled else fall_back
        completed = 0
        solves = 0
        outcome = CONVERGED
        while completed < steps and outcome == CONVERGED:
            rest = part_of(record, slice(completed, None))
            state, made, solves, outcome = run(stages, self._watch, state, prescribed[completed:], rest, fallback)
            completed += made
            if outcome == UNSETTLED:
                # A fallback is rare, and not compiled.
                one = part_of(record, slice(completed, completed + 1))
                state, made, solves, outcome = march(stages, self._watch, state, prescribed[completed:], one, fall_back)
                completed += made
        return Marched(state, completed, solves, outcome)

    def factor(self, matrix: Any) -> Any:
        """Inverse of M or S: of a diagonal, or as an operator."""
        return 1 / matrix if self.system.to_modes is not None else Operator(self.work.factor(matrix))

    def _stages(self, ratio: float) -> tuple[ContactStage, ...]:
        if ratio in self._lengths:
            return self._lengths[ratio]
        if len(self._lengths) > KEPT:
            self._lengths = {1.0: self._lengths[1.0]}
        system = self.system
        scheme = replace(self.scheme, step=self.scheme.step * ratio, gg=self.scheme.gg**ratio)
        is_implicit = self.rule == "implicit"
        weight = 1 / (2 * scheme.alpha) if is_implicit else 1.0
        responses: list[tuple[Any, Array]] = []
        stages: list[ContactStage] = []
        begin = 0.0
        is_newmark = scheme.table is None
        is_modal = system.to_modes is not None
        M = system.M if is_modal else operator(system.M)
        K = system.K if is_modal else system.elastic
        C = None if system.C is None else operator(system.C)
        is_alone = system.rows.partner == np.arange(len(system.rows.partner))
        singly = SINGLY_UNIQUE if is_alone.all() else SINGLY
        single_limit = singly * int(is_alone.sum()) if self.single_limit is None else self.single_limit
        stage_inverses = inverses(system.M, system.K, scheme, system.C, self.factor)
        for number, first in enumerate(scheme.stage_matrices):
            responses.append(responses[first] if first < number else self._responses(stage_inverses[number], weight))
            response, W = responses[number]
            stage = Stage(*(float(value) for value in scheme.stages[number]))
            end_weight = stage.gamma if is_newmark else 0.5
            flexibility = stage.stiffness_weight * scheme.step**2 * (W + W.T) / 2
            of_stage = ContactStage(
                stage=stage,
                body=Body(M, C, K, stage_inverses[number]),
                law=Law(flexibility, *system.rows, limit=self.limit, single_limit=single_limit),
                B=system.B,
                response=response,
                impulse=self._impulse if is_implicit else response,
                F=system.F,
                pushes=system.pushes,
                ground=system.ground,
                h=float(scheme.step),
                gg=float(scheme.gg),
                ratio=float(ratio),
                duration=stage.end - begin,
                stagger=scheme.step / 2 if scheme.staggered else 0.0,
                end_weight=1.0 if is_implicit else end_weight,
                is_implicit=is_implicit,
                is_newmark=is_newmark,
            )
            stages.append(of_stage)
            begin = stage.end
        self._lengths[ratio] = tuple(stages)
        return self._lengths[ratio]

    def _responses(self, inverse: Any, weight: float = 1.0) -> tuple[Any, Array]:
        """Weighted S^-1 B', an operator where it is not kept, and B times it; of M^-1 likewise."""
        B = self.system.B
        count, unknowns = B.shape
        if self.system.to_modes is not None:
            response = np.ascontiguousarray(weight * inverse[:, None] * B.T)
            return response, B @ response
        if count > DENSE:
            columns = (B @ (inverse * B[[i]].toarray()[0]) for i in range(count))
            return Operator(lambda force: inverse * (weight * (B.T @ force))), weight * np.array([*columns]).T
        response = np.empty((unknowns, count))
        for i in range(count):
            response[:, i] = inverse * B[[i]].toarray()[0]
        response *= weight
        return response, B @ response
