"""The mark of tests that need the second finite-element code."""

from __future__ import annotations

import pytest

from validation.solvers.fenicsx import NEEDED, interpreter

ABSENT = pytest.mark.skipif(interpreter() is None, reason=f"fenicsx is NOT RUN: {NEEDED})")
