"""What is checked of the columns that somebody's program gave: shape, units, signs, and whose they are."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from validation.errors import InputError
from validation.metrics.sameness import is_identical
from validation.metrics.values import norm
from validation.runs.columns import OF_BLOCK, unit_of
from validation.runs.history import DISPLACEMENT, PRESSURE, Array, History
from validation.runs.run import Outcome, Run
from validation.runs.units import ratios
from validation.scenes.scene import Scene
from validation.solvers.dda import DDA
from validation.solvers.translation import tension_note

FACTOR_TOLERANCE = 0.3  # a damped or badly resolved run has another size, but not by a factor of ten
FORCE_TOLERANCE = 0.02  # of the length of the base, and of the motion, which a force for a pressure leaves right
NEAR_ONE = 0.1  # m: on such a base force and pressure are one number
SAME_AS = "bit for bit the history of "  # how a note begins that names the suite's solver that answered
PROGRAM_STEPS = "program_steps"  # of an answer: how many steps the program made where a row takes several
LONGEST_NOTE = 400  # characters of what a user's solver says
LEAST_CORRELATION = 0.8  # correlation from which two histories are one but for their unit


def one_line(text: str) -> str:
    """Return a user's text as a short line of a note, without half characters and those that a terminal obeys."""
    line = " ".join(text.encode("utf-8", "backslashreplace").decode().split())[: LONGEST_NOTE + 1]
    escaped = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)
    return escaped if len(escaped) <= LONGEST_NOTE else f"{escaped[:LONGEST_NOTE]} ..."


def run_of_columns(scene: Scene, columns: dict[str, Array]) -> Run:
    """Return the run of columns, or the outcome that names what is wrong with them."""
    steps = scene.time.steps
    required = [DISPLACEMENT] if DISPLACEMENT in scene.run.columns else list(scene.run.columns)
    if not any(name in columns for name in required):
        names = one_line(", ".join(columns)) or "nothing"
        return Run(Outcome.WRONG_SHAPE, notes=(f"no column {' or '.join(required)}, got {names}",))
    expected = scene.time.step * np.arange(1, steps + 1, dtype=np.float64)
    time = columns.pop("time", expected)
    program_steps = columns.pop(PROGRAM_STEPS, np.array(float(steps)))
    columns = {name: values for name, values in columns.items() if name in (*OF_BLOCK, *scene.run.columns)}
    history = History(time, columns)
    for name, values in {"time": history.time, **columns}.items():
        if values.shape != (steps,):
            hint = " (step 0, the state at rest, is not reported)" if values.shape == (steps + 1,) else ""
            return Run(Outcome.WRONG_SHAPE, history, notes=(f"{name} has shape {values.shape}, not ({steps},){hint}",))
    notes: tuple[str, ...] = ()
    if all(np.isfinite(values).all() for values in (history.time, *columns.values())):
        reference = _reference(scene)
        wrong = _factor("time", history.time, expected)
        if wrong is None and reference is not None:
            wrong = next((words for _, words in differences(scene, history, reference)), None)
        if wrong is not None:
            return Run(Outcome.WRONG_UNITS, history, notes=(wrong,))
        if reference is not None and is_identical(history, reference):
            notes = (f"{SAME_AS}{DDA.name}",)
        if np.max(np.abs(history.time - expected)) > 1e-6 * scene.time.step * steps:
            return Run(Outcome.WRONG_SHAPE, history, notes=(f"time begins {history.time[:2]}, not {expected[:2]} s",))
    counted = program_steps.size == 1 and np.isfinite(program_steps).all()
    work = {"steps": int(program_steps.item()) if counted else steps}
    return Run(Outcome.COMPLETED, history, work, notes=(*notes, *tension_note(history)))


def differences(scene: Scene, history: History, reference: History) -> Iterator[tuple[str, str]]:
    """Yield the columns that are those of a reference, or begin where they do, in another unit or of another sign."""
    for name, values in history.columns.items():
        if name not in reference.columns:
            continue
        difference = _factor(name, values[: len(reference.time)], reference.columns[name])
        if difference is None and name == PRESSURE:
            difference = _force(scene, history, reference)
        if difference is not None:
            yield name, difference


def _force(scene: Scene, history: History, reference: History) -> str | None:
    """Say that the pressure is a force, if it is larger by the length of the base and the motion is as expected.

    With one spring in place of two, pressure and gap are larger by two: no force on a base of 2 m.
    """
    if DISPLACEMENT not in history.columns.keys() & reference.columns.keys():
        return None
    expected = reference.columns[DISPLACEMENT]
    size = norm(expected)
    if not (0 < size < math.inf and norm(history.columns[DISPLACEMENT] - expected) <= FORCE_TOLERANCE * size):
        return None
    block = scene.stated_block
    width = 1.0 if block is None else block.base_length
    likeness = _likeness(history.columns[PRESSURE], reference.columns[PRESSURE])
    if likeness is None or abs(width - 1) <= NEAR_ONE:
        return None
    ratio, correlation = likeness
    if correlation >= LEAST_CORRELATION and abs(ratio / width - 1) < FORCE_TOLERANCE:
        return f"wrong units: {PRESSURE} is {width:g} times what is expected, the length of the base: a force?"
    return None


def _likeness(values: Array, expected: Array) -> tuple[float, float] | None:
    """Return the ratio of the norms of a column and of what is expected, and their correlation; None where one is 0."""
    norms = norm(values), norm(expected)
    if min(norms) == 0 or not np.isfinite(norms).all():
        return None
    return norms[0] / norms[1], float((values / norms[0]) @ (expected / norms[1]))


def _reference(scene: Scene) -> History | None:
    """Return the built-in solution, None where there is none: nobody's answer is refused for that."""
    dda = DDA()
    try:
        return None if dda.refusal(scene) else dda.solve(scene.with_values({"time.allow_unstable": True})).history
    except InputError:
        return None


def _factor(name: str, values: Array, expected: Array) -> str | None:
    """Say by which known factor a column differs from what is expected, if by one."""
    likeness = _likeness(values, expected)
    if likeness is None or abs(likeness[1]) < LEAST_CORRELATION:
        return None
    ratio, correlation = likeness
    for other, unit in ratios("s" if name == "time" else unit_of(name)).items():
        if abs(ratio / other - 1) < FACTOR_TOLERANCE:
            return f"wrong units: {name} is {other:g} times what is expected in SI, {unit}?"
    if correlation < 0:
        return f"wrong sign: {name} is the negative of what is expected (downwards is negative, compression positive)"
    return None
