"""Answers of programs as folders: ``python -m peers.recording DIR SOLVER...`` asks solvers the problems of the pack.

What a solver refuses or cannot run has no table. Values are rounded to `DIGITS` digits; a verdict asks three.
"""

import argparse
import json
import platform
import sys
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from validation.engine.measure import completed
from validation.problems.answers import FILE, TABLE
from validation.problems.data import ANSWERS, PACK, folder_name
from validation.problems.pack import TIME, csv_text
from validation.problems.problem import names, problem
from validation.solvers.registry import get_solver
from validation.solvers.user import UserSolver
from validation.suite.judging import DEFAULTS

DIGITS = 5
LICENCE = "CC0-1.0"  # of the answers
LONG = ("bouncing", "tumbling")  # of thousands of rows
SCHEMES = {
    "pymunk": "semi-implicit Euler",
    "box2d": "semi-implicit Euler in sub-steps",
    "mujoco": "semi-implicit Euler; of one block RK4, with friction the leapfrog",
    "siconos": "theta method of Moreau and Jean, theta = 1/2",
    "lmgc90": "theta method of Moreau and Jean, theta = 1/2",
    "ntdda": "constant acceleration, alpha = 1/2, delta = 1",
}


def record(name, posed, root, version):
    """Ask a solver a problem and write what it answers to its folder below a directory."""
    solver = get_solver(name)
    run = completed(solver, posed.scene)
    reason = run.notes[-1] if run.notes else run.outcome.sentence
    sys.stdout.write(f"{name} {posed.name}: {reason}\n")
    if run.history is None or not isinstance(solver, UserSolver):
        return
    about = dict(solver.about())
    about["version"] = version or about["version"]
    settings_name = "default" if name.endswith(DEFAULTS) else "chosen"
    folder = root / folder_name(about["program"]) / folder_name(about["version"]) / settings_name
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / FILE
    steps = json.loads(file.read_text(encoding="utf-8"))["step_s"] if file.exists() else {}
    if posed.numbers:  # of other problems a solver does not report its steps
        steps[posed.name] = float(f"{posed.scene.time.duration / run.work['steps']:.{DIGITS}g}")
    stated = {
        "format": ANSWERS,
        "pack": PACK,
        "program": about["program"],
        "version": about["version"],
        "settings_name": settings_name,
        "settings": about["settings"],
        "scheme": SCHEMES.get(name.removesuffix(DEFAULTS), "as its settings say"),
        "step_s": steps,
        "contact_model": about["model"],
        "processor": platform.machine(),
        "who": f"the adapter of examples/peers, on {datetime.now(UTC).date().isoformat()}",
        "licence": LICENCE,
    }
    file.write_text(json.dumps(stated, indent=1) + "\n", encoding="utf-8")
    folder.joinpath(f"{posed.name}{TABLE}").write_text(table_of(posed, run.history), encoding="utf-8")


def table_of(posed, history):
    """Return a history as the table of an answer."""
    columns = [name for name in posed.columns if name in history.columns]
    values = np.column_stack([posed.instants, *(history.columns[name][: len(posed.instants)] for name in columns)])
    rows = [[f"{value:.{DIGITS}g}" for value in row] for row in values]
    return csv_text([[TIME, *map(posed.named, columns)], *rows])


def main():
    """Ask the solvers that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=Path, help="where folders PROGRAM/VERSION/SETTINGS are written")
    parser.add_argument("solvers", nargs="+", metavar="SOLVER", help="a name of `dda-validate list solvers`")
    parser.add_argument("--problems", nargs="+", default=[name for name in names() if name not in LONG], metavar="NAME")
    parser.add_argument("--version", help="of a program that cannot tell it, such as the commit that was built")
    given = parser.parse_args()
    for name in given.solvers:
        for asked in given.problems:
            record(name, problem(asked), given.directory, given.version)


if __name__ == "__main__":
    main()
