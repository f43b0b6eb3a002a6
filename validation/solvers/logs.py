"""What our solvers log: that they compile a loop, which takes seconds."""

from __future__ import annotations

import logging


def solver_logs() -> list[logging.Logger]:
    """Return what the packages of our solvers log to."""
    return [logging.getLogger(name) for name in ("dda", "fem_reference")]
