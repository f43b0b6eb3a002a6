"""A user's solver through the gates: every case once, each verdict with what it tells."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import cached_property

from validation.engine.case import Case
from validation.engine.finished import Finished
from validation.engine.judge import evaluate
from validation.engine.measure import completed
from validation.engine.run import finish
from validation.gates.gate import Gate, Status, Verdict, judge
from validation.metrics.sameness import is_identical, largest_difference
from validation.metrics.values import NOT_REPORTED, UNDEFINED
from validation.runs.results import Results
from validation.runs.row import Row, Value
from validation.runs.run import Outcome
from validation.solvers.files import Outside
from validation.solvers.foreign import SAME_AS
from validation.solvers.registry import get_solver
from validation.solvers.user import PARTS, UserSolver
from validation.suite.own_solver import gates, history

REPEATED, SHORT = 2, 1000  # scenes that are run twice, and the most steps of one
PATIENCE = 2  # scenes in which a solver may reach its time limit before the rest are not tried
LARGEST = 1e300  # of a difference: JSON has no infinity
ASKED_FOR = {"modes": "modes(scene)", "static": "static(scene)"}


@dataclass(frozen=True)
class GateReport:
    """What one gate said of a user's solver, as plain data that a process can hand to another."""

    id: str
    study: str
    scene: str
    steps: int
    group: str  # one of `gates.GROUPS`
    metric: str
    status: str
    value: Value
    low: float
    high: float
    why: str  # why it was not run, or what the run ended with; empty where a value was judged
    outcome: str  # how the solver's run ended; empty where it was not asked
    key: str  # of its history in `results`
    results: str  # directory
    same_as: str = ""  # solvers of the suite, separated by blanks, whose history of this scene is this one bit for bit
    repeated: bool = False  # whether the scene was run twice
    apart_in: str = ""  # the column in which the two runs differ most, by more than rounding
    apart: float = 0.0  # by how much: relative L2 [1]


class Session:
    """The cases that one process has run of a user's solver and of its references."""

    def __init__(self, user: str, results: Results) -> None:
        self.user, self.finished = user, Finished({}, results)
        self._differences: dict[str, tuple[str, float]] = {}  # of the scenes that were run twice
        self._same: dict[tuple[str, str], bool] = {}  # by scene and solver of the suite

    @cached_property
    def parts(self) -> frozenset[str]:
        """What the solver reports beside its history, among "modes" and "static"."""
        solver = get_solver(self.user)
        return solver.parts() if isinstance(solver, UserSolver | Outside) else PARTS

    def judge(self, name: str) -> tuple[Verdict, GateReport]:
        """Run what a gate needs and has not been run, and judge it; what cannot be judged is not run."""
        study, gate = gates.applying()[name]
        case = gates.cases(study)[gate.cases[0]]
        verdict = self._verdict(study, gate, case)
        row = self.finished.rows.get((case.scene.name, self.user))
        apart_in, apart = self._differences.get(case.scene.name, ("", 0.0))
        return verdict, GateReport(
            gate.id,
            study,
            case.scene.name,
            case.scene.time.steps,
            "digits" if verdict.value == UNDEFINED else gates.group(gate, case.scene),  # no motion of the model
            verdict.gate.metric,
            str(verdict.status),
            verdict.value,
            verdict.gate.low,
            verdict.gate.high,
            verdict.why,
            "" if row is None else str(row.outcome),
            "" if row is None else row.key,
            str(self.finished.results.directory),
            self._same_as(case.scene.name),
            case.scene.name in self._differences,
            apart_in,
            min(apart, LARGEST),
        )

    def _verdict(self, study: str, gate: Gate, case: Case) -> Verdict:
        judged = replace(gate, pair=(self.user, *gate.pair[1:]))
        if part := gates.lacking(gate, case.scene, self.parts):
            return Verdict(judged, None, Status.NOT_RUN, f"the solver does not report {ASKED_FOR[part]}")
        row = self._row(study, case)
        if row is None:
            why = f"not tried, since {PATIENCE} scenes reached their time limit"
            return Verdict(judged, None, Status.NOT_RUN, why)
        if row.outcome is not Outcome.COMPLETED:
            why = row.notes[-1] if row.notes else row.outcome.sentence  # what came before is said of a history
            absent = row.outcome in (Outcome.NOT_APPLICABLE, Outcome.NOT_RUN)
            return Verdict(judged, None, Status.NOT_RUN if absent else Status.FAIL, why)
        return self._judged(study, gate, judged, case, row)

    def _row(self, study: str, case: Case) -> Row | None:
        """Return the row of the user's solver, None where it is not tried any more."""
        rows, name = self.finished.rows, (case.scene.name, self.user)
        if name not in rows:
            if sum(row.outcome is Outcome.TIMEOUT for row in rows.values()) >= PATIENCE:
                return None
            self._finish(study, [replace(case, solver=self.user)])
            self._repeat(case)
        return rows[name]

    def _repeat(self, case: Case) -> None:
        """Run the first short scenes again and keep how far the two runs are apart."""
        history = self.finished.history(case.scene.name, self.user)
        if history is None or case.scene.time.steps > SHORT or len(self._differences) >= REPEATED:
            return
        again = completed(get_solver(self.user), case.scene)
        if again.history is not None:
            self._differences[case.scene.name] = largest_difference(history, again.history)

    def _same_as(self, scene: str) -> str:
        """Return the solvers of the suite whose history of a scene is the user's bit for bit.

        `dda` is compared where the run is checked; of the others those that gates have needed.
        """
        row = self.finished.rows.get((scene, self.user))
        if row is None:
            return ""
        same = [note.removeprefix(SAME_AS) for note in row.notes if note.startswith(SAME_AS)]
        for name, solver in self.finished.rows:
            if name != scene or solver == self.user:
                continue
            if (name, solver) not in self._same:
                history = self.finished.history(name, self.user)
                other = self.finished.history(name, solver)
                self._same[name, solver] = history is not None and other is not None and is_identical(history, other)
            if self._same[name, solver]:
                same.append(solver)
        return " ".join(same)

    def _finish(self, study: str, missing: list[Case]) -> None:
        finished = finish(missing, gates.study_of(study), self.finished.results)
        self.finished.rows.update(finished.rows)

    def _judged(self, study: str, gate: Gate, judged: Gate, case: Case, row: Row) -> Verdict:
        """Judge a sound run, by its history where the solver reports nothing; references are run here."""
        own_history = self.finished.history(case.scene.name, self.user)
        if own_history is not None and gates.shown_by_history(gate, case.scene) and self._by_history(study, gate, row):
            return judge(*history.shown(judged, case.scene, own_history))
        needed = [pair for pair in gates.study_of(study).needs(gate) if pair != gate.cases[0]]
        self._finish(study, [gates.cases(study)[pair] for pair in needed if pair not in self.finished.rows])
        verdict = evaluate(judged, replace(self.finished, derived=gates.recipes(study)))
        if verdict.value == NOT_REPORTED:
            return replace(verdict, status=Status.NOT_RUN, why=f"the solver does not report {gate.metric}")
        return verdict

    def _by_history(self, study: str, gate: Gate, row: Row) -> bool:
        measured = study == gates.START.name or "measured" in gate.metric
        return measured or row.metrics.get(gate.metric) == NOT_REPORTED


def plain(result: GateReport) -> dict[str, object]:
    """Return what a gate said as JSON takes it."""
    return asdict(result)
