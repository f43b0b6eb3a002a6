"""Cases, rows and histories made by hand, so that a test knows every number that a reader should meet."""

import numpy as np
from matplotlib.colors import to_hex

from validation.engine.study import Study
from validation.gates.gate import Gate
from validation.report.chapters.data import CaseGroup, CaseResults
from validation.runs.history import History
from validation.runs.results import Row
from validation.runs.run import Outcome


def made_row(solver, metrics=None, scene="s", **more):
    """Return a row that completed, unless it is told otherwise."""
    outcome = more.pop("outcome", Outcome.COMPLETED)
    return Row(f"{scene} {solver}", "study", scene, solver, outcome, metrics or {}, **more)


def study(scene, *, timed=False):
    """Return a study of one scene by dda and bar with one gate, which passes on the small scene."""
    gate = Gate(scene.name, ("dda",), "displacement.static", -0.011, -0.009, "a test")
    return Study("test", "A test", "Testing.", [scene], ("dda", "bar"), gates=lambda: (gate,), timed=timed)


def made_case(
    scene,
    metrics,
    histories=None,
    label="",
):
    """Return a case of a report's page from the metrics, or the rows, of its solvers."""
    rows = {s: m if isinstance(m, Row) else made_row(s, m, scene.name) for s, m in metrics.items()}
    return CaseResults(scene.name, label or scene.name, scene, rows, histories or {})


def made_group(*cases, **parts):
    """Return a scene of a study, with comparisons, verdicts, alarms or budgets."""
    return CaseGroup("scene", "A scene", cases, parts.pop("comparisons", ()), parts.pop("verdicts", ()), **parts)


def between(scene, solver, reference, **metrics):
    """Return a comparison of two solvers; displacement_l2 stands for displacement.l2."""
    values = {name.replace("_", ".", 1): value for name, value in metrics.items()}
    return {"scene": scene, "solver": solver, "reference": reference, "window": 1.0, "metrics": values}


def made_history(step, *columns):
    """Return a history of displacement [m] and, if given, contact pressure [Pa]."""
    names = ("displacement", "contact_pressure")
    values = {name: np.array(column, dtype=float) for name, column in zip(names, columns, strict=False)}
    return History(step * np.arange(1, len(values["displacement"]) + 1), values)


def kept_study(results, cases, comparisons=(), **parts):
    """Keep (scene, row, history) triples as a study, named "made" unless it is told otherwise; return its manifest."""
    entries = []
    for scene, row, history in cases:
        results.append(row, history)
        entries.append(
            {
                "scene": scene.name,
                "title": scene.title,
                "solver": row.solver,
                "key": row.key,
                "definition": scene.definition(),
            }
        )
    manifest = {"study": "made", "title": "Made", "purpose": "Why.", "cases": entries, "comparisons": list(comparisons)}
    manifest |= parts
    results.write_json(f"studies/{manifest['study']}.json", manifest)
    return manifest


# ---- what a drawn axes shows --------------------------------------------------------------------------------------


def lines_of(axes):
    """Return the lines in data coordinates: colour, x and y."""
    drawn = [line for line in axes.lines if line.get_transform() == axes.transData]
    return [(to_hex(line.get_color()), np.array(line.get_xdata()), np.array(line.get_ydata())) for line in drawn]


def line_in(axes, color):
    """Return x and y of the one line of a colour with more than one point."""
    (found,) = [(x, y) for own, x, y in lines_of(axes) if own == color and x.size > 1]
    return found
