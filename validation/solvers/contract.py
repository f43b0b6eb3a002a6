"""The contract that every solver fulfils: what it says of itself, and what a prepared scene answers."""

from __future__ import annotations

import enum
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np

from validation.errors import InputError
from validation.runs import extras
from validation.runs.contact import ContactRecord
from validation.runs.history import Array, Complex
from validation.runs.modes import Mode, Switch
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.limits import check_step
from validation.solvers.translation import naming

# What solvers raise where numbers leave double precision, also where rounding or underflow made a pivot or a mass zero.
OUT_OF_RANGE = (OverflowError, ZeroDivisionError, FloatingPointError, np.linalg.LinAlgError)


class NotReported(LookupError):
    """A solver does not offer this part of the contract."""


Completed = TypeVar("Completed")


def completed(result: Completed | None) -> Completed:
    """Return what a run has left; refused where the scene was not run."""
    if result is None:
        raise NotReported("the scene was not run")
    return result


class Role(enum.StrEnum):
    """What a solver is for in a comparison."""

    JUDGED = "judged"  # the method that the suite judges
    REPEAT = "repeat"  # the answer of another solver by other arithmetic
    SECOND_CODE = "second code"  # the answer of another solver by another program
    REFERENCE = "reference"  # the same body under the same scheme, resolved or exact in space
    LIMIT = "limit"  # what the judged method tends to as the time step goes to zero
    TRUTH = "truth"  # exact in space and time
    OTHER = "other"  # brought by a user


REPORTABLE = frozenset({"modes", "static"})  # what a solver may report beside its history
EXACT_IN_TIME = (Role.LIMIT, Role.TRUTH)  # no time step enters the motion
# keys that a motion exact in time does not read
OF_SCHEMES = ("time.alpha", "time.delta", "time.start", "time.scheme", "time.rho_inf", "time.split")


@dataclass(frozen=True)
class LineStyle:
    """Colour and stroke of a solver's lines, the same in every figure."""

    color: str
    dash: tuple[float, ...] = ()  # lengths on and off, in line widths; empty is solid
    width: float = 1.0  # pt
    layer: int = 2  # higher is drawn later


