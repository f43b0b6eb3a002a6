"""Cross-validation of Discontinuous Deformation Analysis: scenes, solvers, metrics, gates, studies, reports.

Nothing heavy is imported here: names are loaded when they are first used.
"""

from __future__ import annotations

import importlib
from typing import Any

_NAMES = {
    "History": "history",
    "Mode": "history",
    "Outcome": "history",
    "Run": "history",
    "Scene": "scene",
    "SceneError": "scene",
    "advise": "advice",
    "damping": "spectra",
    "load_scene": "scene",
    "solve": "solvers",
    "Solver": "solvers",
    "get_solver": "solvers",
}
__all__ = sorted(_NAMES)


def __getattr__(name: str) -> Any:
    if name not in _NAMES:
        raise AttributeError(f"module 'validation' has no attribute {name!r}")
    return getattr(importlib.import_module(f"validation.{_NAMES[name]}"), name)
