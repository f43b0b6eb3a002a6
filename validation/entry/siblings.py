"""Whether the packages of this distribution are those that Python finds, and no folder of the user's with such a name.

Nothing but the standard library is imported here: it is asked before anything else is.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

PACKAGES = ("validation", "dda", "fem_reference")
# The folder of all three: two or one above this file, which is in `validation.entry` or in `dda_validation`.
HOME = next(folder for folder in Path(__file__).resolve().parents if (folder / "fem_reference").is_dir())


def shadowed() -> str | None:
    """Return None, or the sentence on a folder or file that stands in the way of one of our packages."""
    for name in PACKAGES:
        location = _location(name)
        if location is not None and location != HOME / name:
            return (
                f"{location} is in the way of the package {name} of dda-validation, which is in {HOME}; "
                "rename it, or take its directory from PYTHONPATH and run from another one"
            )
    return None


def _location(name: str) -> Path | None:
    """Return the folder, or the file of a single module, that an import of a package takes; None where it fails."""
    spec = sys.modules[name].__spec__ if name in sys.modules else importlib.util.find_spec(name)
    if spec is None:
        return None
    # A folder without __init__.py counts: it hides a package that an editable install finds after Python's path.
    folders = spec.submodule_search_locations
    location = next(iter(folders), None) if folders is not None else spec.origin
    return None if location is None else Path(location).resolve()


def check() -> None:
    """Raise ImportError where a folder of the user's shadows one of our packages."""
    sentence = shadowed()
    if sentence is not None:
        raise ImportError(sentence)