class Prepared:
    """A scene that a solver has built once; everything is asked of it.

    What steps by the scene's scheme defines `history_run` and, where the scheme can be unstable, `highest_frequency`.
    The others raise `NotReported` where the solver does not offer them, and are asked of linear scenes only: what opens
    or slips has no modes, no spectrum, no response to one frequency and no single static solution.
    """

    scene: Scene
    keeps_contact_record = False  # whether `contact_record` will be asked for; set before `run`
    has_fields = False  # whether it can write displacement and stress fields
    fields: Path | None = None  # file for these fields
    progress: Callable[[float], None] | None = None  # takes the share of a run that is done; set before `run`

    def run(self, fields: Path | None = None) -> Run:
        """Run the scene; `fields` names a file for displacement and stress fields.

        Raises
        ------
        InputError
            The step exceeds the limit of a conditionally stable scheme and the scene does not allow it, the solver
            refuses a value, or it has no fields.
        """
        if fields is not None and not self.has_fields:
            raise InputError(
                "takes the solver fem, a locked contact and a constant gg",
                source=self.scene.name,
                field="--fields",
                value="no such model",
                advice="add --solver fem",
            )
        self.fields = fields
        try:
            check_step(self.scene, self.highest_frequency)
            with naming(self.scene):
                return self.history_run()
        except OUT_OF_RANGE as error:  # of plain floats and factors, where an array would have become infinite
            return Run(Outcome.OVERFLOW, notes=(str(error),))

    def highest_frequency(self) -> float | None:
        """Return the largest frequency of the model, contacts closed and sticking [rad/s]; infinite on a rigid stop.

        None where it is not known, or where nothing limits the step. Conditionally stable schemes alone ask for it.
        """
        return None

    def history_run(self) -> Run:
        """Make the steps; the limit of a step has been checked."""
        raise NotImplementedError

    def static(self) -> Mapping[str, float]:
        """Return the static solution, column name to value."""
        raise NotReported("no static solution is reported")

    def assumed_static(self) -> Mapping[str, float]:
        """Return the static solution that settling is measured from where `static` is not reported."""
        return {}

    def modes(self) -> tuple[Mode, ...]:
        """Return the modes, the one with the largest share of the static response first."""
        raise NotReported("no modes are reported")

    def diagnostics(self) -> Mapping[str, float]:
        """Return spectral radius, condition number and residual of the step."""
        raise NotReported("no diagnostics are reported")

    def response(self, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Return the complex amplitudes of displacement and contact pressure at frequencies in Hz; no step is run.

        They are those of the motion that is left when transients have gone, under the scene's loads, which vibrate in
        phase with the amplitudes that the scene gives them; where the base moves, under its motion alone, for 1 m along
        its direction. They are as the scene's scheme steps them, or as the same model answers that is `exact` in time.
        """
        check_step(self.scene, self.highest_frequency)
        with naming(self.scene):
            return self.amplitudes(frequencies, exact)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Return the response; the limit of a step has been checked."""
        raise NotReported("no frequency response is reported")

    def switches(self) -> tuple[Switch, ...]:
        """Return the openings and closings of a unilateral contact after t = 0, in the order of time."""
        raise NotReported("no switches are reported")

    def contact_record(self) -> ContactRecord:
        """Return what a unilateral contact did at each step of the history that was run."""
        raise NotReported("nothing of the contact is reported")


class Solver:
    """Base of all solvers; a new one is this checklist.

    1. `name`: how the command line and the tables call it.
    2. `handles`: the features of a scene that it takes (`validation.scenes.features`); a scene with another one is
       refused by name, so that no solver runs it as if the feature were absent; `apart`: which of them it does not
       take together; `only`: one without which it takes no scene.
    3. `sections`: the tables that it reads beside those of the scene's kind, `unread`: keys that it does not; a change
       elsewhere does not make it run again.
    4. `sources`: modules or packages whose files enter the key of its results.
    5. `role`, `rank` and `line`: its part in comparisons, its place among the references (each solver is compared
       with those of higher rank) and its look in figures.
    7. `build(scene, full)`: a `Prepared`, whose `run()` gives a `Run` with one value per step, from the first step
       on, for every column in `scene.run.columns`; numerical failure is an outcome, bad input an `InputError`.
       A solver of one function overrides `solve(scene, full, fields)` instead, and `static`, `modes`, `diagnostics`
       or `response` where it has them.
    8. `own_columns`, or `columns()`: the columns that it has; a scene's further columns are not asked of it.
    9. `libraries`, or `missing(scene)`: what it imports that an extra brings; where one is absent its runs are NOT RUN.
    """

    name: str = ""
    handles: frozenset[str] = features.FIRST
    apart: features.Apart = ()
    only: str = ""
    sections: tuple[str, ...] = ("time", "run")
    unread: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()
    cached: bool = True  # whether a finished case is kept for the next run
    distributed: bool = False  # whether its option is a number of ranks
    meshed: bool = False  # whether memory goes with the mesh, else with the blocks
    saves: bool = True  # whether it spares what a mesh repeats
    role: Role = Role.OTHER
    rank: float = -1.0  # users' solvers come first: every other one is a reference for them
    line: LineStyle | None = None  # None: a style that depends on the name alone
    own_columns: tuple[str, ...] | None = None  # None: it takes whatever a scene asks for
    libraries: tuple[str, ...] = ()  # beyond those of a plain install, see `validation.runs.extras`

    def option(self, text: str) -> Solver:
        """Return this solver with the option that ``name:option`` gives, such as a number of ranks.

        Raises
        ------
        InputError
            The solver takes no option, or not this one.
        """
        raise InputError(f"{self.name} takes no option", field="solver", value=repr(text))

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why this solver cannot run the scene, apart from features."""
        return None

    def refusal(self, scene: Scene) -> str | None:
        """Return None, or why the scene is refused, for its features or by `applicable`."""
        if refused := self.refused_features(scene):
            return refused
        if self.only and self.only not in features.of(scene):
            return f"it takes {self.only}s only"
        return self.applicable(scene)

    def refused_features(self, scene: Scene) -> str | None:
        """Return None, or which features of a scene the solver does not handle, at all or together, in words."""
        unknown = self.unhandled(scene)
        return f"it does not handle {', '.join(unknown)}" if unknown else features.clash(scene, self.apart)

    def missing(self, scene: Scene) -> str | None:
        """Return None, or what the scene needs that is not installed, and how to get it."""
        return extras.missing(*self.libraries)

    def unhandled(self, scene: Scene) -> list[str]:
        """Return the features of a scene that the solver does not handle."""
        return [name for name in features.of(scene) if name not in self.handles]

    def columns(self) -> tuple[str, ...] | None:
        """Return the columns that this solver has, None where it takes whatever a scene asks for."""
        return self.own_columns

    def parts(self) -> frozenset[str]:
        """Return what the solver can report beside its history, among `REPORTABLE`."""
        return REPORTABLE

    def check_module(self) -> None:
        """Refuse by an `InputError` a solver that is nowhere; those of the suite are here."""

    def check_loads(self) -> None:
        """Refuse by an `InputError` what is nowhere, or cannot be loaded."""

    def about(self) -> Mapping[str, str]:
        """Return what a solver says of itself; those of the suite say it in the documentation."""
        return {}

    def versions(self) -> Mapping[str, str]:
        """Return the versions of programs that its results depend on, beyond the suite's own libraries."""
        return {}

    def prepare(self, scene: Scene, full: bool = False) -> Prepared:
        """Build the scene's model once, `NotInstalled` without its library; `full` switches numerical savings off.

        Raises
        ------
        InputError
            The scene has features that the solver does not handle.
        """
        if reason := self.refused_features(scene):
            raise InputError(f"solver {self.name}: {reason}", source=scene.name)
        absent = self.missing(scene)
        return self.build(scene, full) if absent is None else NotInstalled(scene, absent)

    def build(self, scene: Scene, full: bool) -> Prepared:
        """Build the model of a scene whose features the solver handles; a solver of models overrides it."""
        if type(self).solve is Solver.solve:
            raise NotImplementedError(f"{type(self).__name__} must define build or solve")
        return PreparedByFunction(self, scene, full)

    def solve(self, scene: Scene, full: bool = False, fields: Path | None = None) -> Run:
        """Prepare the scene and run it."""
        return self.prepare(scene, full).run(fields)

    def static(self, scene: Scene) -> Mapping[str, float]:
        """Return the static solution of a scene."""
        return self.prepare(scene).static()

    def modes(self, scene: Scene) -> tuple[Mode, ...]:
        """Return the modes of a scene."""
        return self.prepare(scene).modes()

    def diagnostics(self, scene: Scene) -> Mapping[str, float]:
        """Return the diagnostics of a scene."""
        return self.prepare(scene).diagnostics()

    def response(self, scene: Scene, frequencies: Array, exact: bool = False) -> Mapping[str, Complex]:
        """Return the frequency response of a scene."""
        return self.prepare(scene).response(frequencies, exact)


class NotInstalled(Prepared):
    """A scene for a solver that lacks a library or a program: it is NOT RUN, by name, and reports nothing."""

    has_fields = True  # what lacks is said, not that there are none

    def __init__(self, scene: Scene, reason: str) -> None:
        self.scene = scene
        self.reason = reason

    def history_run(self) -> Run:
        """Return the run that was not made, with what it lacks."""
        return Run(Outcome.NOT_RUN, notes=(self.reason,))

    def static(self) -> Mapping[str, float]:
        """Raise: nothing is reported."""
        raise NotReported(self.reason)

    def modes(self) -> tuple[Mode, ...]:
        """Raise: nothing is reported."""
        raise NotReported(self.reason)

    def diagnostics(self) -> Mapping[str, float]:
        """Raise: nothing is reported."""
        raise NotReported(self.reason)

    def amplitudes(self, frequencies: Array, exact: bool) -> Mapping[str, Complex]:
        """Raise: nothing is reported."""
        raise NotReported(self.reason)


class PreparedByFunction(Prepared):
    """A scene for a solver that is one function, with what else it overrides."""

    def __init__(self, solver: Solver, scene: Scene, full: bool) -> None:
        self.solver = solver
        self.scene = scene
        self.full = full
        for part in ("static", "modes", "diagnostics", "response"):
            if getattr(type(solver), part) is not getattr(Solver, part):
                setattr(self, part, partial(getattr(solver, part), scene))

    def run(self, fields: Path | None = None) -> Run:
        """Call the solver's function."""
        return self.solver.solve(self.scene, full=self.full, fields=fields)
