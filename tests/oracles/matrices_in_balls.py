"""The histories of `fem` and `bar` in sixty-digit arithmetic, and how many digits the solvers keep of them."""

import numpy as np
from flint import arb, arb_mat
from oracles import bar_by_series

from fem_reference.mesh.model import build
from validation import solve
from validation.solvers.fem import problem_of
from validation.solvers.registry import get_solver
from validation.solvers.sixty_digits.block import WORKING, Equations, digits, responses

COLUMNS = ("displacement", "contact_pressure")


def mesh_history(scene):
    """Return the columns of a small mesh, the doubles of its own matrices taken as exact."""
    problem = problem_of(scene)
    model = build(problem, full=False)
    with digits(WORKING):
        M, K = (arb_mat(np.asarray(matrix.toarray()).tolist()) for matrix in (model.M, model.K))
        load = [arb(problem.load_size) * value for value in model.F.tolist()]
        rows = {name: [arb(value) for value in model.observers[name].tolist()] for name in COLUMNS}
        return responses(Equations(M, K, load, rows), scene, COLUMNS)


def lost(scene, solver):
    """Return the greatest error of `fem` or `bar` in its columns, over their maximum.

    Of the bar it is over the static value where the wave has hardly arrived.
    """
    exact = mesh_history(scene) if solver == "fem" else bar_by_series.history(scene, COLUMNS)
    history = solve(scene, solver).history
    assert history is not None
    static = get_solver(solver).static(scene)
    errors = []
    for name in COLUMNS:
        expected = np.array([float(value) for value in exact[name]])
        size = np.abs(expected).max()
        if solver == "bar":
            size = max(size, abs(static[name]))
        errors.append(np.abs(history.columns[name] - expected).max() / size)
    return float(max(errors))
