"""Where the built-in scenes are: in the library, and in the folder ``scenes`` of each study."""

from __future__ import annotations

import functools
import importlib
from collections.abc import Mapping
from pathlib import Path

from validation.errors import InputError

LIBRARY = Path(__file__).parent / "library"
STUDIES = "validation.studies"


def study_directories() -> tuple[Path, ...]:
    """Return the directories that hold the folders of studies; a test adds one to the package's `__path__`."""
    return tuple(map(Path, importlib.import_module(STUDIES).__path__))


def scene_files() -> Mapping[str, Path]:
    """Return the files of the built-in scenes by name, in the order of their names; no study is imported.

    Raises InputError where two have one name.
    """
    return _scene_files(study_directories())


@functools.cache
def _scene_files(directories: tuple[Path, ...]) -> Mapping[str, Path]:
    paths = list(LIBRARY.glob("*.toml"))
    for directory in directories:
        paths += directory.glob("*/scenes/*.toml")
    files: dict[str, Path] = {}
    for path in sorted(paths, key=lambda path: (path.stem, path)):
        if path.stem in files:
            raise InputError(f"must not have the name of the scene {files[path.stem]}", source=path)
        files[path.stem] = path
    return files
