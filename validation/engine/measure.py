"""The execution of a case: solve, check, measure."""

from __future__ import annotations

import gc
import math
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import Any, TypeVar

import numpy as np

from validation.engine import horizon, origin, stability
from validation.engine.case import Case
from validation.engine.cluster import worker_memory
from validation.errors import InputError
from validation.metrics.catalogue import CONTACT, DIAGNOSTICS, MODES, STATIC, SWITCHES, measured_by, solo
from validation.metrics.measurable import Measurable
from validation.runs.history import History
from validation.runs.modes import Mode
from validation.runs.results import WITH_HISTORY
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
INSTANTS = 4000  # at most, at which an exact motion is kept beside its steps
INSTANTS_OF_STEP = 20  # at most, in one of them
LEAST_TOTAL = 0.004  # s of all repeats of a timed case: of many short runs one is not interrupted


def execute(case: Case, key: str, study: str) -> tuple[Row, History | None]:
    """Run a case, whose row is kept under `key` for a study; whatever happens in it ends as a named outcome.

    Returned are the row with the metrics of the run itself, and the history where there is one.
    """
    try:
        with one_thread():
            return _executed(case, key, study)
    except Exception as error:  # of one case, which must not end the others
        return failed_row(case, key, study, error_text(error)), None


def failed_row(case: Case, key: str, study: str, note: str) -> Row:
    """Return the row of a case that ended by an error."""
    provenance = origin.of_row(case.make_solver())
    return Row(key, study, case.scene.name, case.solver, Outcome.RAISED, {}, notes=(note,), provenance=provenance)


def _executed(case: Case, key: str, study: str) -> tuple[Row, History | None]:
    solver = case.make_solver()
    scene = case.scene
    own_metrics = measured_by({*case.measures, "switches"}, case.only)
    reads_contact = any(CONTACT in metric.needs for metric in own_metrics)
    prepared, run = attempt(solver, scene, case.full, contact_record=reads_contact)
    run = checked(run, scene)
    failed: list[str] = []
    metrics: dict[str, Value] = {}
    spread: dict[str, Value] = {}
    if case.repeats and run.outcome is Outcome.COMPLETED:
        run, spread["seconds.spread"] = timed(run, solver, case)
    if prepared is not None:
        if scene.time.allow_unstable and features.linear(scene):
            run = stability.with_growth_outcome(run, prepared, scene)
        with np.errstate(all="ignore"):
            metrics = _measure(prepared, solver, case, run, failed)
    estimate = run.estimate
    if estimate is not None and not math.isfinite(estimate):
        estimate = None
    row = Row(
        key=key,
        study=study,
        scene=scene.name,
        solver=case.solver,
        outcome=run.outcome,
        metrics=metrics | spread,
        work=dict(run.work),
        seconds={k: round(v, 6) for k, v in run.seconds.items()},
        notes=tuple(map(printable, (*run.notes, *failed))),
        estimate=estimate,
        provenance=origin.of_row(solver),
    )
    row.line()  # what cannot be kept is found here
    if run.history is None or run.outcome not in WITH_HISTORY:
        return row, None
    between = _between(solver, case) if case.only is None else None  # reports draw it, and no metric is made of it
    return row, replace(_requested_columns(run.history, scene), between=between)


