"""Cross-validation of Discontinuous Deformation Analysis: scenes, solvers, metrics, gates, studies, reports.

Nothing heavy is imported here: names are loaded when they are first used.
"""

from __future__ import annotations

import importlib
from typing import Any

_NAMES = {
    "History": "runs.history",
    "InputError": "errors",
    "Mode": "runs.modes",
    "Outcome": "runs.run",
    "Run": "runs.run",
    "Scene": "scenes.scene",
    "SceneError": "errors",  # the name of InputError in version 0.1
    "Solver": "solvers.contract",
    "advise": "advice.advice",
    "damping": "advice.spectra",
    "get_solver": "solvers.registry",
    "load_scene": "scenes.scene",
    "response": "advice.response",
    "solve": "solvers.registry",
}
__all__ = sorted(_NAMES)


def __getattr__(name: str) -> Any:
    if name not in _NAMES:
        raise AttributeError(f"module 'validation' has no attribute {name!r}")
    from validation.entry.siblings import check

    check()
    return getattr(importlib.import_module(f"validation.{_NAMES[name]}"), name)
