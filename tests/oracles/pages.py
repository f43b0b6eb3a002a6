"""Pages and files: code blocks of the documentation, gates that its pytest command runs in a test, tables."""

import csv
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```(\w+)(?: (?:file=|title=\")([^\s\"]+)\"?)?\n(.*?)^```$", re.M | re.S)
FEW = ["-q", "-p", "no:cacheprovider", "-k", "figures-3-4 and settling"]  # of some hundred gates


def write_my_solver(directory: Path) -> None:
    """Write the solver that the documentation shows."""
    page = (ROOT / "docs/judge.md").read_text(encoding="utf-8")
    files = {file: text for _, file, text in BLOCK.findall(page)}
    (directory / "my_solver.py").write_text(files["my_solver.py"])


def page_with(table: str, page: str, begin: str, end: str) -> str:
    """Return a page with a table in its place between two marks."""
    return re.sub(
        re.escape(begin) + ".*?" + re.escape(end), lambda _: f"{begin}\n{table}\n{end}", page, flags=re.DOTALL
    )


def table(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV table by the names of its columns."""
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))
