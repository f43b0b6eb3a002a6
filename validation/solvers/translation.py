"""What every adapter needs: results into runs, refusals with the scene's name, columns that are known."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validation.errors import InputError
from validation.runs.history import PRESSURE, Array, History
from validation.runs.modes import Mode, Switch
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene


def to_run(scene: Scene, result: Any, columns: Mapping[str, Array] | None = None, built: float = 0.0) -> Run:
    """Translate the `Result` of a solver package; the two packages share no class, only the names of the fields.

    A result of contact that opens has an outcome, by which a history may have ended early. `columns` are values at each
    step where they are not the result's, of which those are kept that the scene asks for; `built` is the time that was
    spent on the model before [s].
    """
    values = result.columns if columns is None else columns
    history = History(result.time, {name: values[name] for name in scene.run.columns})
    work = {name: int(getattr(result, name)) for name in ("unknowns", "nonzeros", "factorisations", "solves")}
    work["steps"] = len(result.time)
    seconds = {"setup": built + result.setup_seconds, "stepping": result.stepping_seconds}
    outcome = getattr(result, "outcome", None)
    notes = result.notes
    if outcome is None and scene.kind.locks_contact:
        notes = (*notes, *tension_note(history))
    return Run(Outcome(outcome or "completed"), history, work, seconds, notes, getattr(result, "estimate", None))


def scheme_of(scene: Scene, package: Any) -> Any:
    """Return the scheme of a scene as a solver package states it: both state it by the same names."""
    t = scene.time
    d = scene.damping
    if t.scheme == "newmark":
        return package.Scheme(t.alpha, t.delta, t.discount, t.step, t.start, d.mass, d.stiffness)
    numbers = {"step": t.step, "gg": t.discount, "start": t.start, "rho_inf": t.rho_inf, "split": t.split}
    with naming(scene):
        return package.named_scheme(t.scheme, **numbers)


def to_modes(modes: Iterable[Any]) -> tuple[Mode, ...]:
    """Translate modes; of their eigenvalues the two greatest count, a third is zero."""
    translated = []
    for mode in modes:
        first, second = (complex(value) for value in mode.eigenvalues[:2])
        translated.append(Mode(mode.frequency, mode.share, (first, second)))
    return tuple(translated)


def switches_between_steps(states: Mapping[str, NDArray[Any]], time: Array, slips: bool = False) -> tuple[Switch, ...]:
    """Return the switches of contacts from step to step, in the order of time.

    States by the name of a contact are 0 or False where it is closed or sticks, others where it is open or, of `slips`,
    slips; they and the times of the steps [s] have the shape (steps,).
    """
    switches = []
    for name, values in states.items():
        for n in np.flatnonzero(np.diff(values)) + 1:
            is_free = bool(values[n])
            instant = float(time[n])
            switches.append(Switch(instant, name, None, is_free) if slips else Switch(instant, name, is_free))
    return tuple(sorted(switches, key=lambda switch: switch.time))


@contextmanager
def naming(scene: Scene) -> Iterator[None]:
    """Give what a solver package refuses, a ValueError, the name of the scene: an InputError."""
    try:
        yield
    except (InputError, np.linalg.LinAlgError):  # a factor that fails is no refusal
        raise
    except ValueError as error:
        raise InputError(str(error), source=scene.name) from None


def tension_note(history: History) -> tuple[str, ...]:
    """A locked contact hides tension: say where it carries tension."""
    pressure = history.columns.get(PRESSURE)
    if pressure is None or not np.all(np.isfinite(pressure)) or not np.any(pressure < 0):
        return ()
    least = int(np.argmin(pressure))
    return (f"the locked contact carries tension: {pressure[least]:.4g} Pa at t = {history.time[least]:.4g} s",)


def check_columns(scene: Scene, solver_columns: tuple[str, ...]) -> None:
    """Refuse columns that a solver does not have by an `InputError`."""
    unknown = [name for name in scene.run.columns if name not in solver_columns]
    if unknown:
        raise InputError(
            f"must be among {', '.join(solver_columns)}",
            source=scene.name,
            field="run.columns",
            value=repr(unknown[0]),
        )
