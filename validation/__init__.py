"""Cross-validation of Discontinuous Deformation Analysis: scenes, solvers, metrics, gates, studies, reports.

Nothing heavy is imported here: names are loaded when they are first used.
"""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from validation.advice.across import advise_across as advise_across
    from validation.advice.advice import advise as advise
    from validation.advice.response import response as response
    from validation.advice.spectra import damping as damping
    from validation.errors import InputError as InputError
    from validation.errors import PlausibilityWarning as PlausibilityWarning
    from validation.runs.history import History as History
    from validation.runs.modes import Mode as Mode
    from validation.runs.run import Outcome as Outcome
    from validation.runs.run import Run as Run
    from validation.scenes.scene import Scene as Scene
    from validation.scenes.scene import load_scene as load_scene
    from validation.solution import Solution as Solution
    from validation.solution import solve as solve
    from validation.solvers.contract import Solver as Solver
    from validation.solvers.registry import get_solver as get_solver

    __version__: str

_NAMES = {
    "History": "runs.history",
    "InputError": "errors",
    "Mode": "runs.modes",
    "Outcome": "runs.run",
    "PlausibilityWarning": "errors",
    "Run": "runs.run",
    "Scene": "scenes.scene",
    "Solution": "solution",
    "Solver": "solvers.contract",
    "advise": "advice.advice",
    "advise_across": "advice.across",
    "damping": "advice.spectra",
    "get_solver": "solvers.registry",
    "load_scene": "scenes.scene",
    "response": "advice.response",
    "solve": "solution",
}
# They warn of values that were probably not meant.
_OF_A_SCENE = ("advise", "advise_across", "damping", "response", "solve")
__all__ = sorted(_NAMES)


def __dir__() -> list[str]:
    """Return the public names."""
    return [*__all__, "__version__"]


def __getattr__(name: str) -> Any:
    """Load a public name, or the version of the installed distribution."""
    if name == "__version__":
        from importlib.metadata import version

        return version("dda-validation")
    if name not in _NAMES:
        raise AttributeError(f"module 'validation' has no attribute {name!r}")
    from validation.entry.siblings import check

    check()
    loaded = getattr(importlib.import_module(f"validation.{_NAMES[name]}"), name)
    return _warning(loaded) if name in _OF_A_SCENE else loaded


@functools.cache
def _warning(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of a scene that warns of the scene's implausible values before it runs."""

    @functools.wraps(function)
    def warned(scene: Any, *arguments: Any, **options: Any) -> Any:
        from validation.scenes.plausibility import warn_implausible

        warn_implausible(scene)
        return function(scene, *arguments, **options)

    warned.__module__ = __name__  # where pickle finds it, for who runs scenes in processes
    return warned
