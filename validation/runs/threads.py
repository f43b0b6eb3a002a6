"""One BLAS thread a process, unless the user's environment says otherwise.

The matrices here are small: a second thread of BLAS waits for the first in a loop that takes a core from the worker
processes, and costs a factor of four on a quiet machine and of ten on a busy one. A process of ours is told by its
environment before numpy loads; in somebody else's (a Python session, a test run, a worker of a cluster) the libraries
that are loaded are limited while we calculate, and then left as they were.
"""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

# What OpenBLAS, MKL, BLIS and Accelerate read; one of them that is set is the user's word.
VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "GOTO_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
)
ONE_THREAD = {"OMP_NUM_THREADS": "1", "VECLIB_MAXIMUM_THREADS": "1"}  # the first is read by all but the last library


def user_decides() -> bool:
    """Whether the environment says how many threads BLAS takes."""
    return any(os.environ.get(name) for name in VARIABLES)


def environment() -> dict[str, str]:
    """Return the environment of a process that we start."""
    return dict(os.environ) if user_decides() else {**os.environ, **ONE_THREAD}


def limit_process() -> None:
    """Limit this process, which is ours, and those that it starts, for good."""
    if user_decides():
        return
    os.environ.update(ONE_THREAD)
    if "numpy" in sys.modules:  # forked from a process that has numpy, which reads the environment no more
        loaded_libraries().limit(limits=1, user_api="blas")


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit BLAS to one thread while something is calculated in a process that may be somebody else's."""
    if user_decides():
        yield
        return
    with loaded_libraries().limit(limits=1, user_api="blas"):
        yield


@functools.cache
def loaded_libraries() -> ThreadpoolController:
    """Return the BLAS libraries of numpy and SciPy, which load one each."""
    import scipy.linalg  # noqa: F401 - a library that loads later would come with all its threads
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
