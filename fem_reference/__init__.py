"""Finite-element and exact-bar references for a block on a locked elastic foundation.

The finite-element names load scikit-fem when they are first used; `fem_reference.exact.bar` never does. Data that are
out of their range, or do not go together, are a `ValueError` that names field, rule and value.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from fem_reference.problem.motion import Motion
from fem_reference.problem.problem import Problem, Scheme
from fem_reference.problem.result import COLUMNS, Mode, Result
from fem_reference.problem.schemes.catalogue import SCHEMES, named_scheme

if TYPE_CHECKING:
    from fem_reference.contact.columns import UNILATERAL_COLUMNS
    from fem_reference.contact.points import Friction
    from fem_reference.exact.bar import Bar, applicable
    from fem_reference.history.adaptive import ADAPTIVE_COLUMNS
    from fem_reference.history.solver import solve, static
    from fem_reference.history.unilateral import Unilateral, UnilateralResult, solve_unilateral
    from fem_reference.mesh.model import assemble
    from fem_reference.plane.body import PlaneBody
    from fem_reference.plane.contact import PatchContact
    from fem_reference.plane.model import BodiesResult, PlaneModel
    from fem_reference.scheme.eigen import highest_frequency, modes

_HOMES = {
    "ADAPTIVE_COLUMNS": "history.adaptive",
    "Bar": "exact.bar",
    "BodiesResult": "plane.model",
    "Friction": "contact.points",
    "PatchContact": "plane.contact",
    "PlaneBody": "plane.body",
    "PlaneModel": "plane.model",
    "applicable": "exact.bar",
    "assemble": "mesh.model",
    "highest_frequency": "scheme.eigen",
    "modes": "scheme.eigen",
    "solve": "history.solver",
    "static": "history.solver",
    "UNILATERAL_COLUMNS": "contact.columns",
    "Unilateral": "history.unilateral",
    "UnilateralResult": "history.unilateral",
    "solve_unilateral": "history.unilateral",
}

__all__ = [
    "ADAPTIVE_COLUMNS",
    "COLUMNS",
    "SCHEMES",
    "UNILATERAL_COLUMNS",
    "Bar",
    "BodiesResult",
    "Friction",
    "Mode",
    "Motion",
    "PatchContact",
    "PlaneBody",
    "PlaneModel",
    "Problem",
    "Result",
    "Scheme",
    "Unilateral",
    "UnilateralResult",
    "applicable",
    "assemble",
    "highest_frequency",
    "modes",
    "named_scheme",
    "solve",
    "solve_unilateral",
    "static",
]


def __getattr__(name: str) -> Any:
    """Import a public name from its module when it is first asked for."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value
