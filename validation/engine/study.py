"""Studies: scenes x solvers, with the gates that judge them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import Any

from validation.engine.case import MEASURES, Case
from validation.engine.finished import Derived, DerivedRows, Finished
from validation.gates.gate import Gate
from validation.runs.records import Annotations
from validation.runs.run import Outcome
from validation.scenes.scene import Scene, load_scene

REPEATS = 2  # of each case of a study of timings


def _nothing_to_say(scenes: Sequence[Scene], finished: Finished) -> Annotations:
    return {"alarms": [], "budgets": []}


@dataclass(frozen=True)
class Study:
    """A declaration that the engine runs; functions take what costs until it is asked for."""

    name: str  # on the command line
    title: str  # heading of its chapter
    purpose: str  # first sentence of its chapter
    scenes: Sequence[str | Scene]  # built-in ones by their names
    solvers: tuple[str, ...] | None = None  # for every scene; by default those of the scene's `[run]` table
    _: KW_ONLY
    extra: tuple[tuple[str, str], ...] = ()  # further (case name, solver) pairs, such as a run without savings
    gates: Callable[[], tuple[Gate, ...]] = tuple
    timed: bool = False  # whether the study is one of timings, whose cases run alone and repeatedly
    derived: Callable[[], DerivedRows] = tuple  # rows that are computed from finished cases
    data: Callable[[], Mapping[str, Any]] = dict  # that the chapter draws beside the rows, such as closed forms
    measures: tuple[str, ...] = MEASURES  # on each run, see `validation.engine.case`
    pairs: tuple[tuple[str, str], ...] | None = None  # comparisons; every solver with every later one where None
    annotate: Callable[[Sequence[Scene], Finished], Annotations] = _nothing_to_say
    expects: tuple[Outcome, ...] = ()  # beside completion, that are no failure, where how a run ends is the question
    long: bool = False  # whether the gates are left to `dda-validate run`; the tests judge the others

    def cases(self, full: bool = False, ranks: int = 1) -> list[Case]:
        """Return all cases; with `full` those of every solver's full model, on `ranks` ranks where one can use them."""
        pairs = []
        scenes_by_name = {}
        for declared in self.scenes:
            scene = load_scene(declared) if isinstance(declared, str) else declared
            for case in scene.expand():
                scenes_by_name[case.name] = case
                pairs += [(case, solver) for solver in self.solvers or case.run.solvers]
        pairs += [(scenes_by_name[name], solver) for name, solver in self.extra if name in scenes_by_name]
        repeats = REPEATS if self.timed else 0
        return [Case(scene, solver, full, ranks, self.measures, repeats) for scene, solver in pairs]

    @cached_property
    def recipes(self) -> Mapping[tuple[str, str], Derived]:
        """The derived rows by the names that gates address them with."""
        return {(row.scene, row.name): row for row in self.derived()}

    def needs(self, gate: Gate) -> list[tuple[str, str]]:
        """Return the (case, solver) pairs that a gate needs, those behind derived rows included."""
        needs: list[tuple[str, str]] = []
        for name in gate.cases:
            needs += self.recipes[name].needs if name in self.recipes else (name,)
        return needs
