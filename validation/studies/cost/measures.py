"""What the finished cases of a block say of error and cost: a row for each run, the cheapest ways, and facts for gates.

**Work** of a run is what ranks it, since a clock on a busy machine does not: the lines of Python that it executes,
set-up included (`work.lines`, counted by the engine), and what compiled loops do beside them, unknowns times steps, of
which `NUMBERS_A_LINE` take as long as a line. Seconds are told beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from validation.engine.finished import Derived, Finished
from validation.metrics.pairs import relative_l2
from validation.metrics.values import or_nan, ratio
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, History
from validation.runs.row import Metrics, Row, Value
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.solvers.registry import get_solver
from validation.studies.cost.ladder import Ladder, Method, methods
from validation.suite.bands import fitted_order

QUANTITIES = {"displacement": DISPLACEMENT, "force": PRESSURE}
ACCURACIES = {"10 %": 0.1, "1 %": 0.01, "0.1 %": 0.001}
WORKS = ("steps", "unknowns", "solves", "factorisations", "lines")
NUMBERS_A_LINE = 10  # unknowns times steps of a compiled loop, 2e-8 s each with a sine, in the 2e-7 s of a line
RICHARDSON = 3.0  # 2^2 - 1: distance to half as many steps and elements over the error, for the order 2
ORDER_LEVELS = 3  # finest ones that an order is fitted on
REFERENCE = "reference"  # name of the row of a block
DIFFERENCES = {  # relative, of errors, each of a method at a level
    "model": (("block-average", 128), ("block-events", 64)),
    "sub_blocks": (("few-average", 32), ("fem-linear", 32)),
}
ANY, OWN, ELEMENTS = "any", "dda", "fem"  # who is asked for the cheapest way


def on_grid(history: History, column: str, grid: Array) -> Array:
    """Return a column at the instants of a grid, straight between its steps, from zero at t = 0."""
    return np.asarray(np.interp(grid, np.append(0.0, history.time), np.append(0.0, history.columns[column])))


def running_mean(values: Array, count: int) -> Array:
    """Return the mean over the last `count` intervals of a grid, of values that are straight between its instants.

    Values are at the instants of equal intervals, from zero at t = 0 on, shape (intervals + 1,); before t = 0 are
    zeros.
    """
    integral = np.append(0.0, np.cumsum((values[1:] + values[:-1]) / 2))
    before = np.append(np.zeros(count), integral)[: len(values)]
    return np.asarray((integral - before) / count)


def errors(ladder: Ladder, history: History, reference: History) -> dict[str, float]:
    """Return the relative L2 errors of the running means of running means, by quantity."""
    grid = np.append(0.0, reference.time)
    count = max(1, round(ladder.mean / float(reference.time[0])))
    error_of = {}
    for quantity, column in QUANTITIES.items():
        smooth = [
            running_mean(running_mean(on_grid(motion, column, grid), count), count) for motion in (history, reference)
        ]
        error_of[quantity] = or_nan(relative_l2(*smooth))
    return error_of


def row_name(method: Method) -> str:
    """Return the name of the row of a run."""
    return "choice" if method.is_choice else "run"


def effort(row: Row) -> float:
    """Return the work of a run in lines of Python."""
    numbers = row.work.get("unknowns", 0) * row.work.get("steps", 0)
    return row.work.get("lines", 0) + numbers / NUMBERS_A_LINE


@dataclass(frozen=True)
class Run:
    """A finished run of a method at a level."""

    method: Method
    level: int
    metrics: Metrics

    def number(self, name: str) -> float:
        """Return one of its numbers, or NaN."""
        value = self.metrics.get(name)
        return float(value) if isinstance(value, int | float) else np.nan


class BlockRows:
    """The derived rows of a block."""

    def __init__(self, ladder: Ladder, name: str) -> None:
        self.ladder = ladder
        self.name = name
        cases = ladder.scene(ladder.reference).expand()
        self.reference = (cases[-1].name, ladder.reference.solver)
        self.coarser = [(case.name, ladder.reference.solver) for case in cases[:-1]]

        self.cases: list[tuple[Method, int, Scene]] = []  # those that are solved
        for method in methods():
            solver = get_solver(method.solver)
            for level, case in zip(method.levels, ladder.scene(method).expand(), strict=True):
                if solver.refusal(case) is None and solver.missing(case) is None:
                    self.cases.append((method, level, case))

    def rows(self) -> Iterator[Derived]:
        """Yield the rows: of the reference, each run, the cheapest ways, facts."""
        every = (
            self.reference,
            *((case.name, method.solver) for method, _, case in self.cases if not method.is_choice),
        )
        yield Derived(self.ladder.base.name, REFERENCE, (self.reference, *self.coarser), self._reference)
        for method, level, case in self.cases:
            needs = (self.reference, (case.name, method.solver))
            yield Derived(case.name, row_name(method), needs, self._run(method, level, case))
        for quantity in QUANTITIES:
            for accuracy in ACCURACIES:
                for who in (ANY, OWN, ELEMENTS):
                    name = f"cheapest {quantity} {accuracy} {who}"
                    yield Derived(self.ladder.base.name, name, every, self._cheapest(quantity, accuracy, who))
            yield Derived(self.ladder.base.name, f"facts of {quantity}", every, self._facts(quantity))

    def _reference(self, finished: Finished) -> Metrics:
        """Return what the errors are measured in, and its uncertainty."""
        ladder = self.ladder
        metrics: dict[str, Value] = {"block": self.name, "label": ladder.reference.label}
        metrics |= {"period": ladder.period, "window": ladder.window, "mean": ladder.mean}
        finest = finished.needed_history(*self.reference)
        for coarser in self.coarser:
            distances = errors(ladder, finished.needed_history(*coarser), finest)
            metrics |= {f"uncertainty.{name}": value / RICHARDSON for name, value in distances.items()}
        return metrics

    def _run(self, method: Method, level: int, case: Scene) -> Callable[[Finished], Metrics]:
        def compute(finished: Finished) -> Metrics:
            reference = finished.needed_history(*self.reference)
            row = finished.rows[case.name, method.solver]
            history = finished.needed_history(case.name, method.solver)
            metrics: dict[str, Value] = {"block": self.name, "method": method.id, "label": method.label}
            metrics |= {"level": level, "step": case.time.step}
            if method.per_element:
                metrics["mesh"] = case.fem.per_side
            if case.block.subdivide:
                metrics["cut"] = " × ".join(map(str, case.block.subdivide))
            for quantity, error in errors(self.ladder, history, reference).items():
                metrics[f"error.{quantity}"] = error
            metrics |= {"seconds": sum(row.seconds.values()), "setup": row.seconds.get("setup")}
            metrics |= {"spread": row.metrics.get("seconds.spread"), "work": effort(row)}
            metrics |= {name: row.work[name] for name in WORKS if name in row.work}
            return metrics

        return compute

    def runs(self, finished: Finished) -> list[Run]:
        """Return the completed runs, without choices."""
        completed = []
        for method, level, case in self.cases:
            row = None if method.is_choice else finished.row(case.name, row_name(method))
            if row is not None and row.outcome is Outcome.COMPLETED:
                completed.append(Run(method, level, row.metrics))
        return completed

    def _cheapest(self, quantity: str, accuracy: str, who: str) -> Callable[[Finished], Metrics]:
        def compute(finished: Finished) -> Metrics:
            runs = [run for run in self.runs(finished) if who in (ANY, run.method.solver)]
            metrics: dict[str, Value] = {"block": self.name, "quantity": quantity, "accuracy": accuracy, "who": who}
            within = reaching(runs, quantity, ACCURACIES[accuracy])
            if not within:
                return {**metrics, "way": "no run gets there"}
            best = min(within, key=lambda run: run.number("work"))
            return {**best.metrics, **metrics, "way": way(best)}

        return compute

    def _facts(self, quantity: str) -> Callable[[Finished], Metrics]:
        """Return what gates and the chapter ask.

        How seconds rank the runs beside work (Spearman), how many accuracies are reached by whom, orders, and two
        models against two others.
        """

        def compute(finished: Finished) -> Metrics:
            runs = self.runs(finished)
            places = [np.argsort(np.argsort([run.number(name) for run in runs])) for name in ("work", "seconds")]
            facts: dict[str, Value] = {"rank": np.asarray(np.corrcoef(places))[0, 1]}
            for who in (ANY, OWN, ELEMENTS):
                facts[f"reached.{who}"] = reached([run for run in runs if who in (ANY, run.method.solver)], quantity)
            one_strain = [run for run in runs if run.method.solver == OWN and not run.method.cut]
            facts["reached.one_strain"] = reached(one_strain, quantity)
            error_of: dict[str, dict[int, float]] = {}
            for run in runs:
                error_of.setdefault(run.method.id, {})[run.level] = run.number(f"error.{quantity}")
            for method, by_level in error_of.items():
                levels = list(by_level)[-ORDER_LEVELS:]
                if len(levels) == ORDER_LEVELS:
                    facts[f"order.{method}"] = fitted_order([1 / n for n in levels], [by_level[n] for n in levels])
            for name, (first, second) in DIFFERENCES.items():
                shared = error_of.get(first[0], {}).get(first[1]), error_of.get(second[0], {}).get(second[1])
                if None not in shared:
                    facts[name] = ratio(*shared)
            return facts

        return compute


def reached(runs: Sequence[Run], quantity: str) -> int:
    """Return how many of the accuracies runs reach."""
    return sum(bool(reaching(runs, quantity, error)) for error in ACCURACIES.values())


def reaching(runs: Sequence[Run], quantity: str, error: float) -> list[Run]:
    """Return the runs within an error, as are all finer ones of their method: none is right by accident."""
    chosen = []
    for run in runs:
        finer = [other for other in runs if other.method == run.method and other.level >= run.level]
        if all(other.number(f"error.{quantity}") <= error for other in finer):
            chosen.append(run)
    return chosen


def way(run: Run) -> str:
    """Say what is run: the method with mesh, cut or number of modes."""
    if "cut" in run.metrics:
        return run.method.label.replace(f"{run.method.cut} sub-blocks", f"{run.metrics['cut']} sub-blocks")
    if "mesh" in run.metrics:
        what = "elements a side" if run.method.fem else "modes"
        return f"{run.method.label}, {run.metrics['mesh']} {what}"
    return run.method.label
