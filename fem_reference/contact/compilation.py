"""The kernel compiled by numba, where it is installed and a history is long enough to pay for that."""

from __future__ import annotations

import functools
import logging
import threading
from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np

from fem_reference.contact import kernel

LONG = 50_000
"""Number of steps from which on a history is stepped in natural modes, compiled: the first time that takes seconds."""
MESSAGE_DELAY = 2.0
"""Seconds of compiling before it is said; code that was kept is read in less."""
logger = logging.getLogger("fem_reference")
FUNCTIONS = {
    name: value
    for name, value in vars(kernel).items()
    if isinstance(value, FunctionType) and value.__module__ == kernel.__name__
}
"""Functions of the kernel."""


def march(modal: bool, steps: int) -> tuple[Callable[..., Any] | None, str]:
    """What is compiled of the kernel's march for a history, None where it runs as it stands; a note that says which.

    Parameters
    ----------
    modal
        Whether the block is known by its natural modes, in arrays.
    steps
        Number of steps.
    """
    if steps < LONG:
        return None, f"contact in plain Python: below {LONG:,} steps"
    if not modal:
        return None, "contact in plain Python: not in natural modes"
    # What stands in the place of one of the functions is no part of what is compiled.
    if any(getattr(kernel, name) is not function for name, function in FUNCTIONS.items()):
        return None, "contact in plain Python: a function of the kernel was replaced"
    return compiled()


@functools.cache
def compiled() -> tuple[Callable[..., Any] | None, str]:
    """March compiled, kept in a file where one can be written; as it stands, with the reason, where that fails."""
    try:
        import numba
    except ModuleNotFoundError:
        return None, "contact in plain Python: numba is not installed"
    except Exception as error:  # a numba that is too old for this Python or numpy
        return None, f"contact in plain Python: numba cannot be imported ({type(error).__name__})"
    reason = ""
    timer = threading.Timer(MESSAGE_DELAY, logger.warning, ["compiling the contact of the elements, once an install"])
    timer.daemon = True
    timer.start()
    for cache in (True, False):
        namespace = dict(vars(kernel))
        try:
            for name, function in FUNCTIONS.items():
                copy = FunctionType(function.__code__, namespace, name, function.__defaults__)
                copy.__module__ = kernel.__name__
                namespace[name] = numba.njit(copy, cache=cache, error_model="numpy")
            _warm(namespace["march"])
        except Exception as error:  # of any kind: a Python that numba does not know, a directory that is read-only
            reason = f"contact in plain Python: numba {numba.__version__} fails with {type(error).__name__}"
        else:
            timer.cancel()
            return namespace["march"], f"contact compiled by numba {numba.__version__}"
    timer.cancel()
    return None, reason


def _warm(march: Callable[..., Any]) -> None:
    """Compile for the types of a history, by one of no steps."""
    one = np.ones(1)
    square = np.ones((1, 1))
    arrays = (one, one, one, square, square, square, one, np.ones((3, 1)), one)
    numbers = [0.5] * (len(kernel.Block._fields) - len(arrays) - 1)
    block = kernel.Block._make([*arrays, *numbers, True])
    law = kernel.Law(square, one, one, 1.0, one, one, 1.0, 1, False)
    state = kernel.ContactState(
        one, one, one, one, one, one, one, one, np.ones(1, np.int8), one, np.zeros(kernel.TOTALS)
    )
    base = np.zeros((0, 1, 2))
    columns = np.zeros(1, dtype=np.int64)
    march((block,), (law,), state, base, columns, True, True, np.zeros((0, 1)), None)
