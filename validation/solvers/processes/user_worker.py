"""The process in which a user's solver runs, see the command of `validation.solvers.user.UserSolver`.

A request holds a scene, an answer the history that the solver returned, with static solution and modes where it has
them, or the error "raised" and its place "at". One without a scene is answered with those of "parts" that the solver
has, and with what it says of itself under the names of "about".
"""

from __future__ import annotations

import importlib
import os
import sys
import sysconfig
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from validation.runs.history import History
from validation.runs.run import Run
from validation.scenes import features
from validation.scenes.scene import Scene, parse_scene
from validation.solvers.processes.worker import serve

FORMS = (
    "must return a History, a Run, a mapping of columns, (displacement, contact_pressure), "
    "(time, displacement, contact_pressure), or a table of these columns"
)
NAMES = ("time", "displacement", "contact_pressure")
ROOT = Path(__file__).parents[2]  # of this package
INSTALLED = {sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")}


def load(name: str) -> Any:
    """Import what ``module:attribute`` names; a class is made into an object."""
    module, _, attribute = name.partition(":")
    target = importlib.import_module(module)
    for part in (attribute or "solve").split("."):
        target = getattr(target, part)
    return target() if isinstance(target, type) else target


def columns_of(value: Any) -> dict[str, Any]:
    """Return the columns of whatever a solver returned; a TypeError if it is none of the forms that are understood."""
    if isinstance(value, Run):
        value = value.history
    if isinstance(value, History):
        return {"time": value.time, **value.columns}
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] in (2, 3):
        value = tuple(value.T)
    if isinstance(value, tuple | list) and len(value) in (2, 3):
        return dict(zip(NAMES[-len(value) :], value, strict=True))
    raise TypeError(f"the solver {FORMS}, got {type(value).__name__}")


def plain(name: str, values: Any) -> list[Any]:
    """Return real numbers of any shape as lists.

    Raises
    ------
    TypeError
        They are complex numbers, texts or dates, which numpy would turn into other numbers without a word.
    """
    array = np.asarray(values)
    if array.dtype.kind not in "biufO":
        raise TypeError(f"{name} must hold real numbers, got an array of {array.dtype}")
    listed: list[Any] = array.astype(float).tolist()
    return listed


def text_of(error: BaseException) -> str:
    """Return what an error says, whatever it says it with."""
    try:
        return f"{type(error).__name__}: {error}"
    except BaseException as worse:  # __str__ may be anybody's code, too
        return f"{type(error).__name__}, whose text raises {type(worse).__name__}"


def place_of(error: BaseException, home: Path) -> str:
    """Return where the solver's own code raised an error, or called what did: ``file:line, in function``."""
    own_place = last_place = ""
    for frame, line in traceback.walk_tb(error.__traceback__):
        file = Path(frame.f_code.co_filename)
        if file.name.startswith("<") or file.is_relative_to(ROOT):
            continue
        path = file.relative_to(home) if file.is_relative_to(home) else file
        last_place = f"{path}:{line}, in {frame.f_code.co_name}"
        own_place = own_place if any(map(file.is_relative_to, INSTALLED)) else last_place
    return own_place or last_place


def optional(solver: Any, part: str, scene: Scene) -> Any:
    """Return what a solver reports beside its history, or None."""
    function: Callable[[Scene], Any] | None = getattr(solver, part, None)
    try:
        return None if function is None else function(scene)
    except (LookupError, NotImplementedError):  # NotReported among them
        return None


def run(solver: Any, request: Mapping[str, Any]) -> dict[str, Any]:
    """Run a scene and return the answer."""
    scene = parse_scene(request["scene"], "scene")
    unknown = [name for name in request["features"] if name not in getattr(solver, "handles", features.FIRST)]
    if unknown:
        return {"inapplicable": f"the solver does not state that it handles {', '.join(unknown)} (give it `handles`)"}
    try:
        solve = solver.solve if hasattr(solver, "solve") else solver
        columns = columns_of(solve(scene))
    except NotImplementedError as error:
        return {"inapplicable": f"the solver says that it is not made for this scene: {error}"}
    static = optional(solver, "static", scene)
    modes = optional(solver, "modes", scene) or ()
    return {
        "columns": {str(name): plain(str(name), values) for name, values in columns.items()},
        "static": None if static is None else {name: float(value) for name, value in static.items()},
        "modes": [[m.frequency, m.share, [[z.real, z.imag] for z in map(complex, m.eigenvalues)]] for m in modes],
    }


def answering(name: str) -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Return what answers requests with one solver, which the first of them imports."""
    loaded: list[Any] = []
    directory = os.getcwd()

    def answer(request: dict[str, Any]) -> dict[str, Any]:
        os.chdir(directory)  # which the last scene may have left
        try:
            if not loaded:
                loaded.append(load(name))
            if "scene" in request:
                return run(loaded[0], request)
            statements = getattr(loaded[0], "about", {})
            about = {name: str(statements[name]) for name in request["about"] if name in statements}
            return {"parts": [part for part in request["parts"] if hasattr(loaded[0], part)], "about": about}
        except BaseException as error:  # anybody's code: what ends it is the answer, and no end of this process
            return {"raised": text_of(error), "at": place_of(error, Path(directory))}

    return answer


def main(name: str, paths: list[str]) -> None:
    """Answer requests with one solver."""
    sys.path[:] = paths + [path for path in sys.path if path not in paths]
    serve(answering(name))
