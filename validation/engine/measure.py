"""The execution of a case: solve, check, measure."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from validation.engine import horizon, origin, stability
from validation.engine.case import Case
from validation.errors import InputError
from validation.metrics.catalogue import CONTACT, DIAGNOSTICS, MODES, STATIC, SWITCHES, measured_by, solo
from validation.metrics.measurable import Measurable
from validation.runs.history import History
from validation.runs.results import KEPT
from validation.runs.row import Row, Value
from validation.runs.run import Outcome, Run
from validation.runs.text import error_text, printable
from validation.runs.threads import one_thread
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers import memory
from validation.solvers.contract import EXACT_IN_TIME, NotReported, Prepared, Solver
from validation.solvers.soundness import checked

Part = TypeVar("Part")


def execute(case: Case, key: str, study: str) -> tuple[Row, History | None]:
    """Run a case; whatever happens in it ends as a named outcome.

    Returns
    -------
    The row with the metrics of the run itself, and the history where there is one.
    """
    try:
        with one_thread():
            return _executed(case, key, study)
    except Exception as error:  # of one case, which must not end the others
        return failed_row(case, key, study, error_text(error)), None


def failed_row(case: Case, key: str, study: str, note: str) -> Row:
    """Return the row of a case that ended by an error."""
    made = origin.of_row(case.make_solver())
    return Row(key, study, case.scene.name, case.solver, Outcome.RAISED, {}, notes=(note,), provenance=made)


def _executed(case: Case, key: str, study: str) -> tuple[Row, History | None]:
    solver, scene = case.make_solver(), case.scene
    prepared, run = attempt(solver, scene, case.full)
    run = _repeated(checked(run, scene), solver, case)
    failed: list[str] = []
    measured: dict[str, Value] = {}
    if prepared is not None:
        if scene.time.allow_unstable:
            run = stability.named(run, prepared, scene)
        with np.errstate(all="ignore"):
            measured = _measure(prepared, solver, case, run, failed)
    row = Row(
        key=key,
        study=study,
        scene=scene.name,
        solver=case.solver,
        outcome=run.outcome,
        metrics=measured,
        work=dict(run.work),
        seconds={k: round(v, 6) for k, v in run.seconds.items()},
        notes=tuple(map(printable, (*run.notes, *failed))),
        estimate=run.estimate if run.estimate is not None and math.isfinite(run.estimate) else None,
        provenance=origin.of_row(solver),
    )
    row.line()  # what cannot be kept is found here
    return row, _asked(run.history, scene) if run.outcome in KEPT else None


def _asked(history: History | None, scene: Scene) -> History | None:
    """Return a history with the columns that the scene asks for and no others, which nobody has checked."""
    if history is None:
        return None
    return History(history.time, {name: x for name, x in history.columns.items() if name in scene.run.columns})


def columns_of(case: Case) -> tuple[str, ...]:
    """Return the columns that the history of a completed case holds."""
    return tuple(_narrowed(case.make_solver(), case.scene)[0].run.columns)


def _repeated(run: Run, solver: Solver, case: Case) -> Run:
    """Return the run with the least seconds of its repeats, each part apart, and their spread."""
    if not case.repeats or run.outcome is not Outcome.COMPLETED:
        return run
    timings = [attempt(solver, case.scene, case.full)[1].seconds for _ in range(case.repeats)]
    sums = [sum(timing.values()) for timing in timings]
    least = {part: min(timing[part] for timing in timings) for part in timings[0]}
    spread = f"least seconds of {case.repeats} repeats, spread {max(sums) - min(sums):.1g} s"
    return replace(run, seconds=least, notes=(*run.notes, spread))


@np.errstate(all="ignore")  # what overflows is named by `checked`, not warned of
def attempt(solver: Solver, scene: Scene, full: bool, fields: Path | None = None) -> tuple[Prepared | None, Run]:
    """Prepare and run a scene, and turn the solver's errors into outcomes; what was prepared, None if nothing was."""
    prepared: Prepared | None = None
    try:
        if reason := solver.refusal(scene):
            return None, Run(Outcome.NOT_APPLICABLE, notes=(reason,))
        memory.check(scene, solver)
        asked, absent = _narrowed(solver, scene)
        notes = (f"not reported: {', '.join(absent)}",) if absent else ()
        prepared = solver.prepare(asked, full)
        run = prepared.run(fields)
        return prepared, replace(run, notes=(*run.notes, *notes))
    except InputError as error:
        return prepared, Run(Outcome.REFUSED, notes=(str(error),))
    except OSError as error:
        if fields is None:
            return prepared, Run(Outcome.RAISED, notes=(error_text(error),))
        return prepared, Run(Outcome.REFUSED, notes=(f"--fields: cannot be written: {error.strerror or error}",))
    except Exception as error:  # a solver may be anybody's code: its failure is a row, not the end of the study
        return prepared, Run(Outcome.RAISED, notes=(error_text(error),))


