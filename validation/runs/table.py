"""The rows of a study as one table."""

from __future__ import annotations

from validation.runs.records import Manifest
from validation.runs.results import Results
from validation.runs.row import Value


def table(results: Results, manifest: Manifest) -> list[dict[str, Value]]:
    """Return one flat record for each case of any study: what was run, metrics, work, seconds, comparisons."""
    rows = results.rows()
    lines = []
    for case in manifest["cases"]:
        row = rows[case["key"]]
        line: dict[str, Value] = {"scene": case["scene"], "solver": case["solver"], "outcome": str(row.outcome)}
        line |= {f"work.{name}": value for name, value in row.work.items()}
        line |= {f"seconds.{name}": value for name, value in row.seconds.items()}
        line |= {"seconds.total": sum(row.seconds.values()), "estimate": row.estimate} | dict(row.metrics)
        for c in manifest["comparisons"]:
            if (c["scene"], c["solver"]) == (case["scene"], case["solver"]):
                line |= {f"{c['reference']}:{name}": value for name, value in c["metrics"].items()}
        lines.append(line | {"notes": "; ".join(row.notes)})
    return lines
