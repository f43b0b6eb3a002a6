"""Finite-element and exact-bar references for a block on a locked elastic foundation.

The finite-element names load scikit-fem when they are first used; `fem_reference.bar` never does.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fem_reference.motion import Motion
from fem_reference.problem import Problem, Scheme
from fem_reference.result import COLUMNS, Mode, Result

if TYPE_CHECKING:
    from fem_reference.bar import Bar, applicable
    from fem_reference.eigen import highest_frequency, modes
    from fem_reference.model import assemble
    from fem_reference.solver import solve, static

_HOMES = {
    "Bar": "bar",
    "applicable": "bar",
    "assemble": "model",
    "highest_frequency": "eigen",
    "modes": "eigen",
    "solve": "solver",
    "static": "solver",
}

__all__ = [
    "COLUMNS",
    "Bar",
    "Mode",
    "Motion",
    "Problem",
    "Result",
    "Scheme",
    "applicable",
    "assemble",
    "highest_frequency",
    "modes",
    "solve",
    "static",
]


def __getattr__(name: str) -> Any:
    """Import a public name from its module when it is first asked for."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
