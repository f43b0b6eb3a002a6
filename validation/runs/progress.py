"""Who is told how far work is."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[int, int, str], None]
"""Is told what has been done, of how much, and what is next."""
