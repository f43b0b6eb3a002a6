"""The finished cases of a study, and rows that are derived from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from validation.runs.aliases import NamePair, Words
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
    """A row that is computed from finished cases instead of by a solver; gates address it as any other.

    Attributes
    ----------
    scene, name
        Where gates find it: ``Gate(scene, (name,), metric, ...)``.
    needs
        The (case, solver) pairs that it is computed from; where one did not complete, neither does this.
    compute
        Function of the finished cases that returns metrics.
    reads
        The metrics of these cases that it reads beside their histories.
    linear
        Whether it has a meaning for linear scenes only; gates on it do not exist for others.
    """

    scene: str
    name: str
    needs: tuple[NamePair, ...]
    compute: Callable[[Finished], Metrics]
    reads: Words = ()
    linear: bool = False


@dataclass(frozen=True)
class Finished:
    """The finished cases of a study: rows and histories by (scene, solver), and what is derived from them."""

    rows: dict[NamePair, Row]
    results: Results
    derived: Mapping[NamePair, Derived] = field(default_factory=dict)
    _computed: dict[NamePair, Row] = field(default_factory=dict, init=False, repr=False, compare=False)

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
        """Return the history of a case that a derived row needs.

        Raises
        ------
        ValueError
            There is none.
        """
        history = self.history(scene, solver)
        if history is None:
            raise ValueError(f"{scene}: must have a history of {solver}, got none")
        return history

    def history(self, scene: str, solver: str) -> History | None:
        """Return the history of a case, or None."""
        row = self.rows.get((scene, solver))
        return None if row is None or row.outcome is not Outcome.COMPLETED else self.results.history(row.key)


def from_history(case: Scene, solver: str, name: str, compute: Callable[[Scene, History], Metrics]) -> Derived:
    """Return a row that is computed from the history of one case.

    Parameters
    ----------
    case, solver
        The case whose history is read.
    name
        Of the row.
    compute
        Function of the case and its history that returns metrics.
    """

    def compute_row(finished: Finished) -> Metrics:
        return compute(case, finished.needed_history(case.name, solver))

    return Derived(case.name, name, ((case.name, solver),), compute_row)


def from_metrics(case: Scene, solvers: Sequence[str], name: str, compute: Callable[..., Metrics]) -> Derived:
    """Return a row that is computed from the metrics of some solvers of a case, or from the case alone.

    Parameters
    ----------
    case, solvers
        The case, and the solvers whose rows are read.
    name
        Of the row.
    compute
        Function of the case and of the rows that returns metrics.
    """

    def compute_row(finished: Finished) -> Metrics:
        return compute(case, *(finished.rows[case.name, solver] for solver in solvers))

    return Derived(case.name, name, tuple((case.name, solver) for solver in solvers), compute_row)
