"""The execution of a case: solve, check, measure."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from validation.engine.case import Case
from validation.errors import InputError
from validation.metrics.catalogue import solo
from validation.metrics.columns import Measurable
from validation.runs.history import History
from validation.runs.results import Row
from validation.runs.run import Outcome, Run
from validation.scenes.scene import Scene
from validation.solvers import memory, stability
from validation.solvers.contract import NotReported, Solver


def execute(case: Case, key: str, study: str) -> tuple[Row, History | None]:
    """Run a case; whatever a solver does ends as a named outcome.

    Returns
    -------
    The row with the metrics of the run itself, and the history where there is one.
    """
    solver = case.make_solver()
    run = _repeated(check(attempt(solver, case.scene, case.full), case.scene), solver, case)
    if case.scene.time.allow_unstable:
        run = stability.named(run, solver, case.scene)
    failed: list[str] = []
    with np.errstate(all="ignore"):
        measured = _measure(solver, case, run, failed)
    row = Row(
        key=key,
        study=study,
        scene=case.scene.name,
        solver=case.solver,
        outcome=run.outcome,
        metrics=measured,
        work=dict(run.work),
        seconds={k: round(v, 6) for k, v in run.seconds.items()},
        notes=(*run.notes, *failed),
        estimate=run.estimate if run.estimate is not None and math.isfinite(run.estimate) else None,
    )
    return row, run.history if run.outcome is Outcome.COMPLETED or run.outcome is Outcome.UNSTABLE else None


def _repeated(run: Run, solver: Solver, case: Case) -> Run:
    """Return the run with the least seconds of its repeats, each part apart, and their spread."""
    if not case.repeats or run.outcome is not Outcome.COMPLETED:
        return run
    timings = [attempt(solver, case.scene, case.full).seconds for _ in range(case.repeats)]
    sums = [sum(timing.values()) for timing in timings]
    least = {part: min(timing[part] for timing in timings) for part in timings[0]}
    spread = f"least seconds of {case.repeats} repeats, spread {max(sums) - min(sums):.1g} s"
    return replace(run, seconds=least, notes=(*run.notes, spread))


def attempt(solver: Solver, scene: Scene, full: bool, fields: Path | None = None) -> Run:
    """Call a solver and turn its errors into outcomes."""
    try:
        if reason := solver.applicable(scene):
            return Run(Outcome.NOT_APPLICABLE, notes=(reason,))
        memory.check(scene, solver.name)
        asked, absent = _columns(solver, scene)
        notes = (f"not reported: {', '.join(absent)}",) if absent else ()
        with np.errstate(all="ignore"):  # what overflows is named by `check`, not warned of
            run = solver.solve(asked, full=full, fields=fields)
        return replace(run, notes=(*run.notes, *notes))
    except InputError as error:
        return Run(Outcome.REFUSED, notes=(str(error),))
    except Exception as error:  # a solver may be anybody's code: its failure is a row, not the end of the study
        return Run(Outcome.RAISED, notes=(f"{type(error).__name__}: {error}",))


def _columns(solver: Solver, scene: Scene) -> tuple[Scene, list[str]]:
    """Return the scene with the columns that a solver has, and the others; the scene itself where it has none."""
    known = solver.columns()
    absent = [name for name in scene.run.columns if known is not None and name not in known]
    if not absent or len(absent) == len(scene.run.columns):
        return scene, []
    return scene.with_values({"run.columns": [name for name in scene.run.columns if name not in absent]}), absent


def check(run: Run, scene: Scene) -> Run:
    """Check a run's history against its scene; a defect replaces the outcome."""
    if run.history is None or run.outcome is not Outcome.COMPLETED:
        return run
    steps = scene.time.steps
    for name in ("time", *scene.run.columns):
        values = run.history.time if name == "time" else run.history.columns.get(name)
        if values is None:
            continue
        if np.shape(values) != (steps,):
            return _failed(run, Outcome.WRONG_SHAPE, f"{name} has shape {np.shape(values)}, not ({steps},)")
        if np.isnan(values).any():
            return _failed(run, Outcome.NOT_A_NUMBER, f"{name} at step {int(np.argmax(np.isnan(values))) + 1}")
        if np.isinf(values).any():
            return _failed(run, Outcome.OVERFLOW, f"{name} at step {int(np.argmax(np.isinf(values))) + 1}")
    return run


def _failed(run: Run, outcome: Outcome, note: str) -> Run:
    return Run(outcome, run.history, run.work, run.seconds, (*run.notes, note), run.estimate)


def _measure(solver: Solver, case: Case, run: Run, failed: list[str]) -> dict[str, Any]:
    """Metrics of the run itself; of its history none where that is not sound. What fails beside it is noted."""
    scene, measured = case.scene, dict[str, Any]()
    if "history" in case.measures and run.history is not None and run.outcome is Outcome.COMPLETED:
        static = _reported(solver.static, scene, None, failed)
        assumed = solver.assumed_static(scene) if static is None else static
        modes = _reported(solver.modes, scene, (), failed) if "modes" in case.measures else ()
        seen = Measurable(run.history, scene.time.step, assumed, modes, static is not None)
        measured = solo(seen, "modes" in case.measures)
    if "stability" in case.measures and run.outcome not in (Outcome.NOT_APPLICABLE, Outcome.REFUSED):
        measured |= stability.measure(solver, scene, run)
    if "energy" in case.measures and run.outcome is Outcome.COMPLETED:
        measured[stability.DRIFT] = stability.drift(solver, scene, run)
    if "limit" in case.measures:
        measured[stability.LIMIT] = stability.limit(solver, scene)
    return measured


def _reported(part: Callable[[Scene], Any], scene: Scene, absent: Any, failed: list[str]) -> Any:
    """Return what a solver reports beside its history, or what stands for its absence."""
    try:
        return part(scene)
    except NotReported:
        return absent
    except Exception as error:  # anybody's code, as in `attempt`; the history is sound and is kept
        failed.append(f"{part.__name__} not reported: {type(error).__name__}: {error}")
        return absent
