"""Gates one by one, of the suite or with a user's solver in the place of `dda`: each case once, and what each tells."""

from __future__ import annotations

from collections.abc import Container, Iterable
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
from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.row import Row, Value
from validation.runs.run import Outcome
from validation.solvers.foreign import SAME_AS
from validation.solvers.registry import get_solver
from validation.suite.folders import judged_studies
from validation.suite.matrix import JUDGED, in_place, reported
from validation.suite.own_solver import gates, history

REPEATED, SHORT = 2, 1000  # scenes that are run twice, and the most steps of one
PATIENCE = 2  # scenes in which a solver may reach its time limit before the rest are not tried
LARGEST = 1e300  # of a difference: JSON has no infinity
ASKED_FOR = {"modes": "modes(scene)", "static": "static(scene)"}


@dataclass(frozen=True)
class GateReport:
    """What one gate said of a user's solver, as plain data."""

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
    apart_in: str = ""  # the column in which two runs of the scene differ most, by more than rounding
    apart: float = 0.0  # by how much: relative L2 [1]


class GateRuns:
    """The cases that one process has run for gates, each when a gate first asks for it.

    Bands are formulas: those of a study that is not among `studies` are not computed.
    """

    def __init__(self, results: Results, studies: Iterable[str], solver: str = JUDGED) -> None:
        self.results = results
        self.solver = solver  # which answers in the place of `JUDGED`
        self.studies = tuple(studies)
        self.rows: dict[tuple[str, str], Row] = {}
        self._finished: dict[str, Finished] = {}  # by study: what is derived is computed once for all gates

    def verdict(self, study: str, gate: Gate) -> Verdict:
        """Run what a gate needs, and judge it."""
        self.run(study, gates.study_of(study).needs(gate))
        return evaluate(gate, self.finished(study))

    def finished(self, study: str) -> Finished:
        """Return the cases that have been run, with what a study derives from them."""
        if study not in self._finished:
            self._finished[study] = Finished(self.rows, self.results, gates.study_of(study).recipes)
        return self._finished[study]

    def run(self, study: str, names: Iterable[tuple[str, str]]) -> None:
        """Run those cases of a study that have not been run."""
        missing = [gates.cases(study)[name] for name in names if name not in self.rows]
        if missing:
            kept = self.results.rows()
            answered = [self._case(case, kept) for case in missing]
            self.rows.update(finish(answered, gates.study_of(study), self.results).rows)

    def _case(self, case: Case, kept: Container[str]) -> Case:
        """Return a case with who answers it; the suite's own with the metrics that gates ask for, or of a kept row."""
        if self.solver != JUDGED:
            return in_place(case, self.solver)
        required_metrics = gates.asked(self.studies).get((case.scene.name, case.solver), frozenset())
        return case if case.key() in kept else replace(case, only=required_metrics)


class Session(GateRuns):
    """A user's solver in the place of `dda`, and what each gate tells of it."""

    def __init__(self, user: str, results: Results) -> None:
        super().__init__(results, judged_studies(), user)
        self._differences: dict[str, tuple[str, float]] = {}  # of the scenes that were run twice

    @cached_property
    def parts(self) -> frozenset[str]:
        """What the solver reports beside its history, among "modes" and "static"."""
        return get_solver(self.solver).parts()

    def judge(self, name: str) -> tuple[Verdict, GateReport]:
        """Run what a gate needs, and judge it; what cannot be judged is not run."""
        study, gate = gates.applying()[name]
        case = gates.cases(study)[gate.cases[0]]
        verdict = self._verdict(study, gate, case)
        row = self.rows.get((case.scene.name, JUDGED))
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
            str(self.results.directory),
            self._same_as(study, gate),
            apart_in,
            min(apart, LARGEST),
        )

    def _verdict(self, study: str, gate: Gate, case: Case) -> Verdict:
        judged = replace(gate, pair=(self.solver, *gate.pair[1:]))
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
        own_history = self._history(case.scene.name)
        if own_history is not None and gates.shown_by_history(gate, case.scene) and self._by_history(study, gate, row):
            return judge(*history.shown(judged, case.scene, own_history))
        return replace(reported(self.verdict(study, gate)), gate=judged)

    def _history(self, scene: str, solver: str = JUDGED) -> History | None:
        return Finished(self.rows, self.results).history(scene, solver)

    def _row(self, study: str, case: Case) -> Row | None:
        """Return the row of the user's solver, None where it is not tried any more."""
        name = (case.scene.name, JUDGED)
        if name not in self.rows:
            answered = [row for (_, solver), row in self.rows.items() if solver == JUDGED]
            if sum(row.outcome is Outcome.TIMEOUT for row in answered) >= PATIENCE:
                return None
            self.run(study, [name])
            self._repeat(case)
        return self.rows[name]

    def _repeat(self, case: Case) -> None:
        """Run the first short scenes again and keep how far the two runs are apart."""
        own_history = self._history(case.scene.name)
        if own_history is None or case.scene.time.steps > SHORT or len(self._differences) >= REPEATED:
            return
        again = completed(get_solver(self.solver), case.scene)
        if again.history is not None:
            self._differences[case.scene.name] = largest_difference(own_history, again.history)

    def _same_as(self, study: str, gate: Gate) -> str:
        """Return the solvers of the suite whose history of a gate's scene is the user's bit for bit.

        `dda` is compared where the run is checked; of the others those that the gate needs.
        """
        row = self.rows.get((gate.scene, JUDGED))
        own_history = self._history(gate.scene)
        if row is None or own_history is None:
            return ""
        same = [note.removeprefix(SAME_AS) for note in row.notes if note.startswith(SAME_AS)]
        for scene, solver in gates.study_of(study).needs(gate):
            other = self._history(scene, solver) if scene == gate.scene and solver != JUDGED else None
            if other is not None and is_identical(own_history, other):
                same.append(solver)
        return " ".join(same)

    def _by_history(self, study: str, gate: Gate, row: Row) -> bool:
        measured = study == gates.START.name or "measured" in gate.metric
        return measured or row.metrics.get(gate.metric) == NOT_REPORTED


def plain(result: GateReport) -> dict[str, object]:
    """Return what a gate said as JSON takes it."""
    return asdict(result)
