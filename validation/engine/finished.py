"""The finished cases of a study, and rows that are derived from them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from validation.runs.history import History
from validation.runs.results import Results
from validation.runs.row import Metrics, Row
from validation.runs.run import Outcome
from validation.runs.text import error_text
from validation.scenes.scene import Scene


class NothingToDerive(Exception):
    """What a row would be derived from is not there; the text says what."""


@dataclass(frozen=True)
class Derived:
    """A row that is computed from finished cases instead of by a solver; gates address it as any other."""

    scene: str  # where gates find it: ``Gate(scene, (name,), metric, ...)``
    name: str
    needs: tuple[tuple[str, str], ...]  # (case, solver) pairs; where one did not complete, neither does this
    compute: Callable[[Finished], Metrics]
    reads: tuple[str, ...] = ()  # metrics of these cases, beside their histories
    linear: bool = False  # whether it, and gates on it, exist for linear scenes only


DerivedRows = tuple[Derived, ...]


@dataclass(frozen=True)
class Finished:
    """The finished cases of a study: rows and histories by (scene, solver), and what is derived from them."""

    rows: dict[tuple[str, str], Row]
    results: Results
    derived: Mapping[tuple[str, str], Derived] = field(default_factory=dict)
    _computed: dict[tuple[str, str], Row] = field(default_factory=dict, init=False, repr=False, compare=False)

    def row(self, scene: str, name: str) -> Row | None:
        """Return the row of a case, or the derived row of that name, which is computed once: many gates may ask."""
        recipe = self.derived.get((scene, name))
        if recipe is None or (scene, name) in self.rows:
            return self.rows.get((scene, name))
        if (scene, name) not in self._computed:
            self._computed[scene, name] = self._derive(recipe)
        return self._computed[scene, name]

    def _derive(self, recipe: Derived) -> Row:
        """Compute a derived row; whatever happens in it ends as a named outcome."""
        scene = recipe.scene
        name = recipe.name
        for need in recipe.needs:
            row = self.rows.get(need)
            if row is None or row.outcome is not Outcome.COMPLETED:
                outcome = Outcome.NOT_RUN if row is None else row.outcome
                return Row("", "", scene, name, outcome, {}, notes=(f"needs {need[1]} on {need[0]}",))
        try:
            return Row("", "", scene, name, Outcome.COMPLETED, recipe.compute(self))
        except NothingToDerive as error:
            return Row("", "", scene, name, Outcome.NOT_RUN, {}, notes=(str(error),))
        except Exception as error:  # numbers that a faulty run leaves without meaning
            return Row("", "", scene, name, Outcome.RAISED, {}, notes=(error_text(error),))

    def needed_history(self, scene: str, solver: str) -> History:
        """Return the history of a case that a derived row needs, or raise ValueError where there is none."""
        history = self.history(scene, solver)
        if history is None:
            raise ValueError(f"{scene}: must have a history of {solver}, got none")
        return history

    def history(self, scene: str, solver: str) -> History | None:
        """Return the history of a case, or None."""
        row = self.rows.get((scene, solver))
        return None if row is None or row.outcome is not Outcome.COMPLETED else self.results.history(row.key)


def derived_row(
    owner: str,
    name: str,
    cases: Sequence[Scene],
    compute: Callable[..., Metrics],
    histories: Sequence[str] = (),
    rows: Sequence[str] = (),
    reads: Sequence[str] = (),
    whole: bool = False,
) -> Derived:
    """Return a row that is computed from the histories and the rows of some solvers, of one case or of several.

    Parameters
    ----------
    owner, name
        Where gates find it.
    cases
        The case, all of those that the row is computed from, or none.
    compute
        Function of a case, its histories and its rows; where the row is of the `whole`, of a list of these.
    histories, rows
        The solvers whose histories, and whose rows, are read of each case.
    reads
        The metrics that are read of the rows.
    """

    def compute_row(finished: Finished) -> Metrics:
        read = []
        for case in cases:
            of_histories = (finished.needed_history(case.name, solver) for solver in histories)
            read.append((case, *of_histories, *(finished.rows[case.name, solver] for solver in rows)))
        return compute(read) if whole else compute(*itertools.chain(*read))

    needs = itertools.product((case.name for case in cases), (*histories, *rows))
    return Derived(owner, name, tuple(needs), compute_row, tuple(reads))
