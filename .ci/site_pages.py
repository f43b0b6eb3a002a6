"""Hook of MkDocs: a page of reference for each room of the packages; pages that the navigation leaves out come last."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
PACKAGES = ("dda", "fem_reference", "validation")


def rooms(package: str) -> Iterator[str]:
    """Yield the dotted names of the rooms of a package."""
    yield from (f"{package}.{path.parent.name}" for path in sorted((ROOT / package).glob("*/__init__.py")))


def on_config(config: Any) -> None:
    """Append to the navigation: pages that it does not name, and the reference."""
    named = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    if more := [path.name for path in sorted((ROOT / "docs").glob("*.md")) if f" {path.name}\n" not in named]:
        config.nav.append({"More": more})
    pages: list[Any] = ["reference/index.md"]
    for package in PACKAGES:
        pages.append({package: [f"reference/{name}.md" for name in (package, *rooms(package))]})
    config.nav.append({"Reference": pages})


def on_files(files: Files, config: Any) -> None:
    """Add the pages: the names that a package exports, everything that is in a room."""
    for package in PACKAGES:
        for name in (package, *rooms(package)):
            whole = "true" if name != package else "false"
            text = f"# `{name}`\n\n::: {name}\n    options:\n      show_submodules: {whole}\n"
            files.append(File.generated(config, f"reference/{name}.md", content=text))
