"""Libraries that extras of the distribution bring, and the sentence where one is absent.

What imports one of these libraries names it here first, so that its absence is a sentence before anything is computed.
"""

from __future__ import annotations

import importlib.util

from validation.errors import InputError

DISTRIBUTION = "dda-validation"
# The extra that brings a library, by the name of its import.
EXTRA_OF = {
    "jinja2": "report",
    "markupsafe": "report",
    "matplotlib": "report",
    "typst": "report",
    "flint": "exact",
    "h5py": "mesh",
    "meshio": "mesh",
}
PROJECTS = {"flint": "python-flint"}  # whose distribution has another name than its import
PDF = ("matplotlib", "typst")
SITE = ("jinja2", "markupsafe", "matplotlib")
FIGURES = ("matplotlib",)
EXACT = ("flint",)
MESH = ("meshio",)


def install(extra: str) -> str:
    """Return the command that installs an extra."""
    return f"pip install '{DISTRIBUTION}[{extra}]'"


def is_installed(library: str) -> bool:
    """Whether Python finds a library; it is not imported."""
    try:
        return importlib.util.find_spec(library) is not None
    except (ImportError, ValueError):  # an importer of the environment's own may raise, a library half loaded has none
        return False


def missing(*libraries: str) -> str | None:
    """Return None, or which of some libraries are absent and how to get them, in one line."""
    absent = [library for library in libraries if not is_installed(library)]
    return sentence(*absent) if absent else None


def sentence(*libraries: str) -> str:
    """Return what to install for libraries that are absent."""
    *first, last = (PROJECTS.get(library, library) for library in libraries)
    projects = f"{', '.join(first)} and {last}" if first else last
    extras = ",".join(dict.fromkeys(EXTRA_OF[library] for library in libraries))
    return f"needs {projects}, not installed: {install(extras)}"


def require(subject: str, *libraries: str) -> None:
    """Raise InputError, with the command to install it, where an option, page or function lacks a library."""
    if reason := missing(*libraries):
        raise InputError(reason, field=subject)