def _between(solver: Solver, case: Case) -> History | None:
    """Return an exact motion at more instants than few steps show it at, None where it is stepped or there are enough.

    A discount per step is taken as one per part of it, so that the rate remains.
    """
    time = case.scene.time
    parts = min(INSTANTS_OF_STEP, INSTANTS // time.steps)
    if solver.role not in EXACT_IN_TIME or parts < 2:
        return None
    values = {"time.step": time.step / parts, "time.steps": time.steps * parts}
    if time.gg_rate is None and time.discount != 1:
        values["time.gg"] = time.discount ** (1 / parts)
    scene = case.scene.with_values(values)
    run = checked(attempt(solver, scene, case.full)[1], scene)
    if run.history is None or run.outcome is not Outcome.COMPLETED:
        return None
    return _requested_columns(run.history, scene)


def _requested_columns(history: History, scene: Scene) -> History:
    """Return a history with the columns that the scene asks for and no others, which nobody has checked."""
    return History(history.time, {name: x for name, x in history.columns.items() if name in scene.run.columns})


def columns_of(case: Case) -> tuple[str, ...]:
    """Return the columns that the history of a completed case holds."""
    return tuple(_narrowed(case.make_solver(), case.scene)[0].run.columns)


def timed(run: Run, solver: Solver, case: Case) -> tuple[Run, float]:
    """Return a run with its least seconds and the lines of Python that it takes, and the spread of its seconds.

    Seconds are the processor's, which other processes do not take, of a scene that is prepared and run: of these the
    stepping has the share that the solver says by the clock, all the rest is set-up. What takes less than `LEAST_TOTAL`
    is repeated more often than the case asks for.
    """
    lines = lines_of(lambda: solver.solve(case.scene, case.full))
    timings: list[tuple[float, float]] = []  # seconds of the processor, and the share of the stepping
    while len(timings) < case.repeats or sum(total for total, _ in timings) < LEAST_TOTAL:
        began = time.perf_counter()
        start = time.process_time()
        stepping = solver.solve(case.scene, case.full).seconds.get("stepping", 0.0)
        total = time.process_time() - start
        timings.append((total, stepping / (time.perf_counter() - began)))
    least, share = min(timings)
    seconds = {"setup": (1 - share) * least, "stepping": share * least}
    return replace(run, seconds=seconds, work={**run.work, "lines": lines}), max(timings)[0] - least


def lines_of(action: Callable[[], object]) -> int:
    """Return how many lines of Python an action executes, which no clock and no other process changes.

    Garbage is collected before and after, not within: what others left behind may run lines of its own on its way out.
    """
    count = 0

    def trace(frame: FrameType, event: str, argument: object) -> Callable[..., Any]:
        nonlocal count
        count += event == "line"
        return trace

    before = sys.gettrace()
    collects = gc.isenabled()
    gc.disable()
    sys.settrace(trace)
    try:
        action()
    finally:
        sys.settrace(before)
        if collects:
            gc.enable()
    return count


@np.errstate(all="ignore")  # what overflows is named by `checked`, not warned of
def attempt(
    solver: Solver,
    scene: Scene,
    full: bool,
    fields: Path | None = None,
    contact_record: bool = False,
    watch: Callable[[Prepared], None] | None = None,
) -> tuple[Prepared | None, Run]:
    """Prepare and run a scene without a sweep, and turn the solver's errors into outcomes.

    Parameters
    ----------
    full
        Switch the numerical savings off.
    fields
        File for displacement and stress fields.
    contact_record
        Keep what metrics of contact are measured from, energies included.
    watch
        Takes the prepared scene before it is run, to say how long it takes and to show its progress.

    Returns
    -------
    The prepared scene, None where the solver did not come so far, and the run.
    """
    prepared: Prepared | None = None
    try:
        if reason := solver.refusal(scene):
            return None, Run(Outcome.NOT_APPLICABLE, notes=(reason,))
        memory.check(scene, solver, worker_memory())
        narrowed_scene, absent = _narrowed(solver, scene)
        notes = (f"not reported: {', '.join(absent)}",) if absent else ()
        prepared = solver.prepare(narrowed_scene, full)
        if contact_record:  # a user's own class may be frozen
            prepared.keeps_contact_record = True
        if watch is not None:
            watch(prepared)
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


def completed(
    solver: Solver,
    scene: Scene,
    full: bool = False,
    fields: Path | None = None,
    watch: Callable[[Prepared], None] | None = None,
) -> Run:
    """Return the checked run of a scene, whatever its outcome; the parameters are those of `attempt`."""
    with one_thread():
        return checked(attempt(solver, scene, full, fields, watch=watch)[1], scene)


def _narrowed(solver: Solver, scene: Scene) -> tuple[Scene, list[str]]:
    """Return the scene with the columns that a solver has, and the others; the scene itself where it has none."""
    solver_columns = solver.columns()
    absent = [name for name in scene.run.columns if solver_columns is not None and name not in solver_columns]
    if not absent or len(absent) == len(scene.run.columns):
        return scene, []
    return scene.with_values({"run.columns": [name for name in scene.run.columns if name not in absent]}), absent


def _measure(prepared: Prepared, solver: Solver, case: Case, run: Run, failed: list[str]) -> dict[str, Value]:
    """Metrics of the run itself; of its history none where that is not sound. What fails beside it is noted."""
    measures = set(case.measures)
    if run.history is None or run.outcome is not Outcome.COMPLETED:
        measures -= {"history", "modes", "energy"}
    if run.outcome in (Outcome.NOT_APPLICABLE, Outcome.REFUSED):
        measures -= {"stability"}
    contacts = {features.UNILATERAL, *features.OF_MOVING_COLUMN}
    if "history" in measures and contacts & set(features.of(case.scene)):
        measures |= {"switches"}
        if case.make_solver().role not in EXACT_IN_TIME:  # those have so many digits that nothing is amplified
            measures |= {"horizon"}
    parts = measures if "history" in measures else measures - {"modes"}
    needs = frozenset[str]().union(*(metric.needs for metric in measured_by(parts, case.only)))
    if not features.linear(case.scene):  # statics, modes and diagnostics are of linear models
        needs -= {STATIC, MODES, DIAGNOSTICS}
    static = _reported("static", prepared.static, None, failed) if STATIC in needs else None
    assumed_static: Mapping[str, float] = static or {}
    if static is None and STATIC in needs:
        assumed_static = prepared.assumed_static()
    modes: tuple[Mode, ...] = _reported("modes", prepared.modes, (), failed) if MODES in needs else ()
    diagnostics: Mapping[str, float] = {}
    if DIAGNOSTICS in needs:
        diagnostics = _reported("diagnostics", prepared.diagnostics, {}, failed)
    switches = _reported("switches", prepared.switches, None, failed) if SWITCHES in needs else None
    contact_record = _reported("contact_record", prepared.contact_record, None, failed) if CONTACT in needs else None
    measurable = Measurable(
        run.history or History(np.zeros(0), {}),
        case.scene.time.step,
        assumed_static,
        modes,
        static is not None,
        diagnostics,
        run.outcome,
        switches,
        contact_record,
        lambda: horizon.shadow(solver, case.scene, case.full),
        lambda: stability.limit(solver, case.scene),
    )
    metrics: dict[str, Value] = {}
    for part in sorted(parts):
        try:
            metrics |= solo(measurable, (part,), case.only)
        except Exception as error:  # numbers at the edge of the range, of which a library makes an error
            failed.append(f"{part} not measured: {error_text(error)}")
    return metrics


def _reported(name: str, part: Callable[[], Part], absent: Part, failed: list[str]) -> Part:
    """Return what a solver reports beside its history, or what stands for its absence."""
    try:
        return part()
    except NotReported:
        return absent
    except Exception as error:  # anybody's code, as in `attempt`; the history is sound and is kept
        failed.append(f"{name} not reported: {error_text(error)}")
        return absent
