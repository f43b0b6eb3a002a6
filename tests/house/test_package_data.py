"""What is no module but belongs to a package is declared as its data, else a wheel lacks it."""

from __future__ import annotations

import tomllib
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("dda", "fem_reference", "validation")


def package_of(path: Path) -> Path:
    """Return the innermost folder above a file that is a package."""
    return next(folder for folder in path.parents if (ROOT / folder / "__init__.py").is_file())


def test_each_data_file_is_declared():
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["package-data"]
    files: list[Path] = []
    for name in PACKAGES:
        files += [path.relative_to(ROOT) for path in (ROOT / name).rglob("*") if path.is_file()]
    files = [file for file in files if file.suffix != ".py" and "__pycache__" not in file.parts]
    missing = []
    for file in files:
        package = package_of(file)
        patterns = declared.get(".".join(package.parts), [])
        if not any(fnmatch(str(file.relative_to(package)), pattern) for pattern in patterns):
            missing.append(str(file))
    assert len(files) > 100
    assert missing == []
