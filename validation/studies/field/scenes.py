"""The scenes that the field runs: the problems, the same at fine steps, and those that the bands are computed from."""

from __future__ import annotations

import functools

from validation.diagnosis.numbers import accurate
from validation.problems.bands import changed_scenes
from validation.problems.problem import PREFIX, Problem, problem
from validation.scenes import features
from validation.scenes.scene import Scene, load_scene
from validation.suite.programs import ELEMENTS, HABIT, installed

# Problems of the pack that programs of the field are asked; their adapters state no contacts of columns.
FIELD_PROBLEMS = ("locked", "opening", "rebound", "sliding", "creep", "rocking", "column")
EXACT = "block-events"  # of the exact solutions the one that takes seconds, so that its motions are kept
FINER = 32  # steps in one of the scene's
FINER_TURNING = 4  # the same of a block that turns, which takes long
MOST_STEPS = 200  # of a scene that finite elements run at fine steps


@functools.cache
def scene_of(name: str) -> Scene:
    """Return the scene of a problem, read once."""
    return load_scene(PREFIX + name)


@functools.cache
def problem_named(name: str) -> Problem:
    """Return a problem, once."""
    return problem(name)


def fine_name(name: str) -> str:
    """Return the name of a problem's scene at fine steps."""
    return f"{PREFIX}{name}-fine"


def finer(scene: Scene) -> int:
    """Return how many of the fine steps make one of the scene's."""
    return FINER_TURNING if features.ROTATION in features.of(scene) else FINER


def kept_exact(scene: Scene) -> bool:
    """Whether the exact motions of a scene are cases of the study, which keeps them."""
    return EXACT in scene.run.solvers


def judged(name: str) -> Scene:
    """Return the scene of a problem with everything that is judged on it."""
    scene = scene_of(name)
    exact = (EXACT,) if kept_exact(scene) else ()
    return scene.with_values({"run.solvers": [HABIT, *exact, *installed()]})


def fine(name: str) -> Scene:
    """Return the scene of a problem with a scheme, a step and blocks that were chosen for accuracy."""
    scene = scene_of(name)
    times = finer(scene)
    values = accurate(scene) | {
        "time.step": scene.time.step / times,
        "time.steps": scene.time.steps * times,
        "run.solvers": [HABIT, *((ELEMENTS,) if with_elements(scene) else ())],
    }
    return scene.with_values(values).model_copy(update={"name": fine_name(name)})


def with_elements(scene: Scene) -> bool:
    """Whether finite elements take a problem in seconds."""
    slow = {features.FRICTION, features.ROTATION} & {*features.of(scene)}
    return not slow and scene.time.steps <= MOST_STEPS


@functools.cache
def changed(name: str) -> dict[str, Scene]:
    """Return the scenes whose exact motions set the bands of a problem: datum to scene."""
    scenes_by_datum = {}
    for datum, scene in changed_scenes(scene_of(name)).items():
        title = f"{PREFIX}{name} with {datum} one per cent larger"
        renamed = scene.model_copy(update={"name": title, "title": title})
        scenes_by_datum[datum] = renamed.with_values({"run.solvers": [EXACT]})
    return scenes_by_datum


def scenes() -> list[Scene]:
    """Return all scenes of the study."""
    all_scenes = []
    for name in FIELD_PROBLEMS:
        all_scenes += [judged(name), fine(name)]
        if kept_exact(scene_of(name)):
            all_scenes += changed(name).values()
    return all_scenes
