"""All that solvers answer to scenes with every term, and what is known of these before: numbers, kept in `answers.txt`.

A quantity is the sum of its values, each with a weight of its own: a step, a sign or a place that is another shows.
What is kept is a number for each part, of logarithms of its quantities: one that is another by 5e-5 of itself shows.
What a step that is shorter by 1e-11 of itself changes, or what is nothing beside other static values, is decided by
rounding, named behind a ~ and not judged.
`KEEP_PAGES=1` writes the file anew.
"""

import math
import os
import re
import time
import zlib
from dataclasses import asdict, is_dataclass
from pathlib import Path

import numpy as np
import pytest
from oracles.stand_ins import summed as logarithms
from oracles.stated_scenes import STATED, asked, made

from validation.advice.hooks import AdviceHooks
from validation.errors import InputError
from validation.models.plane import corner_springs
from validation.models.plane.boxes import boxes_of
from validation.models.plane.tables import PlaneSection
from validation.problems.problem import ProblemHooks
from validation.report.scene.hooks import ShowingHooks
from validation.runs.run import Outcome
from validation.scenes.plain import lines
from validation.scenes.plausibility import implausible_values
from validation.scenes.scene import load_scene
from validation.solvers import events, memory
from validation.solvers.contract import NotReported
from validation.solvers.fenicsx import request
from validation.solvers.registry import BUILT_IN, get_solver
from validation.solvers.soundness import reach

KEPT = Path(__file__).with_name("answers.txt")
MOST = 100  # values of what is given at steps
FREQUENCIES = np.array([3.0, 47.0])  # Hz
FIGURE = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?!\w)")
ASKED = dict(line.split(": ") for line in KEPT.read_text(encoding="utf-8").splitlines())


def numbers_of(name, value):
    """Yield the numbers in a value, those of a text too, by the names of its parts."""
    if is_dataclass(value):
        value = asdict(value)
    if isinstance(value, dict):
        for key, part in value.items():
            yield from numbers_of(f"{name}.{key}", part)
    elif isinstance(value, str):
        yield name, [float(figure) for figure in FIGURE.findall(value)]
    elif isinstance(value, (list, tuple)) and any(isinstance(part, str | dict) or is_dataclass(part) for part in value):
        parts = {}
        for part in value:
            for key, numbers in numbers_of(name, part):
                parts.setdefault(key, []).extend(numbers)
        yield from parts.items()
    elif value is not None:
        numbers = np.ravel(np.asarray(value))
        yield name, [*numbers.real.tolist(), *(numbers.imag.tolist() if np.iscomplexobj(numbers) else ())]


def scene_of(solver, name, directory):
    """Return a scene of `invariants.toml`, or the first steps of a built-in one, with the columns that a solver has."""
    scene = made(name, directory) if name in STATED else load_scene(name).expand()[0]
    if solver == "rigid-exact":
        scene = scene.with_values({"run.columns": list(boxes_of(scene).columns)})
    usual = 2 if solver.endswith("events") else 4 if name == "row of cells" else 12
    most = {"bar-events": 4, "rigid-exact": 100}.get(solver, usual)
    scene = scene.with_values({"time.steps": min(scene.time.steps, most)})
    if scene.fem.mesh is None:
        scene = scene.with_values({"fem.elements": 1 if "plate" in name else 2})
    return scene if "." in scene.run.columns[0] else asked(solver, scene)


def unless_refused(ask):
    try:
        return list(ask())
    except InputError:
        return []


def page(scene):
    """Yield the advice on contacts of blocks that move, and its words."""
    if scene.table(PlaneSection).moves:
        # a density of which nothing is rounded half up
        advice = corner_springs.moving_advice(scene.with_values({"plane.density": 1234.567}), 0.3)
        yield advice
        yield from corner_springs.lines(scene, "", advice)


def told(scene):
    """Return what the kind of a scene tells of it before anything is run, in numbers."""
    showing = ShowingHooks.of(scene)
    drawn = [left + right for left, right in showing.drawing(scene, 44)[1]]
    advice = AdviceHooks.of(scene)
    problem = unless_refused(lambda: lines(scene))
    names = zlib.crc32(" ".join(line.split()[0] for line in problem).encode())
    asked = {} if get_solver("fenicsx").refusal(scene) else request(scene)  # of another program
    facts = [*advice.motions(scene), advice.contact_limits(scene)]
    return {
        "drawn": zlib.crc32("\n".join(drawn).encode()),
        "shown": [number.value for number in showing.numbers(scene)],
        "springs": showing.springs([scene], lambda solver, metric: [0.7, -0.3]),
        "advice": [repr(fact) for fact in facts],
        "layers": unless_refused(lambda: advice.layers(scene)),
        "implausible": [value.sentence for value in implausible_values(scene)],
        "page": unless_refused(lambda: page(scene)),
        "problem": [*problem, str(names)],
        "asked": {name: repr(value) for name, value in asked.items()},
        "changed": repr(ProblemHooks.of(scene).changes(scene)),
    }


