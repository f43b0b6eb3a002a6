"""The time schemes by name: what each is good and bad for, and which names stand for the same scheme."""

from __future__ import annotations

import tomllib
from pathlib import Path

from validation.runs.aliases import Fields

CARDS: dict[str, Fields] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
"""Parameters, order, solves, good, bad and aliases of each scheme, as the table beside this module has them."""
