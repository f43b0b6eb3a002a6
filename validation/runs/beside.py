"""Tables that stand beside the modules that read them."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any


def table_beside(module: str | Path, name: str = "") -> dict[str, Any]:
    """Return a TOML file in the folder of a module, by its name, or that of the module's own name."""
    path = Path(module).with_name(name) if name else Path(module).with_suffix(".toml")
    return tomllib.loads(path.read_text(encoding="utf-8"))