def answers(solver, scene, tells=True):
    """Return the numbers of all that a solver answers to a scene, and what is told of it before."""
    begin = time.perf_counter()
    adapter = get_solver(solver)
    prepared = adapter.prepare(scene)
    prepared.keeps_contact_record = True
    run = prepared.run()
    assert run.outcome is Outcome.COMPLETED, run.notes
    assert 0 <= sum(run.seconds.values()) <= time.perf_counter() - begin
    whole = {
        "memory": memory.needed(scene, adapter)[0],
        "reach": reach(scene),
        **(told(scene) if tells else {}),
        "history": {"time": run.history.time, **run.history.columns},
        "run": [dict(run.work), *run.notes, run.estimate or 0.0],
    }
    for part, ask in {
        "limit": prepared.highest_frequency,
        "static": prepared.static,
        "assumed": prepared.assumed_static,
        "modes": lambda: [mode for mode in prepared.modes() if abs(mode.share) > 1e-6],  # the others have no order
        "diagnostics": prepared.diagnostics,
        "response": lambda: prepared.response(FREQUENCIES),
        "exact": lambda: prepared.response(FREQUENCIES, exact=True),
        "switches": prepared.switches,
        "record": prepared.contact_record,
    }.items():
        try:
            whole[part] = ask()
        except (NotReported, InputError):
            whole[part] = None
    return {name: summed(numbers) for part, value in whole.items() for name, numbers in numbers_of(part, value)}


def summed(numbers):
    """Return the sum of weighted values; of samples between the steps, whose number is free, that of three of them."""
    if len(numbers) > MOST:
        numbers = [max(numbers), min(numbers), numbers[-1]]
    return float(np.array(numbers, float) @ (1 + 0.4 * np.cos(np.arange(1, len(numbers) + 1))))


def in_parts(found, rounding):
    """Return a number for each part of what is answered, of which names that are rounding are left out."""
    parts = {}
    for name, value in found.items():
        if name not in rounding:
            parts.setdefault(name.partition(".")[0], []).append(value)
    return {part: logarithms(values) for part, values in parts.items()}


def written(solver, scene, tells):
    """Return answers as they are kept: numbers of parts, and the names of what is rounding."""
    shorter = answers(solver, scene.with_values({"time.step": scene.time.step * (1 - 1e-11)}), tells)
    found = answers(solver, scene, tells)
    assert found.keys() == shorter.keys()
    forces = max([abs(value) for name, value in found.items() if name.startswith("static.")], default=0.0)
    rounding = [
        name
        for name, value in found.items()
        if not math.isclose(value, shorter[name], rel_tol=1e-8)
        or (name.startswith("static.") and 0 < abs(value) < 1e-14 * forces)
    ]
    return " ".join(
        [*(f"{value:.5f}".rstrip("0").rstrip(".") for value in in_parts(found, rounding).values()), "~", *rounding]
    )


def keep():
    KEPT.write_text("".join(f"{key}: {line}\n" for key, line in ASKED.items()), encoding="utf-8")


@pytest.mark.parametrize("pair", [pair for pair in ASKED if " " in pair])
@np.errstate(all="ignore")
def test_solvers_answer_as_before(pair, tmp_path, monkeypatch):
    monkeypatch.setattr(events, "LEAST_SAMPLES", 40)
    solver, _, name = pair.partition(" ")
    scene = scene_of(solver, name, tmp_path)
    tells = pair == next(key for key in ASKED if key.endswith(f" {name}"))  # of each scene once
    if os.environ.get("KEEP_PAGES"):
        ASKED[pair] = written(solver, scene, tells)
        keep()
    found = answers(solver, scene, tells)
    numbers, _, rounding = ASKED[pair].partition("~")
    parts = in_parts(found, rounding.split())
    kept = dict(zip(parts, map(float, numbers.split()), strict=True))
    assert {part: value for part, value in parts.items() if abs(value - kept[part]) > 2e-5} == {}, found


def test_solvers_are_declared_as_before():
    declared = {}
    for name in BUILT_IN:
        solver = get_solver(name)
        line = vars(solver.line).values() if solver.line else ()
        flags = (solver.cached, solver.distributed, solver.meshed, solver.saves, len(solver.columns() or ()))
        declared[name] = " ".join(map(str, [solver.role.name, solver.rank, *line, *flags]))
    if os.environ.get("KEEP_PAGES"):
        ASKED.update(declared)
        keep()
    assert declared == {name: ASKED[name] for name in BUILT_IN}
