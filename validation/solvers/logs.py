"""What our solvers log: that they compile a loop, which takes seconds."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager


def solver_logs() -> list[logging.Logger]:
    """Return what the packages of our solvers log to."""
    return [logging.getLogger(name) for name in ("dda", "fem_reference")]


@contextmanager
def errors_only() -> Iterator[None]:
    """Log errors alone, and afterwards what was logged before: a run is part of the process that asks for it."""
    levels = [log.level for log in solver_logs()]
    for log in solver_logs():
        log.setLevel(logging.ERROR)
    try:
        yield
    finally:
        for log, level in zip(solver_logs(), levels, strict=True):
            log.setLevel(level)
