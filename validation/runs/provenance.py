"""Where results come from: versions, commit, processor, seeds."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
import tomllib
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

PACKAGES = ("dda-validation", "numpy", "scipy", "scikit-fem", "meshio", "pydantic", "matplotlib", "typst")
ROOM = Path(__file__).parent


def provenance() -> dict[str, Any]:
    """Return versions, commit, processor, cores, seeds and date of this run."""
    return {
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
        "commit": _commit(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "seeds": "none: no random numbers enter a result",
        "date": datetime.date.today().isoformat(),
    }


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _commit() -> str:
    """Return the commit of the sources; "+" marks changes that are not committed.

    A checkout of another project that this package lies in, as in a virtual environment there, says nothing of it.
    """
    top = _git("rev-parse", "--show-toplevel")
    if top is None or not _is_source_root(Path(top)):
        return "unknown (not a git checkout)"
    return _git("describe", "--always", "--abbrev=12", "--dirty=+") or "unknown (no commit yet)"


def _is_source_root(top: Path) -> bool:
    """Whether a directory is the root of this distribution's sources, these among them."""
    try:
        project = tomllib.loads((top / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        return project["name"] == PACKAGES[0] and ROOM.samefile(top / "validation" / "runs")
    except (OSError, ValueError, LookupError, TypeError):
        return False


def _git(*words: str) -> str | None:
    """Return what git says in the directory of the sources, None where it says nothing."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    try:
        process = subprocess.run(
            ["git", *words], cwd=ROOM, env=environment, capture_output=True, text=True, timeout=5, check=True
        )
    except (OSError, ValueError, subprocess.SubprocessError):  # a path that is no text is a ValueError
        return None
    return process.stdout.strip() or None


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next(
        (line.partition(":")[2].strip() for line in lines if line.startswith("model name")),
        platform.machine(),
    )
