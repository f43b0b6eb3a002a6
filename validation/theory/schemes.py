"""The time schemes by name: what each is good and bad for, and which names stand for the same scheme."""

from __future__ import annotations

from typing import Any

from validation.runs.beside import table_beside

CARDS: dict[str, dict[str, Any]] = table_beside(__file__)
"""Parameters, order, solves, good, bad and aliases of each scheme, as the table beside this module has them."""
