"""Whether the packages of this distribution are those that Python finds, and no folder of the user's with such a name.

Nothing but the standard library is imported here: it is asked before anything else is.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

PACKAGES = ("dda", "fem_reference")
HOME = Path(__file__).resolve().parents[1]  # of all three packages


def shadowed() -> str | None:
    """Return None, or the sentence on a folder or file that stands in the way of one of our packages."""
    for name in PACKAGES:
        origin = _origin(name)
        if origin is not None and origin.parents[1] != HOME:
            other = origin.parent if origin.name == "__init__.py" else origin
            return (
                f"{other} is in the way of the package {name} of dda-validation, which is in {HOME}; "
                "rename it, or take its directory from PYTHONPATH and run from another one"
            )
    return None


def _origin(name: str) -> Path | None:
    """Return the file that an import of a package takes, None where there is none."""
    if name in sys.modules:
        file = getattr(sys.modules[name], "__file__", None)
    else:
        spec = importlib.util.find_spec(name)
        file = None if spec is None else spec.origin
    return None if file is None else Path(file).resolve()


def check() -> None:
    """Refuse to go on with packages that are not ours.

    Raises
    ------
    ImportError
        A folder of the user's shadows one of them.
    """
    sentence = shadowed()
    if sentence is not None:
        raise ImportError(sentence)
