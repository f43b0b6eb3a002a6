"""Pages and files: code blocks of the documentation, gates that its pytest command runs in a test, tables."""

import csv
import re
import shutil
import textwrap
from pathlib import Path

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```(\w+)(?: (?:file=|title=\")([^\s\"]+)\"?)?\n(.*?)^```$", re.M | re.S)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
FEW = ["-q", "-p", "no:cacheprovider", "-k", "figures-3-4 and settling"]  # of some hundred gates


def write_my_solver(directory):
    """Write the solver that the documentation shows."""
    shutil.copy(ROOT / "docs/examples/judge/my_solver.py", directory)


def summary(counts, words):
    """Return a paragraph: how many histories had each verdict, and of each kind how many were named right.

    ``counts`` are of (kind, verdict), ``words`` what the paragraph calls a verdict; "right" and "wrong" are among them.
    """
    totals = {verdict: sum(n for (_, other), n in counts.items() if other == verdict) for verdict in words}
    outcomes = ", ".join(f"{totals[verdict]} {word}" for verdict, word in words.items())
    shares = []
    for kind in sorted({kind for kind, _ in counts}):
        wrong = f" ({counts[kind, 'wrong']} wrong)" if counts[kind, "wrong"] else ""
        shares.append(f"{kind} {counts[kind, 'right']}/{sum(counts[kind, verdict] for verdict in words)}{wrong}")
    text = f"Of {counts.total()} histories {outcomes}. Named right, by what was done: {', '.join(shares)}."
    return textwrap.fill(text, 120) + "\n"


def page_with(table, page, begin, end):
    """Return a page with a table in its place between two marks."""
    return re.sub(
        re.escape(begin) + ".*?" + re.escape(end), lambda _: f"{begin}\n{table}\n{end}", page, flags=re.DOTALL
    )


def table(path):
    """Return the rows of a CSV table by the names of its columns."""
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))
