"""A scene with a column whose contacts open or slip: what may be changed in it, its runs, its readings."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from validation.diagnosis import families
from validation.diagnosis.answer import Answer
from validation.diagnosis.beside import Candidate, RunVerdict, SceneSearch, answer_of, verdict_of
from validation.diagnosis.constants import DISCOUNTS, ROUNDS, UNBOUNDED, UNITS
from validation.diagnosis.numbers import Values, contacts, fixed, layers, places
from validation.diagnosis.one_change import of_discount, of_numbers, of_schemes
from validation.diagnosis.other_solvers import STARTS
from validation.diagnosis.reading import Foreign, Stepping, steppings
from validation.diagnosis.readings import slips, without_slips
from validation.errors import InputError
from validation.metrics.contact import SHIFT
from validation.runs.history import DISPLACEMENT, PRESSURE, Array
from validation.runs.numbers import ROUNDING
from validation.scenes.drive import motion_at
from validation.scenes.scene import Scene
from validation.solvers.columns.names import column_of

if TYPE_CHECKING:
    from dda.bodies.column_history import ColumnResult

LEAST_LIMIT = 2  # given: solves of a step in which a contact changes, the second of which confirms it
PARTS = (2, 4)  # steps of a program in one of the scene's
BONDED = "bonded"  # among the values of a change, no key of scenes: contacts carry tension and never slip


# ---- candidates ----


def of_scene(scene: Scene) -> Iterator[Candidate]:
    """Yield everything that may be changed in a scene with such a column."""
    yield from of_schemes(scene)
    for parts in PARTS:
        words = f"the program makes {parts} steps in one of the scene's"
        yield fixed("substeps", words, {"time.step": scene.time.step / parts}, float(parts))
    yield from laws(scene)
    yield from of_numbers(scene, (*STARTS, *UNITS), units=False)
    yield of_discount(scene, DISCOUNTS)


def laws(scene: Scene) -> Iterator[Candidate]:
    """Yield what a program may have forgotten, reversed, or put in place of the contacts' law."""
    column = column_of(scene)
    stated = scene.definition()
    has_velocity = any(layer.velocity for layer in column.layer)
    if column.gravity and column.law == "unilateral":
        unloaded: Values = {"column.gravity": 0.0}
        if column.settled:
            unloaded["column.settled"] = False
        if scene.stated_input is not None or has_velocity:
            yield fixed("gravity-factor", "the weight is forgotten", unloaded, 0.0)
        if column.settled:
            words = "the column starts unstrained, its weight put on at once"
            yield fixed("settled", words, {"column.settled": False})
        elif column.base in ("rigid", "springs") and not any(contact.gap for contact in column.contacts):
            words = "the column starts at rest under its weight, not unstrained"
            yield fixed("settled", words, {"column.settled": True})
    for place, where in places(scene, "gap").items():
        gap = contacts("gap", place)
        yield fixed("gap-factor", f"the gap of {where} is forgotten", gap(scene, 0.0), 0.0)
        words = f"{where} is never reached: it is not there, or its gap is wide"
        yield fixed("contact-missing", words, gap(scene, UNBOUNDED))
    if column.law == "unilateral":
        yield fixed("contact-locked", "the contacts carry tension", {BONDED: True})
    elif any(math.isfinite(contact.strength) for contact in column.contacts):
        yield fixed("no-slip", "the contacts do not slip", {BONDED: True})
        free = contacts("strength")(scene, ROUNDING)
        free |= contacts("friction")(scene.with_values(free), ROUNDING)
        yield fixed("no-friction", "there is no friction", free)
    if any(math.isfinite(contact.stiffness) for contact in column.contacts):
        joints = stated["column"].get("joint", [])
        rigid: Values = {"column.joint": [joint | {"stiffness": math.inf} for joint in joints], BONDED: True}
        if column.stiffness is not None:
            rigid["column.stiffness"] = math.inf
        yield fixed("contact-welded", "the contacts are welded: their faces move alike", rigid)
    given = stated["input"] if scene.stated_input is not None else {}
    reversed_input = {f"input.{key}": -given[key] for key in ("velocity", "pressure") if given.get(key)}
    if reversed_input:
        yield fixed("load-factor", "the input acts the other way", reversed_input, -1.0)
    for words, factor in (("reversed", -1.0), ("forgotten", 0.0)) if has_velocity else ():
        yield fixed("velocity-factor", f"the starting velocity is {words}", layers("velocity")(scene, factor), factor)


# ---- runs ----


