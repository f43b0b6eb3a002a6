"""The march compiled by numba, where it is installed and a history is long enough to pay for that."""

from __future__ import annotations

import functools
import hashlib
import logging
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np

from fem_reference.contact import iteration, law
from fem_reference.contact import march as steps_of_march
from fem_reference.contact.stepper import ContactStepper
from fem_reference.contact.system import ContactSystem, opening_rows
from fem_reference.problem.problem import Scheme
from fem_reference.scheme import stage
from fem_reference.scheme.stage import Motion

LONG = 50_000
"""Steps from which on a history is stepped in natural modes, compiled: the first time that takes seconds."""
PLAIN = ("fall_back", "singly", "only_contact", "step_change", "held_change", "part_of")
"""Functions that no history compiles."""
APART = (
    "march",
    "equations_of",
    "solution",
    "agreed",
    "add_losses",
    "newmark_loss",
    "balance_loss",
    "thrown",
)
"""Functions that are called, and not part of what calls them: an argument costs as much as a small product."""
MESSAGE_DELAY = 2.0
"""Seconds of compiling before it is said; code that was kept is read in less."""
logger = logging.getLogger("fem_reference")
MODES = 2500
"""Most unknowns that a long history steps in natural modes: their shapes are a full matrix."""
MODULES = (stage, law, iteration, steps_of_march)
FUNCTIONS = {
    (module.__name__, name): value
    for module in MODULES
    for name, value in vars(module).items()
    if isinstance(value, FunctionType) and value.__module__ == module.__name__ and name not in PLAIN
}
"""Functions that are compiled, by the module and the name."""


def prepared(
    system: ContactSystem, steps: int, full: bool = False
) -> tuple[ContactSystem, Callable[..., Any] | None, tuple[str, ...]]:
    """A system for so many steps, in natural modes where they are many and not `full`; the march compiled; notes."""
    unknowns = len(system.F)
    modal = not full and system.C is None and unknowns <= MODES and steps >= LONG
    run = None
    if steps < LONG:
        note = f"contact in plain Python: below {LONG:,} steps"
    elif not modal:
        note = "contact in plain Python: not in natural modes"
    # What stands in the place of one of the functions is no part of what is compiled.
    elif any(getattr(sys.modules[module], name) is not function for (module, name), function in FUNCTIONS.items()):
        note = "contact in plain Python: a function of the step was replaced"
    else:
        run, note = compiled()
    if not modal:
        return system, run, (note,)
    return system.in_modes(), run, (f"stepped in its {unknowns} natural modes", note)


@functools.cache
def compiled() -> tuple[Callable[..., Any] | None, str]:
    """March compiled, kept in a file where one can be written; as it stands, with the reason, where that fails."""
    try:
        import numba
    except ModuleNotFoundError:
        return None, "contact in plain Python: numba is not installed"
    except Exception as error:  # a numba that is too old for this Python or numpy
        return None, f"contact in plain Python: numba cannot be imported ({type(error).__name__})"
    timer = threading.Timer(MESSAGE_DELAY, logger.warning, ["compiling the contact of the elements, once an install"])
    timer.daemon = True
    timer.start()
    # What was kept is found by the name and the stamp of one file: the name tells all files apart.
    files = [__file__, *(str(module.__file__) for module in MODULES)]
    sources = b"".join(Path(file).read_bytes() for file in files)
    digest = hashlib.sha256(sources).hexdigest()[:12]
    for cache in (True, False):
        # The modules see each other's functions under one name each.
        namespace = {name: value for module in MODULES for name, value in vars(module).items()}
        try:
            for (module, name), function in FUNCTIONS.items():
                copy = FunctionType(function.__code__, namespace, name, function.__defaults__)
                copy.__module__ = module
                copy.__qualname__ = f"{name}_{digest}"
                inline = name not in APART
                namespace[name] = numba.njit(copy, cache=cache, error_model="numpy", forceinline=inline)
            _warm(namespace["march"])
        except Exception as error:  # of any kind: a Python that numba does not know, a directory that is read-only
            reason = f"contact in plain Python: numba {numba.__version__} fails with {type(error).__name__}"
        else:
            timer.cancel()
            return namespace["march"], f"contact compiled by numba {numba.__version__}"
    timer.cancel()
    return None, reason


def _warm(march: Callable[..., Any]) -> None:
    """Compile for the types of a history, by one of a step."""
    one = np.ones(1)
    square = np.ones((1, 1))
    system = ContactSystem(
        M=one,
        K=one,
        F=one,
        B=square,
        rows=opening_rows(one),
        watch=Motion(square, square, square),
        pushes=square,
        ground=square,
        prescribed=lambda positions, times: np.zeros((*times.shape, 1)),
        start_parts=one,
        motions=(square,),
        to_modes=square,
    )
    stepper = ContactStepper(system, Scheme(0.5, 1.0, 1.0, 1.0), compiled=march)
    stepper.march(stepper.start(one, one, np.zeros(1, dtype=np.int8)), stepper.record(1))