def completed(solver: Solver, scene: Scene, full: bool = False, fields: Path | None = None) -> Run:
    """Return the checked run of a scene, whatever its outcome."""
    with one_thread():
        return checked(attempt(solver, scene, full, fields)[1], scene)


def _narrowed(solver: Solver, scene: Scene) -> tuple[Scene, list[str]]:
    """Return the scene with the columns that a solver has, and the others; the scene itself where it has none."""
    known = solver.columns()
    absent = [name for name in scene.run.columns if known is not None and name not in known]
    if not absent or len(absent) == len(scene.run.columns):
        return scene, []
    return scene.with_values({"run.columns": [name for name in scene.run.columns if name not in absent]}), absent


def _measure(prepared: Prepared, solver: Solver, case: Case, run: Run, failed: list[str]) -> dict[str, Value]:
    """Metrics of the run itself; of its history none where that is not sound. What fails beside it is noted."""
    parts = _measures(case, run)
    needs = frozenset[str]().union(*(metric.needs for metric in measured_by(parts, case.only)))
    linear, history = features.linear(case.scene), run.history or History(np.zeros(0), {})
    static = _reported(prepared.static, None, failed) if linear and STATIC in needs else None
    assumed = prepared.assumed_static() if linear and static is None and STATIC in needs else static or {}
    seen = Measurable(
        history,
        case.scene.time.step,
        assumed,
        _reported(prepared.modes, (), failed) if linear and MODES in needs else (),
        static is not None,
        _reported(prepared.diagnostics, {}, failed) if linear and DIAGNOSTICS in needs else {},
        run.outcome,
        _reported(prepared.switches, None, failed) if SWITCHES in needs else None,
        _reported(prepared.contact_record, None, failed) if CONTACT in needs else None,
        lambda: horizon.shadow(solver, case.scene, case.full),
        lambda: stability.limit(solver, case.scene),
    )
    return _solo(seen, parts, case.only, failed)


def _solo(seen: Measurable, parts: set[str], only: Collection[str] | None, failed: list[str]) -> dict[str, Value]:
    """Return the metrics of the parts that are asked for; a part whose arithmetic fails is noted and has none."""
    found: dict[str, Value] = {}
    for part in sorted(parts):
        try:
            found |= solo(seen, (part,), only)
        except Exception as error:  # numbers at the edge of the range, of which a library makes an error
            failed.append(f"{part} not measured: {error_text(error)}")
    return found


def _measures(case: Case, run: Run) -> set[str]:
    """Return the parts of the study's measures that this run has."""
    asked = set(case.measures)
    if run.history is None or run.outcome is not Outcome.COMPLETED:
        asked -= {"history", "modes", "energy"}
    if run.outcome in (Outcome.NOT_APPLICABLE, Outcome.REFUSED):
        asked -= {"stability"}
    if "history" in asked and features.UNILATERAL in features.of(case.scene):
        asked |= {"switches"}
        if case.make_solver().role not in EXACT_IN_TIME:  # those have so many digits that nothing is amplified
            asked |= {"horizon"}
    return asked if "history" in asked else asked - {"modes"}


def _reported(part: Callable[[], Part], absent: Part, failed: list[str]) -> Part:
    """Return what a solver reports beside its history, or what stands for its absence."""
    try:
        return part()
    except NotReported:
        return absent
    except Exception as error:  # anybody's code, as in `attempt`; the history is sound and is kept
        failed.append(f"{part.__name__} not reported: {error_text(error)}")
        return absent