class ColumnSearch(SceneSearch):
    """The search beside runs of a column."""

    NAMES = (DISPLACEMENT, PRESSURE)
    WOULD_TELL = "the rows up to the first switch with every step, or a run with one contact"

    def candidates(self) -> Iterator[Candidate]:
        """Yield everything that may be changed in the scene."""
        return of_scene(self.scene)

    def solved(self, values: Values, steps: int, is_shifted: bool) -> Array | None:
        """Return displacement and pressure of a change, densities larger by `SHIFT` where it is shifted."""
        result = self.result(values, steps, is_shifted)
        return None if result is None else np.array([result.columns[name] for name in self.NAMES])

    def result(self, values: Values, steps: int, is_shifted: bool = False) -> ColumnResult | None:
        """Return what a change gives at the first steps of the history; None where there is no such run."""
        from dda.bodies.column_history import ColumnOptions, solve_column
        from dda.bodies.column_march import Drive
        from validation.solvers.columns.blocks import dda_column
        from validation.solvers.dda import scheme_of

        is_bonded = BONDED in values
        try:
            scene = self.scene.with_values({key: value for key, value in values.items() if key != BONDED})
            if is_shifted:
                scene = scene.with_values(layers("density")(scene, 1 + SHIFT))
            section = column_of(scene)
            column = dda_column(section)
            if is_bonded:
                column = replace(column, joints=[replace(joint, gap=0.0) for joint in column.joints])
            steps *= round(self.scene.time.step / scene.time.step)
            drive = Drive(**vars(motion_at(scene, scene.time.step * np.arange(steps + 1.0))))
            options = ColumnOptions(None, section.settled, bonded=is_bonded, repeats=len(self.changes) * ROUNDS)
            result = solve_column(column, scheme_of(scene), drive, list(self.NAMES), (), options)
        except (InputError, ArithmeticError, ValueError):
            return None
        return result if len(result.time) == steps else None


# ---- the verdict ----


def compare_column(scene: Scene, foreign: Foreign, tolerance: float = 0.0) -> Answer:
    """Judge a history against a scene with a column whose contacts open or slip, as `validation.diagnosis.compare`.

    Raises
    ------
    InputError
        The times are not uniform, or the scene does not run at the steps of the history.
    """
    uniform = [stepping for stepping in steppings(foreign, scene.time.step) if np.ptp(stepping.steps) == 0]
    if not uniform:
        raise InputError("the times of the history are not uniform, which a column needs", source=scene.name)
    searches = [search for stepping in uniform for search in searches_of(scene, foreign, stepping)]
    fewest = min(len(search.reading.corrected) for search in searches)
    plain = [search for search in searches if len(search.reading.corrected) == fewest]
    own = [search for search in searches if search.is_scene(tolerance)]
    as_read = next((search for search in own if search in plain), None)
    if as_read is not None:
        verdict = RunVerdict(as_read, True)
    else:
        verdicts = [verdict_of(search, search.explanations()) for search in plain]
        verdict = next((verdict for verdict in verdicts if verdict.explained or verdict.alike), verdicts[0])
        if own and not (verdict.explained or verdict.alike):
            verdict = RunVerdict(own[0], True)
        elif own:
            values = {name: value for name, value in verdict.causes.items() if value is not None}
            further = {"further_scene": families.BESIDE_GRAVITY}
            alike = verdict.alike or [{"causes": list(verdict.causes), "values": values} | further]
            of_reading = {"causes": list(own[0].reading.slips), "values": {}} | further
            verdict = replace(verdict, explained=False, alike=[*alike, of_reading])
    (search,) = (search for search in searches if search is verdict.search)
    return answer_of(foreign, verdict, notes=_notes(search, scene))


def searches_of(scene: Scene, foreign: Foreign, stepping: Stepping) -> list[ColumnSearch]:
    """Return the ways to read signs and units, each beside the scene's own run."""
    reading = without_slips(foreign, stepping)
    stepped = reading.scene_of(scene)
    scene_run = ColumnSearch(stepped, reading).scene_run
    readings = slips(foreign, stepping, scene_run[0], scene_run[-1])
    return [ColumnSearch(stepped, reading) for reading in readings]


def _notes(search: ColumnSearch, scene: Scene) -> list[str]:
    """Return what there is to know of limits of solves beside the verdict."""
    notes: list[str] = []
    steps = len(search.reading.stepping.steps)
    result = search.result({}, steps + 1)
    if result is None:
        return notes
    limit = column_of(scene).solve_limit
    solves = result.step_solves
    if limit and np.max(solves[:steps]) > limit:
        step = np.argmax(solves > limit) + 1
        notes.append(f"the scene's own limit of {limit} solves ends its run at step {step}: it was left out")
    needed = int(solves[-1])
    is_first = needed > max(int(np.max(solves[:steps])), LEAST_LIMIT)
    same_step = search.reading.stepping.steps[0] == scene.time.step
    if is_first and same_step and steps < scene.time.steps and not len(search.departing):
        notes.append(
            f"the file ends at step {steps} of {scene.time.steps}; the next step is the first that needs {needed} "
            f"solves of the open-close iteration: a limit of {needed - 1} ends a run there"
        )
    return notes
