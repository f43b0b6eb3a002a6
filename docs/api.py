"""Write the API reference from the docstrings: ``python docs/api.py DIR``, one Markdown file a package.

Sources are read, not imported, so that optional parts need not be installed.
"""

import ast
import sys
from pathlib import Path

PACKAGES = ("dda", "fem_reference", "validation")
ROOT = Path(__file__).parents[1]
Definition = ast.FunctionDef | ast.ClassDef


def signature(node: Definition) -> str:
    """Return how a function is called, or of what a class is made."""
    if isinstance(node, ast.ClassDef):
        bases = ", ".join(map(ast.unparse, node.bases))
        return f"class {node.name}({bases})" if bases else f"class {node.name}"
    returned = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return f"{node.name}({ast.unparse(node.args)}){returned}"


def public(nodes: list[ast.stmt]) -> list[Definition]:
    """Return the public functions and classes among statements."""
    found = [node for node in nodes if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    return [node for node in found if not node.name.startswith("_")]


def entry(node: Definition, level: int) -> list[str]:
    """Return the lines of a function, or of a class with its methods."""
    text = ast.get_docstring(node) or ""
    lines = [f"{'#' * level} `{signature(node)}`", "", "```text", text, "```", ""]
    methods = public(node.body) if isinstance(node, ast.ClassDef) else []
    return lines + [line for method in methods for line in entry(method, level + 1)]


def reference(package: str) -> str:
    """Return the reference of a package."""
    lines = [f"# `{package}`", ""]
    for path in sorted((ROOT / package).glob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        found = public(tree.body)
        if found and not path.name.startswith("test_"):
            name = package if path.stem == "__init__" else f"{package}.{path.stem}"
            lines += [f"## `{name}`", "", "```text", ast.get_docstring(tree) or "", "```", ""]
            lines += [line for node in found for line in entry(node, 3)]
    return "\n".join(lines)


def main(directory: Path) -> None:
    """Write one file a package."""
    directory.mkdir(parents=True, exist_ok=True)
    for package in PACKAGES:
        (directory / f"{package}.md").write_text(reference(package), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
